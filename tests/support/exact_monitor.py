"""A textbook evaluator of temporal formulas over exact traces: the oracle that every monitor is tested against.

Definitions are followed word by word, over rational time. A signal is a list of points with the open intervals between
them, constant on each; a window is an interval of rational numbers; the supremum over a window is taken over the
pieces that meet it. Nothing here is fast, and nothing is shared with the monitors.

The meaning (docs/logic.md states it for users), at an instant t of a trace that ends at T:

- ``F[a,b] f`` is the supremum of f over ``[t+a, t+b]``, ``O[a,b] f`` that over ``[t-b, t-a]`` as far as it is not
  before 0; G and H are their duals. Ends may be open. The supremum over nothing is false.
- ``f U[a,b] g``: some t' of the window ahead has g, and every instant of ``[t, t')`` has f. ``f S[a,b] g``: some t' of
  the window behind has g, and every instant of ``(t', t]`` has f. ``f W g`` is ``(f U g) || G f``.
- ``rise(f)`` at t is f at t and not f just before t (the limit from the left); ``fall(f)`` is not f at t and f just
  before. At 0, ``rise(f)`` is f and ``fall(f)`` is false. Between two points, where f does not move, "just before" has
  the value of t itself, also behind a point at which f differs: so nothing depends on how finely time is divided.
  ``change(e)``: e at t differs from e just before t, with infinite robustness; false at 0. Of a comparison or another
  condition c it is ``fall(c) || fall(!c)``, with the robustness of that.
- Atoms are unknown after T (for an open trace also at T). Everything else follows by Kleene's rules, truth and
  robustness alike, and an instant after T is evaluated like any other.
- An operator without upper bound speaks about the trace up to its end. At an instant t <= T of a finished trace its
  window is cut at T. Where the end is not known (in an unfinished trace, and at an instant after T), it is somewhere
  at or after both T and t: the value is then undetermined unless it is the same for all these ends.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from tachk.syntax import formula as syntax
from tests.support.exact_trace import (
    FALSE,
    TRUE,
    UNKNOWN,
    Ending,
    ExactTrace,
    Scalar,
    Value,
    condition,
    is_condition,
    number,
)


@dataclass(frozen=True, slots=True)
class ExactSignal:
    """A value for every instant from 0 on.

    Attributes:
        points: ascending, the first is 0.
        at: the value at each point.
        after: the value on the open interval from each point to the next, from the last one without end.
    """

    points: tuple[Fraction, ...]
    at: tuple[Value, ...]
    after: tuple[Value, ...]

    def value(self, instant: Fraction) -> Value:
        index = bisect_right(self.points, instant) - 1
        return self.at[index] if self.points[index] == instant else self.after[index]

    def just_before(self, instant: Fraction) -> Value:
        """The value on the piece of time before an instant that is not 0."""
        index = bisect_right(self.points, instant) - 1
        return self.after[index - 1] if self.points[index] == instant else self.after[index]


@dataclass(frozen=True, slots=True)
class Window:
    """An interval of instants; without end where ``upper`` is None. It may be empty."""

    lower: Fraction
    lower_closed: bool
    upper: Fraction | None
    upper_closed: bool

    def cut(self, end: Fraction) -> Window:
        """Its part up to an instant, included."""
        if self.upper is not None and self.upper <= end:
            return self
        return Window(self.lower, self.lower_closed, end, True)

    def representatives(self, points: Sequence[Fraction]) -> Iterator[Fraction]:
        """One instant for each piece of time that meets the window, where pieces are points and what lies between.

        Args:
            points: ascending.
        """
        if self.upper is not None and self.lower > self.upper:
            return
        first = bisect_left(points, self.lower)
        last = len(points) if self.upper is None else bisect_right(points, self.upper)
        bounds = list(points[first:last])
        if not bounds or bounds[0] != self.lower:
            bounds.insert(0, self.lower)
        if self.upper is not None and bounds[-1] != self.upper:
            bounds.append(self.upper)
        for index, bound in enumerate(bounds):
            if (index > 0 or self.lower_closed) and (bound != self.upper or self.upper_closed):
                yield bound
            if index + 1 < len(bounds):
                yield (bound + bounds[index + 1]) / 2
            elif self.upper is None:
                yield bound + 1


def verdict(formula: syntax.Formula, trace: ExactTrace) -> Value:
    """The value of a formula: that at time 0."""
    return value_at(formula, trace, Fraction(0))


def value_at(formula: syntax.Formula, trace: ExactTrace, instant: Fraction) -> Value:
    """The value at any instant, be it after the end."""
    return satisfaction(formula, trace).value(instant)


def satisfaction(formula: syntax.Formula, trace: ExactTrace) -> ExactSignal:
    """The value at every instant. Durations in the formula have to be numbers, in the time unit of the trace."""
    match formula:
        case syntax.TruthConstant(value=value):
            return signal_of({Fraction(0)}, lambda _: TRUE if value else FALSE)
        case syntax.Atom(expression=expression):
            return _of_states(trace, lambda state: condition(expression, state))
        case syntax.Change(span=span, expression=expression) if is_condition(expression):
            atom = syntax.Atom(span, expression)
            falls = syntax.Fall(span, atom), syntax.Fall(span, syntax.Not(span, atom))
            return satisfaction(syntax.Or(span, falls), trace)
        case syntax.Change(expression=expression):
            return change_of(trace, lambda state: number(expression, state))
        case syntax.Not(operand=operand):
            inner = satisfaction(operand, trace)
            return signal_of(inner.points, lambda t: ~inner.value(t))
        case syntax.And(operands=operands):
            return combined([satisfaction(operand, trace) for operand in operands], lambda left, right: left & right)
        case syntax.Or(operands=operands):
            return combined([satisfaction(operand, trace) for operand in operands], lambda left, right: left | right)
        case syntax.Implies(left=left, right=right):
            return satisfaction(syntax.Or(formula.span, (syntax.Not(left.span, left), right)), trace)
        case syntax.Rise(operand=operand):
            inner = satisfaction(operand, trace)
            return signal_of(inner.points, lambda t: inner.value(t) & ~before(inner, t))
        case syntax.Fall(operand=operand):
            inner = satisfaction(operand, trace)
            return signal_of(inner.points, lambda t: ~inner.value(t) & before(inner, t))
        case syntax.Eventually(interval=interval, operand=operand):
            return ahead(interval, signal_of({Fraction(0)}, lambda _: TRUE), satisfaction(operand, trace), trace)
        case syntax.Always(interval=interval, operand=operand):
            negated = syntax.Not(operand.span, operand)
            return satisfaction(syntax.Not(formula.span, syntax.Eventually(formula.span, interval, negated)), trace)
        case syntax.Until(interval=interval, left=left, right=right):
            return ahead(interval, satisfaction(left, trace), satisfaction(right, trace), trace)
        case syntax.WeakUntil(left=left, right=right):
            return satisfaction(weak_until(formula, left, right), trace)
        case syntax.Once(interval=interval, operand=operand):
            return behind(interval, signal_of({Fraction(0)}, lambda _: TRUE), satisfaction(operand, trace))
        case syntax.Historically(interval=interval, operand=operand):
            negated = syntax.Not(operand.span, operand)
            return satisfaction(syntax.Not(formula.span, syntax.Once(formula.span, interval, negated)), trace)
        case syntax.Since(interval=interval, left=left, right=right):
            return behind(interval, satisfaction(left, trace), satisfaction(right, trace))


def weak_until(formula: syntax.WeakUntil, left: syntax.Formula, right: syntax.Formula) -> syntax.Formula:
    span = formula.span
    ever = syntax.Interval(span, syntax.Duration(span, Fraction(0)), None)
    return syntax.Or(span, (syntax.Until(span, ever, left, right), syntax.Always(span, ever, left)))


def signal_of(points: Iterable[Fraction], value: Callable[[Fraction], Value]) -> ExactSignal:
    """The signal with these values, which must be constant between the points; points at which nothing happens are
    left out."""
    ordered = sorted({point for point in points if point > 0} | {Fraction(0)})
    between = [(left + right) / 2 for left, right in pairwise(ordered)] + [ordered[-1] + 1]
    at, after = [value(point) for point in ordered], [value(instant) for instant in between]
    kept = [i for i in range(len(ordered)) if i == 0 or not after[i - 1] == at[i] == after[i]]
    return ExactSignal(tuple(ordered[i] for i in kept), tuple(at[i] for i in kept), tuple(after[i] for i in kept))


def _of_states(trace: ExactTrace, value: Callable[[dict[str, Scalar]], Value]) -> ExactSignal:
    def at(instant: Fraction) -> Value:
        state = trace.state_at(instant)
        return UNKNOWN if state is None else value(dict(state))

    return signal_of({*trace.times, trace.end}, at)


def change_of(trace: ExactTrace, value: Callable[[dict[str, Scalar]], Fraction]) -> ExactSignal:
    points = sorted({*trace.times, trace.end})

    def at(instant: Fraction) -> Value:
        if instant == 0:
            return FALSE
        now = trace.state_at(instant)
        index = max(i for i, point in enumerate(points) if point < instant)
        before = trace.state_at((points[index] + instant) / 2)
        if now is None or before is None:
            return UNKNOWN
        return TRUE if value(dict(now)) != value(dict(before)) else FALSE

    return signal_of(points, at)


def combined(signals: list[ExactSignal], operator: Callable[[Value, Value], Value]) -> ExactSignal:
    def at(instant: Fraction) -> Value:
        result = signals[0].value(instant)
        for signal in signals[1:]:
            result = operator(result, signal.value(instant))
        return result

    return signal_of({point for signal in signals for point in signal.points}, at)


def before(signal: ExactSignal, instant: Fraction) -> Value:
    """What was before an instant; before the trace everything is false."""
    return FALSE if instant == 0 else signal.just_before(instant)


def ahead(interval: syntax.Interval, left: ExactSignal, right: ExactSignal, trace: ExactTrace) -> ExactSignal:
    """``left U interval right``."""
    lower, upper = _bounds(interval)
    points = sorted({*left.points, *right.points, trace.end})
    shifts = {Fraction(0), lower, *(() if upper is None else (upper,))}

    def at(instant: Fraction) -> Value:
        window = Window(
            instant + lower,
            interval.lower_closed,
            None if upper is None else instant + upper,
            interval.upper_closed,
        )
        certain = possible = window
        if upper is None:
            certain = window.cut(max(trace.end, instant))
            if trace.ending is Ending.FINISHED and instant <= trace.end:
                possible = certain
        return _between(witnesses(instant, certain), witnesses(instant, possible))

    def witnesses(instant: Fraction, window: Window) -> Value:
        result = FALSE
        for witness in window.representatives(points):
            meanwhile = Window(instant, True, witness, False)
            result |= right.value(witness) & _everywhere(left, meanwhile)
        return result

    return signal_of({point - shift for point in points for shift in shifts}, at)


def behind(interval: syntax.Interval, left: ExactSignal, right: ExactSignal) -> ExactSignal:
    """``left S interval right``."""
    lower, upper = _bounds(interval)
    points = sorted({*left.points, *right.points})
    shifts = {Fraction(0), lower, *(() if upper is None else (upper,))}

    def at(instant: Fraction) -> Value:
        if upper is None or instant < upper:
            window = Window(Fraction(0), True, instant - lower, interval.lower_closed)
        else:
            window = Window(instant - upper, interval.upper_closed, instant - lower, interval.lower_closed)
        result = FALSE
        for witness in window.representatives(points):
            meanwhile = Window(witness, False, instant, True)
            result |= right.value(witness) & _everywhere(left, meanwhile)
        return result

    return signal_of({point + shift for point in points for shift in shifts}, at)


def _everywhere(signal: ExactSignal, window: Window) -> Value:
    result = TRUE
    for instant in window.representatives(signal.points):
        result &= signal.value(instant)
    return result


def _between(certain: Value, possible: Value) -> Value:
    """The value of a supremum whose set surely holds the first, and at most the second set of instants."""
    if certain.truth is True:
        truth: bool | None = True
    else:
        truth = False if possible.truth is False else None
    return Value(truth, certain.low, possible.high)


def _bounds(interval: syntax.Interval) -> tuple[Fraction, Fraction | None]:
    lower = interval.lower.value
    upper = None if interval.upper is None else interval.upper.value
    if not isinstance(lower, Fraction) or not (upper is None or isinstance(upper, Fraction)):
        raise TypeError("durations have to be numbers")
    return lower, upper
