"""Sentences in their canonical wording; reading it again gives an equal tree."""

from __future__ import annotations

import re
from typing import assert_never

from tachk.syntax.ast import Expression, NameExpression
from tachk.syntax.formula import Atom, Duration, Formula
from tachk.syntax.formulas.printer import print_duration, print_formula
from tachk.syntax.sentences import tree as s
from tachk.syntax.sentences.tables import opening_words

_WORD = re.compile(r"\w+")
_INSTANTS = {
    s.DelayReference.FALL: "the fall",
    s.DelayReference.MINIMUM: "the end of min time",
    s.DelayReference.MAXIMUM: "the end of max time",
}


def print_sentence(sentence: s.Sentence) -> str:
    """The sentence on one line, with its full stop."""
    parts = [
        _scope(sentence.scope),
        _trigger(sentence.trigger),
        _reference(sentence.trigger),
        _delay(sentence.delay),
    ]
    opening = ", ".join(part for part in parts if part)
    opening = opening[:1].upper() + opening[1:] + ", " if opening else ""
    label = f"{sentence.label}: " if sentence.label else ""
    return f"{label}{opening}{_response(sentence.response)}."


def _scope(scope: s.Scope) -> str:
    match scope:
        case s.Globally():
            return ""
        case s.BeforeScope(end=end):
            return f"before {_condition(end)}"
        case s.After(start=start):
            return f"after {_condition(start)}"
        case s.BetweenScope(start=start, end=end):
            return f"between {_condition(start)} and {_condition(end)}"
        case s.AfterUntil(start=start, end=end):
            return f"after {_condition(start)} until {_condition(end)}"
        case s.WhileScope(condition=condition):
            return f"while {_condition(condition)}"
        case _:
            assert_never(scope)


def _trigger(trigger: s.Trigger) -> str:
    match trigger:
        case s.AtEveryInstant():
            return ""
        case s.Initially():
            return "initially"
        case s.Whenever(condition=condition):
            return f"whenever {_condition(condition)} is true"
        case s.Becomes(condition=condition, lasting=None):
            return f"whenever {_condition(condition)} becomes true"
        case s.Becomes(condition=condition, lasting=lasting):
            assert lasting is not None
            return f"whenever {_condition(condition)} becomes true and stays true for {_lasting(lasting)}"
        case s.ChangeInstants(expression=expression):
            return f"whenever {_value(expression)} changes"
        case _:
            assert_never(trigger)


def _reference(trigger: s.Trigger) -> str:
    if isinstance(trigger, s.Becomes) and trigger.reference in _INSTANTS:
        return f"counting from {_INSTANTS[trigger.reference]}"
    return ""


def _delay(delay: s.Delay) -> str:
    match delay:
        case s.NoDelay():
            return ""
        case s.Within(duration=duration):
            return f"within {_duration(duration)}"
        case s.SentenceWindow(lower=lower, upper=upper):
            return f"between {_range(lower, upper)} later"
        case s.Exactly(duration=duration):
            return f"after {_duration(duration)}"
        case s.AtSomeInstant():
            return "eventually"
        case _:
            assert_never(delay)


def _response(response: s.Response) -> str:
    condition = _condition(response.condition)
    match response:
        case s.MustBeTrue():
            return f"{condition} must be true"
        case s.MustStay(lasting=lasting):
            return f"{condition} must stay true for {_lasting(lasting)}"
        case s.MustStayUntil(end=end, within=within):
            return f"{condition} must stay true until {_condition(end)}{_optional('within', within)}"
        case s.MustStayOn():
            return f"{condition} must stay true from then on"
        case s.MustNotOccur(duration=duration):
            return f"{condition} must not occur{_optional('for', duration)}"
        case s.MustOccur(within=within):
            return f"{condition} must occur{_optional('within', within)}"
        case s.MustRecur(period=period):
            return f"{condition} must occur at least every {_duration(period)}"
        case s.MustHaveBeen(within=within):
            return f"{condition} must have been true{_optional('within the last', within)}"
        case _:
            assert_never(response)


def _lasting(lasting: s.Lasting) -> str:
    match lasting:
        case s.AtLeast(duration=duration):
            return f"at least {_duration(duration)}"
        case s.AtMost(duration=duration):
            return f"at most {_duration(duration)}"
        case s.FromTo(lower=lower, upper=upper):
            return f"between {_range(lower, upper)}"
        case _:
            assert_never(lasting)


def _range(lower: Duration, upper: Duration) -> str:
    """Both durations; a unit that they share stands once."""
    first = _amount(lower) if lower.unit == upper.unit else _duration(lower)
    return f"{first} and {_duration(upper)}"


def _optional(phrase: str, duration: Duration | None) -> str:
    return "" if duration is None else f" {phrase} {_duration(duration)}"


def _duration(duration: Duration) -> str:
    return _amount(duration) + (f" {duration.unit}" if duration.unit else "")


def _amount(duration: Duration) -> str:
    text = print_duration(Duration(duration.span, duration.value))
    plain = isinstance(duration.value, NameExpression) or text.replace(".", "", 1).isdigit()
    return text if plain and not _confusing(text) else f"({text})"


def _condition(condition: Formula) -> str:
    text = print_formula(condition)
    return f"({text})" if _confusing(text) else text


def _value(expression: Expression) -> str:
    return _condition(Atom(expression.span, expression))


def _confusing(text: str) -> bool:
    """True if a word of the text might be taken for the beginning of a phrase."""
    return not opening_words().isdisjoint(word.lower() for word in _WORD.findall(text))
