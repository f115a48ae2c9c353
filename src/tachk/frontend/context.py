"""The state of an elaboration: findings, constants, effects of functions."""

from __future__ import annotations

from collections.abc import Iterable

from tachk.base.records import dataclass, field
from tachk.base.span import Span
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.open_constants import OpenConstants
from tachk.model.evaluate import Environment, Place, StoredSlots, evaluate_slots
from tachk.model.expressions import (
    Assign,
    Call,
    Deadlock,
    Expression,
    Function,
    Increment,
    LocationTest,
    Quantifier,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.fault import EvaluationFault, RuntimeErrorKind
from tachk.model.traversal import called_functions, roots, statement_expressions, walk
from tachk.model.types import Type, clock_count, leaves, slot_count
from tachk.model.variable_layout import VariableLayout, slot_bounds

_NO_SLOTS = VariableLayout({}, (), (), (), (), (), (), (), ())
_INSIDE = (VariableKind.FRAME, VariableKind.BOUND)


@dataclass(frozen=True, slots=True)
class Effects:
    """The effects of a function or an expression outside its own frame.

    Attributes:
        reads: global and local variables whose value, or whose place, it uses.
        writes: global and local variables, and of a function's parameters those passed by reference, that it changes.
    """

    reads: frozenset[Variable]
    writes: frozenset[Variable]


@dataclass(slots=True)
class Budget:
    """The resources that one model may use before it is taken for a mistake or an attack.

    Attributes:
        instances: of quantifiers that are written out.
        slots: of variables.
        clocks: the engine has numbers for 60,000, of which observers use some.
    """

    instances: int = 2**16
    slots: int = 2**22
    clocks: int = 50_000


@dataclass(slots=True)
class Context:
    """Attributes:
    constants: the array and record constants; scalar constants are `Constant` expressions wherever they are used.
    effects: of every function elaborated so far.
    in_query: elaborating a query, signal or property.
    in_function: elaborating the body of a function.
    scalar_sets: how many anonymous scalar types there are.
    time_unit: as `Network.time_unit`.
    open_constants: scalar constants that are not `Constant` expressions but keep their names; usually none.
    keeps_doubles: floating point variables are part of the state, as simulations want it; else they are left out.
    lasting_structs: the struct types, by the identity of their nodes, whose floating point fields are left out.
    hybrid_clocks: the names of plain clocks that are taken for hybrid ones, where `keeps_doubles`.
    """

    findings: DiagnosticCollector
    constants: set[Variable] = field(default_factory=set)
    effects: dict[Function, Effects] = field(default_factory=dict)
    in_query: bool = False
    in_function: bool = False
    scalar_sets: int = 0
    budget: Budget = field(default_factory=Budget)
    time_unit: str = ""
    open_constants: OpenConstants = field(default_factory=OpenConstants)
    keeps_doubles: bool = False
    hybrid_clocks: frozenset[str] = frozenset()
    lasting_structs: frozenset[int] = frozenset()

    def error(self, code: str, span: Span, message: str, help: str | None = None) -> None:
        self.findings.add(code, span, message, help)

    def allow_instances(self, count: int, span: Span) -> bool:
        """True if a quantifier may be written out that many times; reports if it may not."""
        self.budget.instances -= count
        if self.budget.instances >= 0:
            return True
        self.error("E0609", span, "this quantifier has too many instances", "quantify over a smaller type")
        return False

    def allow_variable(self, type_: Type, span: Span) -> bool:
        """True if a variable of that type may be declared; reports if it may not."""
        self.budget.slots -= slot_count(type_)
        self.budget.clocks -= clock_count(type_)
        if self.budget.slots < 0:
            self.error("E0606", span, "the variables of this model are too large", "use smaller arrays")
        elif self.budget.clocks < 0:
            self.error("E0606", span, "this model has more than 50000 clocks", "declare fewer, or run fewer processes")
        return self.budget.slots >= 0 and self.budget.clocks >= 0

    # ---- effects ----------------------------------------------------------------------------------------------------

    def effects_of(self, expressions: Iterable[Expression]) -> Effects:
        """The effects of evaluating the expressions."""
        reads: set[Variable] = set()
        writes: set[Variable] = set()
        for expression in expressions:
            for node in walk(expression):
                match node:
                    case Reference(variable):
                        reads.add(variable)
                    case Assign(target) | Increment(target):
                        writes.update(roots(target))
                    case Call(function, arguments) if function.operation is None:
                        called = self.effects[function]
                        reads |= called.reads
                        writes |= called.writes - set(function.parameters)
                        for parameter, argument in zip(function.parameters, arguments, strict=True):
                            if parameter in called.writes:
                                writes.update(roots(argument))
                    case _:
                        pass
        return Effects(frozenset(reads), frozenset(writes))

    def record_function(self, function: Function) -> None:
        """Notes the variables that a function reads or writes."""
        inner = self.effects_of(statement_expressions(function.body))
        self.effects[function] = Effects(
            frozenset(v for v in inner.reads if v.kind not in _INSIDE),
            frozenset(v for v in inner.writes if v.kind not in _INSIDE or v.reference),
        )

    def require_pure(self, expression: Expression, where: str) -> bool:
        """Reports an expression that changes something; ``where`` reads like "a guard"."""
        for node in walk(expression):
            if isinstance(node, Assign | Increment):
                mend = _assignment_help(node, self.in_query)
                self.error("E0313", node.span, f"{where} must not change anything", mend)
                return False
            if isinstance(node, Call) and any(f.operation and f.operation.draws for f in called_functions([node])):
                mend = "draw it in an update, into a variable"
                self.error("E0313", node.span, f"{where} must not draw random numbers", mend)
                return False
            if isinstance(node, Call) and self.effects_of([node]).writes:
                changed = ", ".join(sorted(f"`{v.name}`" for v in self.effects_of([node]).writes))
                self.error(
                    "E0313",
                    node.span,
                    f"{where} must not change anything, but `{node.function.name}` changes {changed}",
                    "call the function in an update, or write one without side effects",
                )
                return False
        return True

    # ---- constant evaluation ----------------------------------------------------------------------------------------

    def constant_slots(self, expression: Expression, what: str) -> tuple[int, ...] | None:
        """The value of an expression that must be known before the model runs; reports why it is not.

        Args:
            what: the beginning of the message: "the size of an array".
        """
        for node in walk(expression):
            if isinstance(node, LocationTest | Deadlock):
                self.error("E0601", node.span, f"{what} must be a constant")
                return None
        if any(function.operation and function.operation.draws for function in called_functions([expression])):
            help_ = "declare a variable: its initial value may be random in simulations"
            self.error("E0601", expression.span, f"{what} must be a constant, but this is random", help_)
            return None
        touched = self.effects_of([expression])
        if touched.writes:
            self.error("E0601", expression.span, f"{what} must be a constant, but this changes a variable")
            return None
        unknown = touched.reads - self.constants - _bound_inside(expression)
        if unknown:
            self._not_constant(expression, unknown, what)
            return None
        environment = Environment(_NO_SLOTS, [])
        self.open_constants.note(touched.reads, expression.span)
        for variable in touched.reads & self.constants:
            ranges = [slot_bounds(leaf) for _, leaf in leaves(variable.type)]
            environment.frame[variable] = Place(StoredSlots(list(variable.initial), ranges), 0)
        try:
            return evaluate_slots(expression, environment)
        except EvaluationFault as fault:
            code = "E0750" if fault.kind is RuntimeErrorKind.NOT_FINITE else "E0602"
            self.error(code, fault.span, f"{what} cannot be computed: {FAULT_TEXTS[fault.kind]}")
            return None

    def _not_constant(self, expression: Expression, unknown: frozenset[Variable], what: str) -> None:
        for node in walk(expression):
            if isinstance(node, Reference) and node.variable in unknown:
                self.error(
                    "E0601",
                    node.span,
                    f"{what} must be a constant, but `{node.span.text or node.variable.name}` can change",
                    "declare it `const`, or use a constant instead",
                )
                return
        names = ", ".join(sorted(f"`{v.name}`" for v in unknown))
        self.error("E0601", expression.span, f"{what} must be a constant, but a called function reads {names}")


def _assignment_help(node: Assign | Increment, in_query: bool) -> str | None:
    compares = isinstance(node, Assign) and node.operator is None
    if in_query:
        return "write `==` to compare" if compares else None
    if compares:
        return "move the assignment to an update, or write `==` to compare"
    return "move the assignment to an update"


def _bound_inside(expression: Expression) -> frozenset[Variable]:
    return frozenset(node.variable for node in walk(expression) if isinstance(node, Quantifier))


FAULT_TEXTS = {
    RuntimeErrorKind.RANGE: "a value is outside its range",
    RuntimeErrorKind.INDEX: "an index is outside its array",
    RuntimeErrorKind.DIVISION: "division by zero",
    RuntimeErrorKind.NEGATIVE_CLOCK: "a clock gets a negative value",
    RuntimeErrorKind.SHIFT: "the shift distance is negative or above 31",
    RuntimeErrorKind.NEGATIVE_EXPONENT: "the exponent is negative",
    RuntimeErrorKind.ASSERT: "an assertion fails",
    RuntimeErrorKind.LOOP: "it takes too many steps; perhaps a loop does not end",
    RuntimeErrorKind.NOT_FINITE: "a floating point operation has no finite result, or none that fits an integer",
    RuntimeErrorKind.BOUND: "a clock bound is too large",
}
