"""Sums that are assigned to clocks: an integer, a clock, or a clock and an offset."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass
from tachk.model.expressions import Assign, Binary, Conditional, Expression, Field, Index, Reference
from tachk.model.network import Network
from tachk.model.traversal import walk, with_bodies
from tachk.model.types import ClockType


@dataclass(frozen=True, slots=True)
class ClockSum:
    """Attributes:
    clock: the place of a clock; None stands for 0.
    offset: an integer expression; None stands for 0. A negative one is a run-time error.
    """

    clock: Expression | None
    offset: Expression | None = None


def clock_sum(value: Expression) -> ClockSum | None:
    """The value of an assignment to a clock as such a sum; None if it is none."""
    match value:
        case Reference() | Index() | Field() if isinstance(value.type, ClockType):
            return ClockSum(value)
        case Conditional(_, then, otherwise) if isinstance(value.type, ClockType):
            sides = clock_sum(then), clock_sum(otherwise)
            whole = all(side is not None and side.offset is None for side in sides)
            return ClockSum(value) if whole else None
        case Binary(BinaryOperator.ADD, left, right) if isinstance(value.type, ClockType):
            sums = clock_sum(left), clock_sum(right)
            clocks = [side.clock for side in sums if side is not None and side.clock is not None]
            if None in sums or len(clocks) != 1:
                return None
            offsets = [side.offset for side in sums if side is not None and side.offset is not None]
            offset = offsets[0]
            for more in offsets[1:]:
                offset = Binary(BinaryOperator.ADD, offset, more, more.type, value.span)
            return ClockSum(clocks[0], offset)
        case _ if isinstance(value.type, ClockType):
            return None
        case _:
            return ClockSum(None, value)


def clock_assignments(expressions: Iterable[Expression]) -> Iterator[Assign]:
    """The assignments to clocks in the expressions and the functions that they call."""
    for expression in with_bodies(expressions):
        for node in walk(expression):
            if isinstance(node, Assign) and isinstance(node.target.type, ClockType):
                yield node


def clock_copies(network: Network) -> Iterator[Assign]:
    """The assignments that set a clock to the value of a clock."""
    updates = [update for process in network.processes for edge in process.edges for update in edge.updates]
    for assignment in clock_assignments(updates):
        whole = clock_sum(assignment.value)
        if whole is None or whole.clock is not None:
            yield assignment


def advances_clocks(network: Network) -> bool:
    """True if some assignment sets a clock to more than the value of a clock."""
    sums = (clock_sum(assignment.value) for assignment in clock_copies(network))
    return any(whole is None or whole.offset is not None for whole in sums)
