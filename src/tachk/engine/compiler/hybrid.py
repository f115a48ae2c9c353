"""Hybrid clocks of a network, as a simulation needs them: conditions on them, and their rates."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from tachk.analysis.fold import Known, fold, fold_place
from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.operators import UnaryOperator
from tachk.base.span import Span
from tachk.engine.compiler.codegen import CodeGenerator
from tachk.engine.compiler.program import Computed, FlowRate, FlowTest, FlowTestKind, HybridClocks
from tachk.engine.compiler.slot_layout import SlotLayout
from tachk.model.expressions import Call, Expression, Field, Index, Reference, Unary
from tachk.model.floating import DOUBLE, FloatingOperation
from tachk.model.network import Location, Network
from tachk.model.traversal import reads_hybrid, walk, with_bodies
from tachk.model.types import slot_count

_KINDS = {
    FloatingOperation.LESS: FlowTestKind.LESS,
    FloatingOperation.LESS_EQUAL: FlowTestKind.LESS_EQUAL,
    FloatingOperation.GREATER: FlowTestKind.GREATER,
    FloatingOperation.GREATER_EQUAL: FlowTestKind.GREATER_EQUAL,
    FloatingOperation.EQUAL: FlowTestKind.EQUAL,
    FloatingOperation.NOT_EQUAL: FlowTestKind.NOT_EQUAL,
}
_OPPOSITES = {
    FlowTestKind.LESS: FlowTestKind.GREATER_EQUAL,
    FlowTestKind.LESS_EQUAL: FlowTestKind.GREATER,
    FlowTestKind.GREATER: FlowTestKind.LESS_EQUAL,
    FlowTestKind.GREATER_EQUAL: FlowTestKind.LESS,
    FlowTestKind.EQUAL: FlowTestKind.NOT_EQUAL,
    FlowTestKind.NOT_EQUAL: FlowTestKind.EQUAL,
}


def flow_test(part: Expression, known: Known, generator: CodeGenerator) -> FlowTest:
    """A condition that depends on hybrid clocks."""
    positive, inner = True, part
    while isinstance(inner, Unary) and inner.operator is UnaryOperator.NOT:
        positive, inner = not positive, inner.operand
    if isinstance(inner, Call) and inner.function.operation in _KINDS:
        kind = _KINDS[inner.function.operation]
        left, right = inner.arguments
        return FlowTest(
            kind if positive else _OPPOSITES[kind],
            is_affine(left) and is_affine(right),
            generator.slots_code(left, known),
            generator.slots_code(right, known),
        )
    return FlowTest(FlowTestKind.TRUTH, False, generator.value_code(part, known))


def is_affine(value: Expression) -> bool:
    """True if a number is a sum of multiples of hybrid clocks, with factors that do not change while time passes."""
    if not reads_hybrid(value):
        return True
    match value:
        case Reference():
            return value.type == DOUBLE
        case Index(base, index):
            return is_affine_place(base) and not reads_hybrid(index)
        case Field(base):
            return is_affine_place(base)
        case Call(function, (only,)) if function.operation is FloatingOperation.NEGATE:
            return is_affine(only)
        case Call(function, (left, right)):
            match function.operation:
                case FloatingOperation.ADD | FloatingOperation.SUBTRACT:
                    return is_affine(left) and is_affine(right)
                case FloatingOperation.MULTIPLY:
                    first, second = reads_hybrid(left), reads_hybrid(right)
                    return not (first and second) and is_affine(left) and is_affine(right)
                case FloatingOperation.DIVIDE:
                    return is_affine(left) and not reads_hybrid(right)
                case _:
                    return False
        case _:
            return False


def is_affine_place(place: Expression) -> bool:
    match place:
        case Reference():
            return True
        case Index(base, index):
            return is_affine_place(base) and not reads_hybrid(index)
        case Field(base):
            return is_affine_place(base)
        case _:
            return False


def hybrid_clocks(
    network: Network, known: Known, layout: SlotLayout, computed: Callable[[Expression, Known], Computed]
) -> HybridClocks:
    """The hybrid clocks of a network, none if it has none. Raises UnsupportedError for a rate of one that depends on
    the state.

    Args:
        computed: compiles a number.
    """
    slots: list[int] = []
    for variable in network.all_variables():
        slots += (layout.first_slot(variable) + offset for offset in variable.hybrid_clocks())
    if not slots:
        return HybridClocks()
    numbers = {slot: number for number, slot in enumerate(slots)}

    def rates(location: Location) -> Iterator[FlowRate]:
        for place, rate in location.hybrid_rates:
            yield FlowRate(numbers[_clock(place, known, layout)], reads_hybrid(rate), computed(rate, known))

    return HybridClocks(
        tuple(slots),
        tuple(tuple(tuple(rates(location)) for location in process.locations) for process in network.processes),
        tuple(sorted(_slots_read(network, known, layout) | {slot + half for slot in slots for half in (0, 1)})),
    )


def _clock(place: Expression, known: Known, layout: SlotLayout) -> int:
    """The first slot of the hybrid clock that a rate is for."""
    slot = layout.known_slot(fold_place(place, known))
    if slot is None:
        raise rate_of_computed_clock(place.span)
    return slot


def _slots_read(network: Network, known: Known, layout: SlotLayout) -> set[int]:
    """The slots of the variables that rates name, in functions too."""
    written = [rate for p in network.processes for location in p.locations for _, rate in location.hybrid_rates]
    folded = [fold(rate, known) for rate in written]
    named = {node.variable for outer in with_bodies(folded) for node in walk(outer) if isinstance(node, Reference)}
    spans = ((layout.first_slot(variable), slot_count(variable.type)) for variable in named)
    return {slot for first, count in spans for slot in range(first, first + count) if layout.is_state(slot)}


def rate_of_computed_clock(span: Span) -> UnsupportedError:
    message = "the clock of a rate must not depend on variables"
    return UnsupportedError(Diagnostic("E0710", message, span, "write one rate for each clock"))


def refuse_hybrid(network: Network, what: str) -> None:
    """Raises UnsupportedError if the network has hybrid clocks or random initial values; ``what`` reads like "a unit of
    co-simulation"."""
    for variable in network.all_variables():
        if variable.drawn is not None:
            raise UnsupportedError(_unsupported(variable.span, what, "random initial values", "write a number"))
        if variable.has_hybrid_clocks:
            mend = "give the clock the rates 0 and 1 only, or leave it out"
            raise UnsupportedError(_unsupported(variable.span, what, "hybrid clocks", mend))


def _unsupported(span: Span, what: str, unknown: str, mend: str) -> Diagnostic:
    return Diagnostic(
        "E0729",
        f"{what} knows no {unknown}",
        span,
        f"`tachk simulate` and `tachk estimate` do; {mend}",
    )
