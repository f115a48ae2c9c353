"""Windows on the past that an observer cannot follow, said of the future.

An observer knows since when a condition has held, but not what happened in a window that ended before now. Inside an
outermost `G`, which is about every instant, one may begin at the other end: what has to be seen is guessed where it
begins. Each rewriting keeps the truth of the whole formula, and which finite runs violate it.
"""

from __future__ import annotations

from fractions import Fraction

from tachk.base.span import Span
from tachk.syntax import formula
from tachk.syntax.formula import Formula

_CLAUSES = 16
"""A formula with more parts that have to hold each is left as it is."""

_Clause = tuple[Formula, ...]
_Past = formula.Once | formula.Historically


def looking_ahead(node: Formula) -> Formula:
    """An equal formula in which windows on the past begin now, as far as a rewriting is known."""
    match node:
        case formula.And(span=span, operands=operands):
            return formula.And(span, tuple(looking_ahead(part) for part in operands))
        case formula.Not(operand=formula.Eventually(span=span, interval=interval, operand=operand)):
            ahead = looking_ahead(formula.Always(span, interval, formula.Not(span, operand)))
            return ahead if _changes(operand, False) else node
        case formula.Always(span=span, interval=interval, operand=operand) if _is_ever(interval):
            clauses = _clauses(operand, True)
            if clauses is None or not _changes(operand, True):
                return node
            parts = [part for clause in clauses for part in _everywhere(clause, span)]
            return parts[0] if len(parts) == 1 else formula.And(span, tuple(parts))
        case _:
            return node


def _is_ever(interval: formula.Interval) -> bool:
    return interval.upper is None and interval.lower_closed and interval.lower.value == 0


def _changes(node: Formula, positive: bool) -> bool:
    """True if something in a formula, or in its negation, has to be said of the future."""
    return any(_is_hard(literal) for clause in _clauses(node, positive) or () for literal in clause)


def _is_hard(literal: Formula) -> bool:
    """True if an observer cannot follow a part about the past as it stands."""
    if not isinstance(literal, _Past):
        return False
    interval = literal.interval
    late = interval.lower.value != 0 or not interval.lower_closed
    operand = literal.operand.operand if isinstance(literal.operand, formula.Not) else literal.operand
    return late or isinstance(operand, formula.Rise | formula.Fall | formula.Change)


def _clauses(node: Formula, positive: bool) -> list[_Clause] | None:
    """Alternatives, one of each of which has to hold; None if there are too many."""
    match node:
        case formula.Not(operand=operand):
            return _clauses(operand, not positive)
        case formula.Implies(span=span, left=left, right=right):
            return _clauses(formula.Or(span, (formula.Not(left.span, left), right)), positive)
        case formula.And(operands=operands) | formula.Or(operands=operands):
            parts = [_clauses(part, positive) for part in operands]
            if isinstance(node, formula.And) is positive:
                found = [clause for part in parts if part is not None for clause in part]
            else:
                found = [()]
                for part in parts:
                    found = [(*one, *other) for one in found for other in part or ()][: _CLAUSES + 1]
            return None if None in parts or len(found) > _CLAUSES else found
        case formula.Once(span=span, interval=interval, operand=operand) if not positive:
            return [(formula.Historically(span, interval, formula.Not(operand.span, operand)),)]
        case formula.Historically(span=span, interval=interval, operand=operand) if not positive:
            return [(formula.Once(span, interval, formula.Not(operand.span, operand)),)]
        case _:
            return [(node if positive else formula.Not(node.span, node),)]


def _everywhere(clause: _Clause, span: Span) -> list[Formula]:
    """The formulas that say that one of some parts holds at every instant."""
    hard = [literal for literal in clause if _is_hard(literal)]
    others = tuple(literal for literal in clause if not _is_hard(literal))
    rest = _any_of(others, span)
    match hard:
        case [formula.Historically(interval=interval, operand=operand)]:
            return [_always(formula.Or(span, (operand, formula.Always(span, interval, rest))))]
        case [formula.Once() as once] if _absent(once.operand) and not _is_empty(once.interval):
            return _once(once, rest)
        case _:
            return [_always(_any_of(clause, span))]


def _once(once: formula.Once, rest: Formula) -> list[Formula]:
    """The formulas that say that at every instant the rest holds, or the operand held in the past window.

    Behind its upper bound a window is complete; before, it is cut at 0: what lacks in it has lacked from there on. What
    has lacked from 0 on lacks in a complete window too, so that this part needs no bound.
    """
    span, interval = once.span, once.interval
    low = _number(interval.lower)
    high = None if interval.upper is None else _number(interval.upper)
    length = None if high is None else high - low
    fails = formula.Not(span, rest)
    parts: list[Formula] = []
    if low > 0 or not interval.lower_closed:
        parts.append(formula.Always(span, _window(span, 0, low, True, not interval.lower_closed), rest))
    late = fails if low == 0 else formula.Eventually(span, _window(span, low, low), fails)
    if length is None or length > 0:
        for phases in _absent(once.operand):
            seen: Formula = formula.And(span, (phases[-1], late)) if interval.lower_closed else late
            for phase in reversed(phases):
                seen = formula.Until(span, _window(span, 0, None), phase, seen)
            parts.append(formula.Not(span, seen))
    if high is not None and length is not None:
        inside = _window(span, 0, length, interval.upper_closed, interval.lower_closed)
        behind = formula.Eventually(span, _window(span, high, high), rest)
        parts.append(_always(formula.Or(span, (formula.Eventually(span, inside, once.operand), behind))))
    return parts


def _absent(operand: Formula) -> tuple[tuple[Formula, ...], ...]:
    """The conditions that may have held from 0 on, one after the other, if the operand has never been true; none if
    conditions on one state do not express that."""
    span = operand.span
    match operand:
        case formula.Rise(operand=risen):
            return ((formula.Not(span, risen),),)
        case formula.Fall(operand=fallen):
            before = formula.Not(span, fallen)
            return (before,), (before, fallen)
        case formula.Change() | formula.Not(operand=formula.Rise() | formula.Fall() | formula.Change()):
            return ()
        case _:
            return ((formula.Not(span, operand),),)


def _is_empty(interval: formula.Interval) -> bool:
    closed = interval.lower_closed and interval.upper_closed
    return interval.upper is not None and interval.upper.value == interval.lower.value and not closed


def _number(duration: formula.Duration) -> Fraction:
    assert isinstance(duration.value, Fraction)
    return duration.value


def _window(
    span: Span, low: Fraction | int, high: Fraction | int | None, low_closed: bool = True, high_closed: bool = True
) -> formula.Interval:
    upper = None if high is None else formula.Duration(span, Fraction(high))
    return formula.Interval(span, formula.Duration(span, Fraction(low)), upper, low_closed, high_closed)


def _always(node: Formula) -> Formula:
    return formula.Always(node.span, _window(node.span, 0, None), node)


def _any_of(parts: tuple[Formula, ...], span: Span) -> Formula:
    if not parts:
        return formula.TruthConstant(span, False)
    return parts[0] if len(parts) == 1 else formula.Or(span, parts)
