"""The rejection of a submitted trace, as a message with places."""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import NOWHERE
from tachk.model.quantity import decimal
from tachk.simulation.stepping.claims import ClaimedStep
from tachk.simulation.stepping.replaying import StepRefusal


def refusal_diagnostic(refusal: StepRefusal) -> Diagnostic:
    """A refused step at its line of the file, or at the place of the model that refuses it."""
    labels = refusal.reason.labels
    words = "the initial state" if refusal.claim is None else f"step {refusal.step} ({_words(refusal.claim)})"
    message = f"{words} cannot be taken: {refusal.reason.message}"
    span = None if refusal.claim is None else refusal.claim.span
    if span is None and labels:
        message += f": {labels[0].text}" if labels[0].text != "here" else ""
        span, labels = labels[0].span, labels[1:]
    return Diagnostic("E0921", message, NOWHERE if span is None else span, labels=labels)


def _words(claim: ClaimedStep) -> str:
    when = f"{'after' if claim.relative else 'at'} {decimal(claim.time)}"
    moves = ", ".join(f"{move.process}: {move.source} → {move.target}" for move in claim.moves)
    return f"{moves or 'time passes'} {when}"
