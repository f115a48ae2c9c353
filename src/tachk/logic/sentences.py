"""The one meaning of each sentence in temporal logic.

Triggers, delays and responses mean what Simulink Test's logical and temporal assessments document; scopes are those of
Dwyer, Avrunin and Corbett (1999), durations those of Konrad and Cheng (2005). Decided here where these leave it open:

- "must be true" with a delay is true at some instant of the delay (``F``), as the delay is documented to be the time up
  to the instant at which the response is expected.
- "for at least m" is ``G[0,m)``, so that a run of exactly m counts; "for at most M" is ``F(0,M] !``.
- In a scope with an end R a response has to come before R, and what must stay true, or must not occur, is demanded up
  to R only. "while c" only says at which instants the trigger counts.
- Every instant of the start Q opens its own interval "between Q and R"; "between rise(Q) and R" has one for each edge.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import assert_never

from tachk.base.span import Span
from tachk.syntax.formula import (
    Always,
    And,
    Change,
    Duration,
    Eventually,
    Fall,
    Formula,
    Historically,
    Implies,
    Interval,
    Not,
    Once,
    Or,
    Rise,
    TruthConstant,
    Until,
    WeakUntil,
)
from tachk.syntax.sentences import tree as s


def negation(formula: Formula) -> Formula:
    """The opposite, without a double negation."""
    match formula:
        case Not(operand=operand):
            return operand
        case TruthConstant(value=value):
            return TruthConstant(formula.span, not value)
        case _:
            return Not(formula.span, formula)


def conjuncts(formula: Formula) -> tuple[Formula, ...]:
    return formula.operands if isinstance(formula, And) else (formula,)


def both(span: Span, left: Formula, right: Formula) -> Formula:
    """A conjunction that is flat and without parts that are always true."""
    parts = tuple(p for formula in (left, right) for p in conjuncts(formula) if p != TruthConstant(p.span, True))
    return And(span, parts) if len(parts) > 1 else parts[0] if parts else TruthConstant(span, True)


def either(span: Span, left: Formula, right: Formula) -> Formula:
    """A disjunction that is flat."""
    return Or(span, tuple(p for f in (left, right) for p in (f.operands if isinstance(f, Or) else (f,))))


def implies(span: Span, left: Formula, right: Formula) -> Formula:
    """An implication, or only the right side where the left one is always true."""
    return right if left == TruthConstant(span, True) else Implies(span, left, right)


def meaning(sentence: s.Sentence) -> Formula:
    """The formula that holds of the runs of which the sentence is true."""
    return _Meaning(sentence).formula()


@dataclass(frozen=True, slots=True)
class _Meaning:
    sentence: s.Sentence

    @property
    def span(self) -> Span:
        return self.sentence.span

    # ---- the sentence ----

    def formula(self) -> Formula:
        response = self.sentence.response
        match response:
            case s.MustOccur():
                return self.existence(response)
            case s.MustRecur():
                return self.recurrence(response)
            case s.MustHaveBeen(within=None) if isinstance(self.sentence.scope, s.BetweenScope | s.AfterUntil):
                return self.precedence(response, self.sentence.scope)
            case (
                s.MustBeTrue() | s.MustStay() | s.MustStayUntil() | s.MustStayOn() | s.MustNotOccur() | s.MustHaveBeen()
            ):
                return self.invariance()

    def invariance(self) -> Formula:
        """The response wherever the trigger is, as far as the scope reaches."""
        trigger, span = self.sentence.trigger, self.span
        if isinstance(trigger, s.Initially):
            return self.demanded()
        instant, demand = self.instant(trigger), self.demanded()
        match self.sentence.scope:
            case s.Globally():
                return self.always(implies(span, instant, demand))
            case s.After(start=start):
                return self.always(implies(span, both(span, self.once(start), instant), demand))
            case s.WhileScope(condition=condition):
                return self.always(implies(span, both(span, condition, instant), demand))
            case s.BeforeScope(end=end):
                return self.before(end, implies(span, instant, demand))
            case s.BetweenScope(start=start, end=end):
                return self.between(start, end, implies(span, instant, demand))
            case s.AfterUntil(start=start, end=end):
                return self.after_until(start, end, implies(span, instant, demand))
            case scope:
                assert_never(scope)

    # ---- responses that speak about the whole scope ----

    def existence(self, response: s.MustOccur) -> Formula:
        span, wanted = self.span, response.condition
        interval = self.unbounded() if response.within is None else self.up_to(response.within)
        found = Eventually(span, interval, wanted)
        match self.sentence.scope:
            case s.Globally():
                return found
            case s.After(start=start) if response.within is None:
                entered = Eventually(span, interval, start)
                return Implies(span, entered, Eventually(span, interval, both(span, start, found)))
            case s.After(start=start):
                return self.always(implies(span, self.first(start), found))
            case s.WhileScope(condition=condition):
                inside = both(span, condition, wanted)
                return self.always(Implies(span, Rise(span, condition), Until(span, interval, condition, inside)))
            case s.BeforeScope(end=end) if response.within is None:
                return WeakUntil(span, negation(end), both(span, wanted, negation(end)))
            case s.BeforeScope(end=end):
                return implies(span, Eventually(span, self.unbounded(), end), self.eventually(interval, wanted))
            case s.BetweenScope(start=start, end=end) if response.within is None:
                opened = self.opened(start, end, bounded=False)
                before = WeakUntil(span, negation(end), both(span, wanted, negation(end)))
                return self.always(Implies(span, opened, before))
            case s.BetweenScope(start=start, end=end):
                opened = self.opened(start, end, bounded=True)
                return self.always(Implies(span, opened, self.eventually(interval, wanted)))
            case s.AfterUntil(start=start, end=end):
                opened = self.opened(start, end, bounded=False)
                return self.always(Implies(span, opened, self.eventually(interval, wanted)))
            case scope:
                assert_never(scope)

    def recurrence(self, response: s.MustRecur) -> Formula:
        span, interval = self.span, self.up_to(response.period)
        wanted = response.condition

        def again(end: Formula) -> Formula:
            return Eventually(span, interval, either(span, wanted, end))

        found = Eventually(span, interval, wanted)
        match self.sentence.scope:
            case s.Globally():
                return self.always(found)
            case s.After(start=start):
                return self.always(implies(span, self.once(start), found))
            case s.WhileScope(condition=condition):
                return self.always(implies(span, condition, again(negation(condition))))
            case s.BeforeScope(end=end):
                return self.before(end, again(end))
            case s.BetweenScope(start=start, end=end):
                return self.between(start, end, again(end))
            case s.AfterUntil(start=start, end=end):
                return self.after_until(start, end, again(end))
            case scope:
                assert_never(scope)

    def precedence(self, response: s.MustHaveBeen, scope: s.BetweenScope | s.AfterUntil) -> Formula:
        """Looking back no further than to the start of the interval: not the trigger before the response or the end."""
        span = self.span
        absent = negation(self.instant(self.sentence.trigger))
        reached = either(span, response.condition, scope.end)
        opened = self.opened(scope.start, scope.end, bounded=isinstance(scope, s.BetweenScope))
        return self.always(Implies(span, opened, WeakUntil(span, absent, reached)))

    # ---- scopes ----

    def before(self, end: Formula, body: Formula) -> Formula:
        reached = Eventually(self.span, self.unbounded(), end)
        return Implies(self.span, reached, Until(self.span, self.unbounded(), body, end))

    def between(self, start: Formula, end: Formula, body: Formula) -> Formula:
        opened = self.opened(start, end, bounded=True)
        return self.always(Implies(self.span, opened, Until(self.span, self.unbounded(), body, end)))

    def after_until(self, start: Formula, end: Formula, body: Formula) -> Formula:
        opened = self.opened(start, end, bounded=False)
        return self.always(Implies(self.span, opened, WeakUntil(self.span, body, end)))

    def opened(self, start: Formula, end: Formula, bounded: bool) -> Formula:
        """The instants at which an interval begins; if bounded, only of one that ends."""
        parts = [start, negation(end)]
        if bounded:
            parts.append(Eventually(self.span, self.unbounded(), end))
        return And(self.span, tuple(flat for part in parts for flat in conjuncts(part)))

    def end(self) -> Formula | None:
        """The condition that ends the scope."""
        match self.sentence.scope:
            case s.BeforeScope(end=end) | s.BetweenScope(end=end) | s.AfterUntil(end=end):
                return end
            case s.Globally() | s.After() | s.WhileScope():
                return None

    # ---- triggers ----

    def instant(self, trigger: s.Trigger) -> Formula:
        """True at the instants that are recognised; the delay is counted from there or from `shift` later."""
        span = self.span
        match trigger:
            case s.AtEveryInstant() | s.Initially():
                return TruthConstant(span, True)
            case s.Whenever(condition=condition):
                return condition
            case s.ChangeInstants(expression=expression):
                return Change(span, expression)
            case s.Becomes(condition=condition, lasting=None):
                return Rise(span, condition)
            case s.Becomes(condition=condition, lasting=lasting, reference=s.DelayReference.FALL):
                return self.ended(condition, lasting)
            case s.Becomes(condition=condition, lasting=lasting):
                assert lasting is not None
                return both(span, Rise(span, condition), self.lasts(condition, lasting))
            case _:
                assert_never(trigger)

    def ended(self, condition: Formula, lasting: s.Lasting | None) -> Formula:
        """The instants at which a run of a condition ends that was as long as demanded."""
        span = self.span
        fell, rose = Fall(span, condition), Rise(span, condition)
        match lasting:
            case s.AtMost(duration=longest):
                return both(span, fell, Once(span, Interval(span, zero(longest), longest, False, True), rose))
            case s.FromTo(lower=shortest, upper=longest):
                # The run is the last one, since the condition was true all the time from `shortest` ago.
                long_enough = Historically(span, Interval(span, zero(shortest), shortest, False, True), condition)
                started = Once(span, Interval(span, shortest, longest), rose)
                return And(span, (fell, started, long_enough))
            case _:
                raise ValueError("only a run that is bounded has its end for a reference")

    def shift(self) -> Duration | None:
        """The time from the beginning of the run to that of the delay."""
        match self.sentence.trigger:
            case s.Becomes(lasting=s.AtLeast(duration=duration), reference=s.DelayReference.MINIMUM):
                return duration
            case s.Becomes(lasting=s.AtMost(duration=duration), reference=s.DelayReference.MAXIMUM):
                return duration
            case s.Becomes(lasting=s.FromTo(lower=duration), reference=s.DelayReference.MINIMUM):
                return duration
            case s.Becomes(lasting=s.FromTo(upper=duration), reference=s.DelayReference.MAXIMUM):
                return duration
            case _:
                return None

    # ---- responses at an instant ----

    def demanded(self) -> Formula:
        """The response, as it is demanded at an instant of the trigger."""
        response, shift = self.delayed(), self.shift()
        if shift is None:
            return response
        interval = Interval(self.span, shift, shift)
        if self.end() is None:
            return Eventually(self.span, interval, response)
        return self.throughout(interval, response)

    def delayed(self) -> Formula:
        response = self.response()
        match self.sentence.delay:
            case s.NoDelay():
                return response
            case s.Within(duration=duration):
                return self.eventually(self.up_to(duration), response)
            case s.SentenceWindow(lower=lower, upper=upper):
                first = zero(lower) if lower.value == 0 else lower
                return self.eventually(Interval(self.span, first, upper), response)
            case s.Exactly(duration=duration):
                return self.eventually(Interval(self.span, duration, duration), response)
            case s.AtSomeInstant():
                return self.eventually(self.unbounded(), response)
            case delay:
                assert_never(delay)

    def response(self) -> Formula:
        span = self.span
        response = self.sentence.response
        match response:
            case s.MustBeTrue(condition=condition):
                return condition
            case s.MustStay(condition=condition, lasting=s.AtMost() as lasting) if self.is_triggered(condition):
                return self.lasts(condition, lasting)
            case s.MustStay(condition=condition, lasting=lasting):
                lasts = self.lasts(condition, lasting)
                return both(span, condition, lasts) if isinstance(lasting, s.AtMost) else lasts
            case s.MustStayUntil(condition=condition, end=reached, within=within):
                interval = self.unbounded() if within is None else self.up_to(within)
                end = self.end()
                if end is None:
                    return Until(span, interval, condition, reached)
                inside = negation(end)
                return Until(span, interval, both(span, condition, inside), both(span, reached, inside))
            case s.MustStayOn(condition=condition):
                end = self.end()
                return Always(span, self.unbounded(), condition) if end is None else WeakUntil(span, condition, end)
            case s.MustNotOccur(condition=condition, duration=None):
                return negation(condition)
            case s.MustNotOccur(condition=condition, duration=duration):
                assert duration is not None
                return self.throughout(self.up_to(duration), negation(condition))
            case s.MustHaveBeen(condition=condition, within=within):
                interval = self.unbounded() if within is None else self.up_to(within)
                scope = self.sentence.scope
                if isinstance(scope, s.After):
                    return Once(span, interval, both(span, condition, self.once(scope.start)))
                return Once(span, interval, condition)
            case s.MustOccur() | s.MustRecur():
                raise ValueError("these speak about the whole scope")
            case _:
                assert_never(response)

    def is_triggered(self, condition: Formula) -> bool:
        """True if the trigger itself says that the condition is true when the response is due."""
        trigger = self.sentence.trigger
        return (
            isinstance(trigger, s.Whenever | s.Becomes)
            and trigger.condition == condition
            and (not isinstance(trigger, s.Becomes) or trigger.reference is s.DelayReference.RISE)
            and isinstance(self.sentence.delay, s.NoDelay)
        )

    def lasts(self, condition: Formula, lasting: s.Lasting) -> Formula:
        """The formula that a condition stays true from now for so long; ``at most`` leaves open if it is true now."""
        span = self.span
        match lasting:
            case s.AtLeast(duration=shortest):
                return self.throughout(Interval(span, zero(shortest), shortest, True, False), condition)
            case s.AtMost(duration=longest):
                return self.ends(Interval(span, zero(longest), longest, False, True), condition)
            case s.FromTo(lower=shortest, upper=longest):
                stays = self.throughout(Interval(span, zero(shortest), shortest, True, False), condition)
                return both(span, stays, self.ends(Interval(span, shortest, longest), condition))
            case _:
                assert_never(lasting)

    # ---- operators as far as the scope reaches ----

    def eventually(self, interval: Interval, operand: Formula) -> Formula:
        """At some instant of the window that is in the scope."""
        end = self.end()
        if end is None:
            return Eventually(self.span, interval, operand)
        return Until(self.span, interval, negation(end), both(self.span, operand, negation(end)))

    def throughout(self, interval: Interval, operand: Formula) -> Formula:
        """At every instant of the window that is in the scope."""
        end = self.end()
        if end is None:
            return Always(self.span, interval, operand)
        return Not(self.span, self.eventually(interval, negation(operand)))

    def ends(self, interval: Interval, condition: Formula) -> Formula:
        """The formula that a condition becomes false in the window, or the scope ends."""
        end = self.end()
        over = negation(condition) if end is None else either(self.span, negation(condition), end)
        return Eventually(self.span, interval, over)

    def always(self, operand: Formula) -> Formula:
        return Always(self.span, self.unbounded(), operand)

    def once(self, operand: Formula) -> Formula:
        return Once(self.span, self.unbounded(), operand)

    def first(self, condition: Formula) -> Formula:
        """The first instant at which a condition is true."""
        before = Interval(self.span, Duration(self.span, Fraction(0)), None, False)
        return And(self.span, (*conjuncts(condition), Not(self.span, Once(self.span, before, condition))))

    def unbounded(self) -> Interval:
        return Interval(self.span, Duration(self.span, Fraction(0)), None)

    def up_to(self, duration: Duration) -> Interval:
        return Interval(self.span, zero(duration), duration)


def zero(like: Duration) -> Duration:
    """No time, without a unit, which it needs as little as a number."""
    return Duration(like.span, Fraction(0))
