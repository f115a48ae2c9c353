"""Simpler formulas of exactly the same meaning.

Every rule keeps the truth value, the interval of robustness and what is undetermined, at every instant of every
trace, finished or not. The reasons, rule by rule:

- Truth values and robustness form distributive lattices with min and max, in which the constants are the extremes and
  negation turns the order around. So identities of such lattices may be used: constants, double negation, flattening,
  idempotence, absorption (``a && (a || b)`` is a). Those of Boolean algebra beyond them may not: ``a || !a`` has the
  distance of a from its boundary as robustness, not infinity, and is undetermined where a is. Nor may ``3 < 5`` become
  ``true``, for its robustness is 2, or ``change(3)`` ``false``, which is undetermined behind the end.
- A window that holds exactly the present ([0,0]) leaves the operand; a window that holds nothing ((a,a] and the like)
  leaves false for F, O, U, S and true for G, H.
- ``F true`` is true only where the window cannot be empty: it is when it lies behind the end of a finished trace, or
  before the beginning. So bounds that are not numbers, unbounded operators that begin later than now, and operators on
  the past that do, are left alone.
- ``F[a,b] F[c,d] f`` is ``F[a+c,b+d] f``, closed where both are, for a sum of windows is a window. Not if only one of
  the two is without end: at the end of a trace the bounded one waits for what comes, the other one does not. On the
  past, where the beginning is known, they may differ.
- An until whose left side is false, or whose right side is a constant, is decided by the present or by the window.
- ``rise(true)`` is true at time 0 and is left alone; an edge of another constant is false.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import Any

from tachk.base.records import replace
from tachk.base.span import Span
from tachk.syntax.formula import (
    Always,
    And,
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
    Since,
    TruthConstant,
    Until,
    WeakUntil,
    all_time,
)
from tachk.syntax.rewrite import rewrite

_Window = Eventually | Always | Once | Historically
_PAST = (Once, Historically, Since)


def simplify(formula: Formula) -> Formula:
    """The formula after all rules, from the inside out; simplifying it again changes nothing."""
    return rewrite(formula, _simpler)


def _simpler(node: Any) -> Any:
    match node:
        case Not(operand=TruthConstant(value=value)):
            return TruthConstant(node.span, not value)
        case Not(operand=Not(operand=operand)):
            return operand
        case And(span=span, operands=operands):
            return _joined(span, operands, And, Or, neutral=True)
        case Or(span=span, operands=operands):
            return _joined(span, operands, Or, And, neutral=False)
        case Implies():
            return _implication(node)
        case Rise(operand=TruthConstant(value=False)) | Fall(operand=TruthConstant()):
            return TruthConstant(node.span, False)
        case Eventually() | Always() | Once() | Historically():
            return _windowed(node)
        case Until() | Since():
            return _until(node)
        case WeakUntil():
            return _weak_until(node)
        case _:
            return node


def _joined(
    span: Span,
    operands: Iterable[Formula],
    kind: type[And] | type[Or],
    dual: type[And] | type[Or],
    neutral: bool,
) -> Formula:
    parts: dict[Formula, None] = {}
    for operand in operands:
        for part in operand.operands if isinstance(operand, kind) else (operand,):
            if isinstance(part, TruthConstant):
                if part.value is not neutral:
                    return TruthConstant(span, not neutral)
            else:
                parts[part] = None
    parts_left = [
        part for part in parts if not (isinstance(part, dual) and any(inner in parts for inner in part.operands))
    ]
    if not parts_left:
        return TruthConstant(span, neutral)
    return parts_left[0] if len(parts_left) == 1 else kind(span, tuple(parts_left))


def _implication(node: Implies) -> Formula:
    match node.left, node.right:
        case TruthConstant(value=True), right:
            return right
        case (TruthConstant(value=False), _) | (_, TruthConstant(value=True)):
            return TruthConstant(node.span, True)
        case left, TruthConstant(value=False):
            negated: Formula = _simpler(Not(node.span, left))
            return negated
        case _:
            return node


def _windowed(node: _Window) -> Formula:
    interval, operand = node.interval, node.operand
    empty_value = isinstance(node, Always | Historically)
    if is_empty(interval):
        return TruthConstant(node.span, empty_value)
    if is_now(interval):
        return operand
    if isinstance(operand, TruthConstant) and (operand.value is empty_value or _never_empty(node, interval)):
        return TruthConstant(node.span, operand.value)
    if type(operand) is type(node):
        both = _sum(interval, operand.interval, past=isinstance(node, _PAST))
        if both is not None:
            return replace(node, interval=both, operand=operand.operand)
    return node


def _until(node: Until | Since) -> Formula:
    span, interval, left, right = node.span, node.interval, node.left, node.right
    window = Eventually if isinstance(node, Until) else Once
    if is_empty(interval) or right == TruthConstant(span, False):
        return TruthConstant(span, False)
    if is_now(interval):
        return right
    if left == TruthConstant(span, True):
        return _windowed(window(span, interval, right))
    now = _includes_now(interval)
    if now and (right == TruthConstant(span, True) or left == right):
        return right
    if left == TruthConstant(span, False) and now is not None:
        return right if now else TruthConstant(span, False)
    return node


def _weak_until(node: WeakUntil) -> Formula:
    span, left, right = node.span, node.left, node.right
    if TruthConstant(span, True) in (left, right):
        return TruthConstant(span, True)
    if right == TruthConstant(span, False):
        return _windowed(Always(span, all_time(span), left))
    if left == TruthConstant(span, False) or left == right:
        return right
    return node


# ---- intervals ----------------------------------------------------------------------------------------------------


def is_empty(interval: Interval) -> bool:
    """True if no distance lies in the interval, as in (a,a]."""
    lower, upper = _lower(interval), _upper(interval)
    if lower is None or upper is None:
        return False
    return lower > upper or (lower == upper and not (interval.lower_closed and interval.upper_closed))


def is_now(interval: Interval) -> bool:
    """True if the interval is [0,0]."""
    return _lower(interval) == 0 == _upper(interval) and interval.lower_closed and interval.upper_closed


def _lower(interval: Interval) -> Fraction | None:
    """The lower bound, or None if it is not a number yet."""
    return _number(interval.lower)


def _upper(interval: Interval) -> Fraction | None:
    """The upper bound, or None if there is none or it is not a number yet."""
    return None if interval.upper is None else _number(interval.upper)


def _number(duration: Duration) -> Fraction | None:
    if not isinstance(duration.value, Fraction):
        return None
    return duration.value if not duration.unit or duration.value == 0 else None


def _includes_now(interval: Interval) -> bool | None:
    """True if 0 lies in an interval that is not empty; None if that is not known."""
    lower = _lower(interval)
    if lower is None:
        return None
    if interval.upper is not None and _upper(interval) is None:
        return None  # [0, N) may be empty
    return lower == 0 and interval.lower_closed


def _never_empty(node: _Window, interval: Interval) -> bool:
    """True if the window holds an instant wherever it is opened, on every trace."""
    if _includes_now(interval):
        return True
    return not isinstance(node, _PAST) and _lower(interval) is not None and _upper(interval) is not None


def _sum(outer: Interval, inner: Interval, past: bool) -> Interval | None:
    """The window that two windows make one after the other, neither empty; None if there is no such one."""
    lowers = _lower(outer), _lower(inner)
    if lowers[0] is None or lowers[1] is None:
        return None
    unbounded = outer.upper is None, inner.upper is None
    if any(unbounded) and not (past or all(unbounded)):
        return None
    lower = replace(outer.lower, value=lowers[0] + lowers[1], unit="")
    lower_closed = outer.lower_closed and inner.lower_closed
    if any(unbounded):
        bounded = next((i for i in (outer, inner) if i.upper is not None), None)
        if bounded is not None and _upper(bounded) is None:
            return None  # it may be empty
        return Interval(outer.span, lower, None, lower_closed)
    uppers = _upper(outer), _upper(inner)
    if uppers[0] is None or uppers[1] is None:
        return None
    assert outer.upper is not None
    upper = replace(outer.upper, value=uppers[0] + uppers[1], unit="")
    return Interval(outer.span, lower, upper, lower_closed, outer.upper_closed and inner.upper_closed)
