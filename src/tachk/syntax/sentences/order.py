"""From the parts of a sentence to the sentence: their order, which of them go together, and what has no meaning."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, Label
from tachk.base.records import replace
from tachk.base.span import Span
from tachk.syntax.sentences import tree as s
from tachk.syntax.sentences.build import Mark

Diagnostics = tuple[Diagnostic, ...]
Part = s.Scope | s.Trigger | s.Delay | s.Response | Mark

_KINDS: tuple[tuple[str, tuple[type, ...]], ...] = (
    ("scope", (s.Globally, s.BeforeScope, s.After, s.BetweenScope, s.AfterUntil, s.WhileScope)),
    ("trigger", (s.AtEveryInstant, s.Initially, s.Whenever, s.Becomes, s.ChangeInstants)),
    ("delay", (s.NoDelay, s.Within, s.SentenceWindow, s.Exactly, s.AtSomeInstant)),
)
_ORDER = ("label", "scope", "everywhere", "trigger", "reference", "then", "delay", "response")

_REFERENCES = {
    s.AtLeast: (s.DelayReference.RISE, s.DelayReference.MINIMUM),
    s.AtMost: (s.DelayReference.RISE, s.DelayReference.FALL, s.DelayReference.MAXIMUM),
    s.FromTo: tuple(s.DelayReference),
}


def assemble(span: Span, parts: Sequence[Part]) -> tuple[s.Sentence | None, Diagnostics]:
    """The sentence that the parts make, in whatever order they come, and what is wrong with them.

    Where only the order is wrong there are both.
    """
    held: dict[str, Any] = {}
    found: list[Diagnostic] = []
    before: Part | None = None
    for part in parts:
        kind = _kind(part)
        if kind == "comma":
            if before is None or _kind(before) in ("comma", "response"):
                found.append(Diagnostic("E0140", "this comma stands between no two parts", part.span, "remove it"))
        elif kind in held:
            found.append(_twice(kind, held[kind], part))
        else:
            late = next((held[later] for later in _ORDER[_ORDER.index(kind) + 1 :] if later in held), None)
            if late is not None:
                found.append(_out_of_order(part, late))
            held[kind] = part
        before = part
    if "response" not in held:
        end = Span(span.source, max(span.end - 1, span.start), span.end)
        help = "say what must be true, as in 'whenever p, within 5 s, q must be true.'"
        return None, (Diagnostic("E0140", "the sentence demands nothing", end, help),)
    if any(diagnostic.code == "E0142" for diagnostic in found):
        found = [diagnostic for diagnostic in found if diagnostic.code != "E0140"]
    sentence = _with_reference(_sentence(span, held), held.get("reference"), found)
    sentence = _occurring_within(sentence)
    found += _misfits(sentence, "everywhere" in held)
    order_only = all(diagnostic.code == "E0142" for diagnostic in found)
    return (sentence if order_only else None), tuple(found)


def _kind(part: Part) -> str:
    if isinstance(part, Mark):
        return part.kind
    return next((kind for kind, types in _KINDS if isinstance(part, types)), "response")


def _name(kind: str) -> str:
    return {"everywhere": "'at any time'", "then": "'then'", "label": "name"}.get(kind, kind)


def _sentence(span: Span, held: dict[str, Any]) -> s.Sentence:
    nowhere = Span(span.source, span.start, span.start)
    return s.Sentence(
        span,
        held.get("scope", s.Globally(nowhere)),
        held.get("trigger", s.AtEveryInstant(nowhere)),
        held.get("delay", s.NoDelay(nowhere)),
        held["response"],
        held["label"].text if "label" in held else "",
    )


def _twice(kind: str, first: Part, second: Part) -> Diagnostic:
    return Diagnostic(
        "E0144",
        f"the sentence has a second {_name(kind)}",
        second.span,
        "write two sentences",
        (Label(first.span, "first"),),
    )


def _out_of_order(part: Part, late: Part) -> Diagnostic:
    return Diagnostic(
        "E0142",
        f"the {_name(_kind(part))} belongs before the {_name(_kind(late))}",
        part.span,
        None,
        (Label(late.span, _kind(late)),),
    )


def _with_reference(sentence: s.Sentence, mark: Mark | None, found: list[Diagnostic]) -> s.Sentence:
    if mark is None:
        return sentence
    reference = s.DelayReference(mark.text)
    trigger = sentence.trigger
    if not isinstance(trigger, s.Becomes) or (trigger.lasting is None and reference is not s.DelayReference.RISE):
        help = "'whenever p becomes true and stays true for at least 5 s, counting from the end of min time, ...'"
        found.append(Diagnostic("E0144", "this trigger has no such instant", mark.span, help))
        return sentence
    if trigger.lasting is not None and reference not in _REFERENCES[type(trigger.lasting)]:
        names = " or ".join(f"'the {_instant(known)}'" for known in _REFERENCES[type(trigger.lasting)])
        found.append(Diagnostic("E0144", "this trigger has no such instant", mark.span, f"count from {names}"))
        return sentence
    return replace(sentence, trigger=replace(trigger, reference=reference))


def _instant(reference: s.DelayReference) -> str:
    names = {s.DelayReference.MINIMUM: "end of min time", s.DelayReference.MAXIMUM: "end of max time"}
    return names.get(reference, reference.value)


def _occurring_within(sentence: s.Sentence) -> s.Sentence:
    """``whenever p, q must occur within 5 s`` is another wording of ``whenever p, within 5 s, q must be true``."""
    response = sentence.response
    if (
        isinstance(response, s.MustOccur)
        and response.within is not None
        and not isinstance(sentence.trigger, s.AtEveryInstant)
        and isinstance(sentence.delay, s.NoDelay)
    ):
        return replace(
            sentence,
            delay=s.Within(response.within.span, response.within),
            response=s.MustBeTrue(response.span, response.condition),
        )
    return sentence


def _misfits(sentence: s.Sentence, everywhere: bool) -> Iterator[Diagnostic]:
    """Phrases that have no meaning together."""
    scope, trigger, delay, response = sentence.scope, sentence.trigger, sentence.delay, sentence.response
    delayed = not isinstance(delay, s.NoDelay)
    if isinstance(trigger, s.Initially) and not isinstance(scope, s.Globally):
        yield _misfit("the start of the run lies outside this scope", scope.span, "leave out the scope or 'initially'")
    match response:
        case s.MustOccur() if delayed:
            yield _misfit(
                "'must occur' has no delay", delay.span, "write 'must be true', or '... must occur within 5 s.'"
            )
        case s.MustOccur() if everywhere or not isinstance(trigger, s.AtEveryInstant):
            yield _misfit(
                "'must occur' does not say when",
                response.span,
                "write 'must occur within 5 s', 'must occur at least every 5 s', or 'eventually, ... must be true' "
                "behind a trigger",
            )
        case s.MustRecur() if delayed or not isinstance(trigger, s.AtEveryInstant):
            part = delay if delayed else trigger
            yield _misfit(
                "'must occur at least every' has neither trigger nor delay",
                part.span,
                "say with 'after c', 'between c and d' or 'while c' where it is demanded",
            )
        case s.MustHaveBeen() if delayed:
            yield _misfit("'must have been true' looks back and has no delay", delay.span, "leave out the delay")
        case s.MustHaveBeen() if isinstance(scope, s.BetweenScope | s.AfterUntil) and (
            response.within is not None or _counts_later(trigger)
        ):
            yield _misfit(
                "'must have been true' within a time has no meaning in this scope",
                scope.span,
                "leave out the time, or use 'after c' or 'while c'",
            )
        case s.MustNotOccur(duration=None) if isinstance(delay, s.Within | s.SentenceWindow | s.AtSomeInstant):
            yield _misfit(
                "'must not occur' with such a delay can be understood in two ways",
                delay.span,
                "'must not occur for 5 s' excludes every instant of the time; 'must be false' demands one only",
            )
        case _ if delayed and isinstance(trigger, s.AtEveryInstant):
            yield Diagnostic(
                "E0143",
                "a delay needs a trigger from which it is counted",
                delay.span,
                "begin with 'initially' to count from the start, or with 'whenever true is true' to demand it of every "
                "instant",
            )


def _counts_later(trigger: s.Trigger) -> bool:
    return isinstance(trigger, s.Becomes) and trigger.reference in (s.DelayReference.MINIMUM, s.DelayReference.MAXIMUM)


def _misfit(message: str, span: Span, help: str) -> Diagnostic:
    return Diagnostic("E0144", message, span, help)
