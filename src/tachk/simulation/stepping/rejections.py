"""The rejection of a submitted trace, as a message with places."""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import NOWHERE
from tachk.model.quantity import decimal
from tachk.simulation.stepping.replaying import StepRejection
from tachk.simulation.stepping.submitted import SubmittedStep


def rejection_diagnostic(rejection: StepRejection) -> Diagnostic:
    """A refused step at its line of the file, or at the place of the model that refuses it."""
    labels = rejection.reason.labels
    words = "the initial state" if rejection.wanted is None else f"step {rejection.step} ({_words(rejection.wanted)})"
    message = f"{words} cannot be taken: {rejection.reason.message}"
    span = None if rejection.wanted is None else rejection.wanted.span
    if span is None and labels:
        message += f": {labels[0].text}" if labels[0].text != "here" else ""
        span, labels = labels[0].span, labels[1:]
    return Diagnostic("E0921", message, NOWHERE if span is None else span, labels=labels)


def _words(wanted: SubmittedStep) -> str:
    when = f"{'after' if wanted.relative else 'at'} {decimal(wanted.time)}"
    moves = ", ".join(f"{move.process}: {move.source} → {move.target}" for move in wanted.moves)
    return f"{moves or 'time passes'} {when}"
