"""Networks written as Python: for scripts, experiments and tests.

    network = NetworkBuilder()
    press = network.channel("press")
    lamp = network.process("Lamp")
    y = lamp.clock("y")
    off, low, bright = lamp.location("Off"), lamp.location("Low"), lamp.location("Bright")
    lamp.edge(off, low, receive=press, updates=[y.assign(0)])
    lamp.edge(low, bright, guard=y < 5, receive=press)
    ...
    network.build()

Operators on a `Term` build expressions: ``&``, ``|`` and ``~`` are the logical connectives (mind their precedence:
``(x <= 3) & (n == 0)``), ``//`` is the language's truncating division.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from tachk.base.operators import BinaryOperator, OperandGroup, UnaryOperator
from tachk.base.words import Direction
from tachk.model.expressions import (
    BOOL,
    INT,
    Assign,
    Binary,
    Conditional,
    Constant,
    Deadlock,
    Expression,
    Field,
    Index,
    LocationTest,
    Quantifier,
    QuantifierKind,
    Reference,
    Unary,
    Variable,
    VariableKind,
)
from tachk.model.network import DEFAULT_PRIORITY, Edge, Location, Network, Process, Synchronisation
from tachk.model.types import (
    ArrayType,
    BoolType,
    ChannelType,
    ClockType,
    IntType,
    RecordType,
    ScalarLike,
    Type,
    integer_range,
)
from tachk.model.variable_layout import default_values


class Term:
    """An expression that Python's operators build on. Comparing terms gives a term, so terms have no hash."""

    __slots__ = ("expression",)
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, expression: Expression) -> None:
        self.expression = expression

    def _with(self, operator: BinaryOperator, other: Operand) -> Term:
        return Term(_binary(operator, self.expression, expression_of(other)))

    def _after(self, operator: BinaryOperator, other: Operand) -> Term:
        return Term(_binary(operator, expression_of(other), self.expression))

    def __add__(self, other: Operand) -> Term:
        return self._with(BinaryOperator.ADD, other)

    def __radd__(self, other: Operand) -> Term:
        return self._after(BinaryOperator.ADD, other)

    def __sub__(self, other: Operand) -> Term:
        return self._with(BinaryOperator.SUBTRACT, other)

    def __rsub__(self, other: Operand) -> Term:
        return self._after(BinaryOperator.SUBTRACT, other)

    def __mul__(self, other: Operand) -> Term:
        return self._with(BinaryOperator.MULTIPLY, other)

    def __rmul__(self, other: Operand) -> Term:
        return self._after(BinaryOperator.MULTIPLY, other)

    def __floordiv__(self, other: Operand) -> Term:
        return self._with(BinaryOperator.DIVIDE, other)

    def __rfloordiv__(self, other: Operand) -> Term:
        return self._after(BinaryOperator.DIVIDE, other)

    def __mod__(self, other: Operand) -> Term:
        return self._with(BinaryOperator.MODULO, other)

    def __rmod__(self, other: Operand) -> Term:
        return self._after(BinaryOperator.MODULO, other)

    def __and__(self, other: Operand) -> Term:
        return self._with(BinaryOperator.AND, other)

    def __or__(self, other: Operand) -> Term:
        return self._with(BinaryOperator.OR, other)

    def __invert__(self) -> Term:
        return Term(Unary(UnaryOperator.NOT, self.expression, BOOL))

    def __eq__(self, other: Operand) -> Term:  # type: ignore[override]
        return self._with(BinaryOperator.EQUAL, other)

    def __ne__(self, other: Operand) -> Term:  # type: ignore[override]
        return self._with(BinaryOperator.NOT_EQUAL, other)

    def __lt__(self, other: Operand) -> Term:
        return self._with(BinaryOperator.LESS, other)

    def __le__(self, other: Operand) -> Term:
        return self._with(BinaryOperator.LESS_EQUAL, other)

    def __gt__(self, other: Operand) -> Term:
        return self._with(BinaryOperator.GREATER, other)

    def __ge__(self, other: Operand) -> Term:
        return self._with(BinaryOperator.GREATER_EQUAL, other)

    def __getitem__(self, index: Operand) -> Term:
        """The element of an array. Raises TypeError for anything else."""
        type_ = self.expression.type
        if not isinstance(type_, ArrayType):
            raise TypeError(f"a value of type {type_} cannot be indexed")
        return Term(Index(self.expression, expression_of(index), type_.element))

    def field(self, name: str) -> Term:
        """A field of a record. Raises TypeError for anything else, KeyError for an unknown field."""
        type_ = self.expression.type
        if not isinstance(type_, RecordType):
            raise TypeError(f"a value of type {type_} has no fields")
        return Term(Field(self.expression, name, dict(type_.fields)[name]))

    def implies(self, other: Operand) -> Term:
        """The condition that the other one holds where this one does."""
        return self._with(BinaryOperator.IMPLY, other)

    def assign(self, value: Operand) -> Term:
        """The update that gives this variable or clock a value."""
        return Term(Assign(self.expression, expression_of(value), self.expression.type))

    def __bool__(self) -> bool:
        raise TypeError("a term has no truth value; use & | ~ instead of and, or, not")


Operand = Term | int
"""The operands of an operator; ``True`` and ``False`` are the boolean constants."""


def expression_of(operand: Operand) -> Expression:
    """The expression of a term, or the constant of a Python number."""
    if isinstance(operand, Term):
        return operand.expression
    return Constant(int(operand), BOOL if isinstance(operand, bool) else INT)


def _binary(operator: BinaryOperator, left: Expression, right: Expression) -> Expression:
    if operator is BinaryOperator.SUBTRACT and isinstance(left.type, ClockType) and isinstance(right.type, ClockType):
        return Binary(operator, left, right, left.type)
    if operator is BinaryOperator.ADD and (isinstance(left.type, ClockType) or isinstance(right.type, ClockType)):
        return Binary(operator, left, right, ClockType())
    return Binary(operator, left, right, INT if operator.group is OperandGroup.ARITHMETIC else BOOL)


def conditional(condition: Operand, then: Operand, otherwise: Operand) -> Term:
    """``condition ? then : otherwise``"""
    left, right = expression_of(then), expression_of(otherwise)
    return Term(Conditional(expression_of(condition), left, right, left.type))


def quantifier(kind: QuantifierKind, bound: Term, body: Operand) -> Term:
    """``forall``, ``exists`` or ``sum``; ``bound`` comes from `bound_variable`."""
    return Term(Quantifier(kind, _variable_of(bound), expression_of(body), INT if kind is QuantifierKind.SUM else BOOL))


def bound_variable(name: str, type_: ScalarLike) -> Term:
    """A variable for a quantifier or for the ``selects`` of an edge."""
    return Term(Reference(Variable(name, type_, VariableKind.BOUND)))


def deadlock() -> Term:
    """The query atom: no action is possible now or later."""
    return Term(Deadlock())


def _variable_of(term: Term) -> Variable:
    if not isinstance(term.expression, Reference):
        raise TypeError("a variable is expected here")
    return term.expression.variable


@dataclass(frozen=True, slots=True)
class LocationHandle:
    """A location of a process under construction."""

    process: int
    number: int

    @property
    def reached(self) -> Term:
        """The query atom ``P.location``."""
        return Term(LocationTest(self.process, self.number))


@dataclass(slots=True)
class _Declarations:
    """The common part of global and local declarations."""

    prefix: str
    kind: VariableKind
    variables: list[Variable] = field(default_factory=list)

    def declare(self, name: str, type_: Type, initial: Sequence[int] | int | None = None, meta: bool = False) -> Term:
        """Declares a variable of any type; ``initial`` has one integer for each slot, or one for a scalar."""
        if initial is None:
            slots = default_values(type_)
        else:
            slots = (initial,) if isinstance(initial, int) else tuple(initial)
        return self._add(Variable(self.prefix + name, type_, self.kind, slots, declared_meta=meta))

    def clock(self, name: str, initial: int = 0) -> Term:
        """A clock."""
        return self.declare(name, ClockType(), initial)

    def integer(self, name: str, low: int, high: int, initial: int | None = None, meta: bool = False) -> Term:
        """An integer with the range ``[low, high]``. Raises ValueError if that does not fit into 32 bits."""
        return self.declare(name, integer_range(low, high, name), initial, meta)

    def boolean(self, name: str, initial: bool = False) -> Term:
        """A variable that is true or false."""
        return self.declare(name, BoolType(), int(initial))

    def channel(
        self, name: str, broadcast: bool = False, urgent: bool = False, priority: int | None = None, size: int = 0
    ) -> Term:
        """A channel, or an array of ``size`` channels."""
        single = ChannelType(broadcast, urgent)
        type_ = ArrayType(single, IntType(0, size - 1)) if size else single
        slots = max(size, 1)
        priorities = () if priority is None else (priority,) * slots
        return self._add(Variable(self.prefix + name, type_, self.kind, (0,) * slots, priorities=priorities))

    def _add(self, variable: Variable) -> Term:
        self.variables.append(variable)
        return Term(Reference(variable))


@dataclass(slots=True)
class ProcessBuilder(_Declarations):
    """A process under construction; its first location is the initial one unless `starts_in` says otherwise."""

    number: int = 0
    name: str = ""
    priority: int = DEFAULT_PRIORITY
    initial: int = 0
    locations: list[Location] = field(default_factory=list)
    edges: list[Edge] = field(default_factory=list)

    def location(
        self,
        name: str,
        invariant: Operand | None = None,
        urgent: bool = False,
        committed: bool = False,
        rates: Sequence[tuple[Term, Operand]] = (),
    ) -> LocationHandle:
        """``rates`` are pairs (clock, 0 or 1 or an expression with such a value)."""
        self.locations.append(
            Location(
                name,
                None if invariant is None else expression_of(invariant),
                tuple((clock.expression, expression_of(rate)) for clock, rate in rates),
                urgent,
                committed,
            )
        )
        return LocationHandle(self.number, len(self.locations) - 1)

    def starts_in(self, location: LocationHandle) -> None:
        """Makes a location the initial one, in place of the first."""
        self.initial = location.number

    def edge(
        self,
        source: LocationHandle,
        target: LocationHandle,
        *,
        guard: Operand | None = None,
        send: Term | None = None,
        receive: Term | None = None,
        updates: Sequence[Term] = (),
        selects: Sequence[Term] = (),
    ) -> int:
        """Adds an edge and gives its number. Raises ValueError if it both sends and receives."""
        if send is not None and receive is not None:
            raise ValueError("an edge sends or receives, not both")
        synchronisation = None
        if send is not None:
            synchronisation = Synchronisation(send.expression, Direction.SEND)
        elif receive is not None:
            synchronisation = Synchronisation(receive.expression, Direction.RECEIVE)
        self.edges.append(
            Edge(
                source.number,
                target.number,
                tuple(_variable_of(s) for s in selects),
                None if guard is None else expression_of(guard),
                synchronisation,
                tuple(u.expression for u in updates),
            )
        )
        return len(self.edges) - 1

    def build(self) -> Process:
        """The process as it is so far."""
        return Process(
            self.name,
            self.name,
            tuple(self.locations),
            tuple(self.edges),
            self.initial,
            tuple(self.variables),
            self.priority,
        )


@dataclass(slots=True)
class NetworkBuilder(_Declarations):
    """A network under construction; declarations made here are global."""

    prefix: str = ""
    kind: VariableKind = VariableKind.GLOBAL
    default_priority: int = DEFAULT_PRIORITY
    processes: list[ProcessBuilder] = field(default_factory=list)

    def process(self, name: str, priority: int = DEFAULT_PRIORITY) -> ProcessBuilder:
        """Adds a process; the order of the calls is the order of the processes."""
        process = ProcessBuilder(
            f"{name}.", VariableKind.LOCAL, number=len(self.processes), name=name, priority=priority
        )
        self.processes.append(process)
        return process

    def build(self) -> Network:
        """The network as it is so far: `tachk.Model` takes it."""
        return Network(tuple(p.build() for p in self.processes), tuple(self.variables), self.default_priority)
