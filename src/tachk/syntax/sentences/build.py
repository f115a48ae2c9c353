"""From the phrases of a sentence to its parts, one callback for each rule of grammar/sentences.lark.

The callbacks get everything a rule matched, phrases as tokens. They raise `Unreadable` for a condition or a duration
that cannot be read; `tachk.syntax.sentences.order` puts the parts together.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, TypeVar

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.syntax.ast import BinaryExpression
from tachk.syntax.formula import And, Atom, Duration, Formula, Not, Or, Rise
from tachk.syntax.formulas.build import missing_unit
from tachk.syntax.parsing.tokens import Token
from tachk.syntax.sentences import tree as s
from tachk.syntax.sentences.conditions import Unreadable, read_condition, read_duration, read_number, read_value

Children = list[Any]


@dataclass(frozen=True, slots=True)
class Mark:
    """A part of a sentence without a node of its own.

    Attributes:
        kind: ``label``, ``everywhere``, ``reference``, ``comma`` or ``then``.
    """

    kind: str
    span: Span
    text: str = ""


class SentenceBuilder:
    """The callbacks of the rules."""

    def sentence(self, children: Children) -> list[Any]:
        return [child for child in children if child is not None and not isinstance(child, Token)]

    def label(self, children: Children) -> Mark:
        return Mark("label", children[0].span, children[0].span.text)

    def everywhere(self, children: Children) -> Mark:
        return Mark("everywhere", _span(children))

    def comma(self, children: Children) -> Mark:
        return Mark("comma", _span(children))

    def then(self, children: Children) -> Mark:
        return Mark("then", _span(children))

    # ---- scopes ----

    def globally(self, children: Children) -> s.Globally:
        return s.Globally(_span(children))

    def before(self, children: Children) -> s.BeforeScope:
        return s.BeforeScope(_span(children), children[1])

    def after(self, children: Children) -> s.After:
        return s.After(_span(children), children[1])

    def between(self, children: Children) -> s.BetweenScope:
        return s.BetweenScope(_span(children), children[1], children[3])

    def after_until(self, children: Children) -> s.AfterUntil:
        return s.AfterUntil(_span(children), children[1], children[3])

    def while_scope(self, children: Children) -> s.WhileScope:
        return s.WhileScope(_span(children), children[1])

    # ---- triggers ----

    def whenever(self, children: Children) -> s.Whenever:
        return s.Whenever(_span(children), children[1])

    def becoming(self, children: Children) -> s.Becomes:
        _, condition, becomes, stays, lasting = children
        if stays is not None and _polarity(stays) != _polarity(becomes):
            raise Unreadable(
                Diagnostic(
                    "E0144",
                    "what becomes true stays true, what becomes false stays false",
                    becomes.span.to(stays.span),
                )
            )
        return s.Becomes(_span(children), _condition(condition, becomes), lasting)

    def becomes(self, children: Children) -> Token:
        return _token(children)

    def changing(self, children: Children) -> s.ChangeInstants:
        return s.ChangeInstants(_span(children), read_value(children[1].span))

    def initially(self, children: Children) -> s.Initially:
        return s.Initially(_span(children))

    def reference(self, children: Children) -> Mark:
        return Mark("reference", _span(children), children[1].text)

    def rise(self, children: Children) -> Mark:
        return Mark("", _span(children), s.DelayReference.RISE)

    def fall(self, children: Children) -> Mark:
        return Mark("", _span(children), s.DelayReference.FALL)

    def minimum_words(self, children: Children) -> Token:
        return _token(children)

    def maximum_words(self, children: Children) -> Token:
        return _token(children)

    def minimum(self, children: Children) -> Mark:
        return Mark("", _span(children), s.DelayReference.MINIMUM)

    def maximum(self, children: Children) -> Mark:
        return Mark("", _span(children), s.DelayReference.MAXIMUM)

    # ---- delays ----

    def no_delay(self, children: Children) -> s.NoDelay:
        return s.NoDelay(_span(children))

    def at_most_delay(self, children: Children) -> s.Within:
        return s.Within(_span(children), _duration(children[1]))

    def window_delay(self, children: Children) -> s.SentenceWindow:
        return _range(s.SentenceWindow, children)

    def exact_delay(self, children: Children) -> s.Exactly:
        return s.Exactly(_span(children), _duration(children[1]))

    def open_delay(self, children: Children) -> s.AtSomeInstant:
        return s.AtSomeInstant(_span(children))

    # ---- responses ----

    def must_be(self, children: Children) -> s.MustBeTrue:
        return s.MustBeTrue(_span(children), _condition(*children))

    def must_stay(self, children: Children) -> s.MustStay:
        return s.MustStay(_span(children), _condition(*children[:2]), children[3])

    def must_stay_until(self, children: Children) -> s.MustStayUntil:
        condition, stays, end, *_, duration = children
        return s.MustStayUntil(_span(children), _condition(condition, stays), end, _optional(duration))

    def must_stay_on(self, children: Children) -> s.MustStayOn:
        return s.MustStayOn(_span(children), _condition(*children))

    def must_not_occur(self, children: Children) -> s.MustNotOccur:
        return s.MustNotOccur(_span(children), _condition(children[0]), _optional(children[3]))

    def must_occur(self, children: Children) -> s.MustOccur:
        return s.MustOccur(_span(children), _condition(children[0]), _optional(children[3]))

    def must_recur(self, children: Children) -> s.MustRecur:
        return s.MustRecur(_span(children), _condition(children[0]), _duration(children[2]))

    def must_have_been(self, children: Children) -> s.MustHaveBeen:
        return s.MustHaveBeen(_span(children), _condition(children[0]), _optional(children[3]))

    def must_compare(self, children: Children) -> s.MustBeTrue:
        left, comparison, right = children
        span = _span(children)
        return s.MustBeTrue(span, _compared(span, left, comparison.text, right))

    def below(self, children: Children) -> Mark:
        return Mark("", _span(children), BinaryOperator.LESS)

    def at_or_below(self, children: Children) -> Mark:
        return Mark("", _span(children), BinaryOperator.LESS_EQUAL)

    def above(self, children: Children) -> Mark:
        return Mark("", _span(children), BinaryOperator.GREATER)

    def at_or_above(self, children: Children) -> Mark:
        return Mark("", _span(children), BinaryOperator.GREATER_EQUAL)

    def must_be_inside(self, children: Children) -> s.MustBeTrue:
        value, _, low, _, high = children
        span = _span(children)
        both = (
            _compared(span, low, BinaryOperator.LESS_EQUAL, value),
            _compared(span, value, BinaryOperator.LESS_EQUAL, high),
        )
        return s.MustBeTrue(span, And(span, both))

    def must_be_outside(self, children: Children) -> s.MustBeTrue:
        value, _, low, _, high = children
        span = _span(children)
        either = (
            _compared(span, value, BinaryOperator.LESS, low),
            _compared(span, value, BinaryOperator.GREATER, high),
        )
        return s.MustBeTrue(span, Or(span, either))

    # ---- parts ----

    def level(self, children: Children) -> Formula:
        return _condition(*children)

    def edge(self, children: Children) -> Rise:
        return Rise(_span(children), _condition(*children))

    def latest(self, children: Children) -> Token:
        return _token(children)

    def at_least(self, children: Children) -> s.AtLeast:
        return s.AtLeast(_span(children), _duration(children[1]))

    def at_most(self, children: Children) -> s.AtMost:
        return s.AtMost(_span(children), _duration(children[1]))

    def from_to(self, children: Children) -> s.FromTo:
        return _range(s.FromTo, children)


def _token(children: Children) -> Token:
    token: Token = children[0]
    return token


def _span(children: Children) -> Span:
    spans: list[Span] = [child.span for child in children if child is not None]
    return spans[0].to(spans[-1])


def _polarity(wording: Token | None) -> bool:
    """True if a wording such as ``must be false`` is about true or about false."""
    return wording is None or "false" not in (wording.text or wording.span.text).lower()


def _condition(token: Token, wording: Token | None = None) -> Formula:
    formula = read_condition(token.span)
    return formula if _polarity(wording) else Not(formula.span, formula)


def _compared(span: Span, left: Token, operator: BinaryOperator, right: Token) -> Atom:
    return Atom(span, BinaryExpression(span, operator, read_number(left.span), read_number(right.span)))


def _duration(token: Token) -> Duration:
    return read_duration(token.span)


def _optional(token: Token | None) -> Duration | None:
    return None if token is None else _duration(token)


_R = TypeVar("_R", s.SentenceWindow, s.FromTo)


def _range(kind: type[_R], children: Children) -> _R:
    """Two durations; the unit of the second one is also that of the first if that has none. Raises Refused for the
    reverse, as in the interval of a formula."""
    lower, upper = (_duration(child) for child in children if child is not None and child.type == "DURATION")
    if not lower.unit:
        lower = replace(lower, unit=upper.unit)
    missing = missing_unit(upper, lower)
    if missing is not None:
        raise Unreadable(missing)
    return kind(_span(children), lower, upper)
