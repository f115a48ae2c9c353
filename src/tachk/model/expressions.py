"""Typed expressions and statements: what elaboration makes of the text, and what scripts build directly.

Every name is resolved to the `Variable` or `Function` object it means, every template parameter has been replaced by
its argument, every node knows its type. Equality ignores places.
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import StrEnum

from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.base.records import dataclass, field
from tachk.base.span import NOWHERE, Span
from tachk.model.floating import FloatingOperation, hybrid_offsets
from tachk.model.types import BoolType, IntType, Type, slot_count


class VariableKind(StrEnum):
    GLOBAL = "global"
    LOCAL = "local"
    """Declared in a process; one object per process."""
    FRAME = "frame"
    """A parameter or local variable of a function."""
    BOUND = "bound"
    """Bound by ``select``, ``forall``, ``exists``, ``sum`` or an iteration ``for (i : T)``."""


@dataclass(frozen=True, eq=False, slots=True)
class Variable:
    """A place that holds a value. Compared by identity.

    Attributes:
        name: unique within the network for global and local variables (``P.x`` for the local ``x`` of process ``P``).
        type: any type; clocks and channels are variables too.
        initial: one integer for each slot (see `types.leaves`); channels have 0 there.
        declared_meta: the declaration says `meta`. `Network.resets` says whether transitions take it so.
        reference: a function parameter passed by reference.
        priorities: for channels, one priority for each slot; empty means the network's default priority.
        carries: the channel whose values pass through this hidden variable, slot by slot.
        is_hybrid: floating point numbers that change while time passes, with the rates of locations. Fields of records
            are so by their type, see `has_hybrid_clocks`.
        drawn: its initial value where that is drawn anew for each run. Only simulations have such variables.
    """

    name: str
    type: Type
    kind: VariableKind
    initial: tuple[int, ...] = ()
    declared_meta: bool = False
    reference: bool = False
    priorities: tuple[int, ...] = ()
    span: Span = NOWHERE
    carries: Variable | None = None
    is_hybrid: bool = False
    drawn: Expression | None = None

    def hybrid_clocks(self) -> Iterator[int]:
        """The slots at which its hybrid clocks begin."""
        return iter(range(0, slot_count(self.type), 2)) if self.is_hybrid else hybrid_offsets(self.type)

    @property
    def has_hybrid_clocks(self) -> bool:
        return any(True for _ in self.hybrid_clocks())


class QuantifierKind(StrEnum):
    """What is done with the values of the body."""

    FORALL = "forall"
    EXISTS = "exists"
    SUM = "sum"

    @property
    def joins(self) -> BinaryOperator:
        """The operator that joins the values of the body."""
        match self:
            case QuantifierKind.FORALL:
                return BinaryOperator.AND
            case QuantifierKind.EXISTS:
                return BinaryOperator.OR
            case QuantifierKind.SUM:
                return BinaryOperator.ADD


INT = IntType()
BOOL = BoolType()


def _span() -> Span:
    return field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Constant:
    value: int
    type: Type = INT
    span: Span = _span()


@dataclass(frozen=True, slots=True)
class Reference:
    """The value, or as an assignment target the place, of a variable."""

    variable: Variable
    span: Span = _span()

    @property
    def type(self) -> Type:
        return self.variable.type


@dataclass(frozen=True, slots=True)
class Index:
    """``base[index]``; an index out of range is a run-time error."""

    base: Expression
    index: Expression
    type: Type
    span: Span = _span()


@dataclass(frozen=True, slots=True)
class Field:
    base: Expression
    name: str
    type: Type
    span: Span = _span()


@dataclass(frozen=True, slots=True)
class Aggregate:
    """``{1, {2, 3}}``: the items of an array or the fields of a record, in declaration order."""

    items: tuple[Expression, ...]
    type: Type
    span: Span = _span()


@dataclass(frozen=True, slots=True)
class Unary:
    operator: UnaryOperator
    operand: Expression
    type: Type
    span: Span = _span()


@dataclass(frozen=True, slots=True)
class Binary:
    """Comparisons may have clocks, or differences of two clocks, on either side; EQUAL may compare aggregates."""

    operator: BinaryOperator
    left: Expression
    right: Expression
    type: Type
    span: Span = _span()


@dataclass(frozen=True, slots=True)
class Conditional:
    """``condition ? then : otherwise``; may be an assignment target."""

    condition: Expression
    then: Expression
    otherwise: Expression
    type: Type
    span: Span = _span()


@dataclass(frozen=True, slots=True)
class Quantifier:
    """``forall (v : T) body``, ``exists`` and ``sum``; the variable's type is a bounded integer, bool or scalar."""

    kind: QuantifierKind
    variable: Variable
    body: Expression
    type: Type
    span: Span = _span()


@dataclass(frozen=True, slots=True)
class Assign:
    """``target = value``; ``operator`` ADD means ``target += value`` and so on. Its value is the target's new value.

    With a clock as the target, ``value`` is a non-negative integer expression, the place of a clock, or a sum of both
    (`tachk.model.clock_sums`). Aggregates are copied slot by slot.
    """

    target: Expression
    value: Expression
    type: Type
    operator: BinaryOperator | None = None
    span: Span = _span()


@dataclass(frozen=True, slots=True)
class Increment:
    """``++x``, ``x++`` (delta 1), ``--x``, ``x--`` (delta -1); a prefix form has the new value, a postfix the old."""

    target: Expression
    delta: int
    prefix: bool
    type: Type
    span: Span = _span()


@dataclass(frozen=True, slots=True)
class Call:
    """A call; an argument for a reference parameter is an assignable expression."""

    function: Function
    arguments: tuple[Expression, ...]
    type: Type
    span: Span = _span()


@dataclass(frozen=True, slots=True)
class Comma:
    """``a, b``: evaluates both, has the value of the last."""

    items: tuple[Expression, ...]
    type: Type
    span: Span = _span()


@dataclass(frozen=True, slots=True)
class LocationTest:
    """``P.loc`` in a query or signal: process number and location number."""

    process: int
    location: int
    type: Type = BOOL
    span: Span = _span()


@dataclass(frozen=True, slots=True)
class Deadlock:
    """``deadlock`` in a query: no action is possible now or after any delay."""

    type: Type = BOOL
    span: Span = _span()


Expression = (
    Constant
    | Reference
    | Index
    | Field
    | Aggregate
    | Unary
    | Binary
    | Conditional
    | Quantifier
    | Assign
    | Increment
    | Call
    | Comma
    | LocationTest
    | Deadlock
)


@dataclass(frozen=True, slots=True)
class Evaluate:
    """An expression statement."""

    expression: Expression


@dataclass(frozen=True, slots=True)
class Declare:
    """Gives a frame variable its value when control passes; slots without ``initial`` get the type's default 0
    (or its lower bound, where 0 is outside)."""

    variable: Variable
    initial: Expression | None = None


@dataclass(frozen=True, slots=True)
class Block:
    statements: tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class If:
    condition: Expression
    then: Statement
    otherwise: Statement | None = None


@dataclass(frozen=True, slots=True)
class While:
    """``while`` and ``for (init; condition; step)`` loops; ``do`` loops have ``test_first`` false."""

    condition: Expression
    body: Statement
    test_first: bool = True


@dataclass(frozen=True, slots=True)
class Iterate:
    """``for (v : T) body`` over all values of a bounded type, in ascending order."""

    variable: Variable
    body: Statement


@dataclass(frozen=True, slots=True)
class Return:
    value: Expression | None = None


@dataclass(frozen=True, slots=True)
class Assert:
    condition: Expression


Statement = Evaluate | Declare | Block | If | While | Iterate | Return | Assert


@dataclass(frozen=True, eq=False, slots=True)
class Function:
    """A function with its body. Compared by identity; a function local to a template is one object per process.

    Functions cannot be recursive. Arguments and results outside their declared range are run-time errors.

    Attributes:
        operation: what a function without statements computes (`tachk.model.floating_calls` has all of them).
    """

    name: str
    parameters: tuple[Variable, ...]
    result: Type
    body: Block
    span: Span = NOWHERE
    operation: FloatingOperation | None = None
