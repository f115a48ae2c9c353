"""The tree of a temporal formula: STL over the signals of a model or the columns of a trace.

One family of nodes serves every stage. Boolean connectives are nodes of the formula, so an `Atom` holds an expression
whose outermost operator is not a connective: a name, a comparison, a call, a quantifier. The exceptions are chains of
conditions on one state that would be deep trees: of ``xor``, and long ones of ``imply``. Durations are
numbers once the time unit and the constants are known (`tachk.logic.durations`). docs/logic.md states the meaning.
"""

from __future__ import annotations

from fractions import Fraction

from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.syntax.ast.expressions import Expression
from tachk.syntax.ast.nodes import Node


@dataclass(frozen=True, slots=True)
class Duration(Node):
    """Attributes:
    value: a number, or an expression over the constants of the model.
    unit: ``us``, ``ms``, ``s``, ``min``, ``h``, ... as written; empty: the unit of the model or the trace.
    """

    value: Fraction | Expression
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Interval(Node):
    """From ``lower`` to ``upper``, without an end where ``upper`` is None. Operators without brackets have [0, oo)."""

    lower: Duration
    upper: Duration | None
    lower_closed: bool = True
    upper_closed: bool = True


@dataclass(frozen=True, slots=True)
class TruthConstant(Node):
    value: bool


@dataclass(frozen=True, slots=True)
class Atom(Node):
    """A condition on one state."""

    expression: Expression


@dataclass(frozen=True, slots=True)
class Not(Node):
    operand: Formula


@dataclass(frozen=True, slots=True)
class And(Node):
    """Two operands or more."""

    operands: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Or(Node):
    """Two operands or more."""

    operands: tuple[Formula, ...]


@dataclass(frozen=True, slots=True)
class Implies(Node):
    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class Rise(Node):
    """The instants at which the operand becomes true; at time 0 if it is true there."""

    operand: Formula


@dataclass(frozen=True, slots=True)
class Fall(Node):
    """The instants at which the operand becomes false; never at time 0."""

    operand: Formula


@dataclass(frozen=True, slots=True)
class Change(Node):
    """The instants at which the value of an expression becomes another; never at time 0."""

    expression: Expression


@dataclass(frozen=True, slots=True)
class Eventually(Node):
    """``F[a,b] f``: at some instant of the window ahead."""

    interval: Interval
    operand: Formula


@dataclass(frozen=True, slots=True)
class Always(Node):
    """``G[a,b] f``: at every instant of the window ahead."""

    interval: Interval
    operand: Formula


@dataclass(frozen=True, slots=True)
class Once(Node):
    """``O[a,b] f``: at some instant of the window behind, as far as the trace reaches back."""

    interval: Interval
    operand: Formula


@dataclass(frozen=True, slots=True)
class Historically(Node):
    """``H[a,b] f``: at every instant of the window behind, as far as the trace reaches back."""

    interval: Interval
    operand: Formula


@dataclass(frozen=True, slots=True)
class Until(Node):
    """``f U[a,b] g``: g at some instant t' of the window ahead, f from now to before t' (half-open)."""

    interval: Interval
    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class WeakUntil(Node):
    """``f W g``: f U g, or f for ever."""

    left: Formula
    right: Formula


@dataclass(frozen=True, slots=True)
class Since(Node):
    """``f S[a,b] g``: g at some instant t' of the window behind, f from after t' to now (half-open)."""

    interval: Interval
    left: Formula
    right: Formula


Formula = (
    TruthConstant
    | Atom
    | Not
    | And
    | Or
    | Implies
    | Rise
    | Fall
    | Change
    | Eventually
    | Always
    | Once
    | Historically
    | Until
    | WeakUntil
    | Since
)
"""Any formula."""


def operands(formula: Formula) -> tuple[Formula, ...]:
    """The formulas directly inside, from left to right."""
    match formula:
        case And(operands=parts) | Or(operands=parts):
            return parts
        case Implies(left=left, right=right) | WeakUntil(left=left, right=right):
            return left, right
        case Until(left=left, right=right) | Since(left=left, right=right):
            return left, right
        case TruthConstant() | Atom() | Change():
            return ()
        case Not() | Rise() | Fall() | Eventually() | Always() | Once() | Historically():
            return (formula.operand,)


def all_time(span: Span) -> Interval:
    """The interval of an operator without brackets: from 0 on, without end."""
    start = Span(span.source, span.start, span.start)
    return Interval(start, Duration(start, Fraction(0)), None)
