"""Effects of updates on clocks: for bounds, units of time and the size of zones, before a search."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import gcd

from tachk.analysis.conditions import clock_form_unsupported
from tachk.analysis.divisors import divisor
from tachk.analysis.fold import Known, fold, fold_place, network_expressions
from tachk.analysis.intervals import interval
from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.span import Span
from tachk.engine.compiler.bounds import ClockCopy, copied_diagonals
from tachk.engine.compiler.condition_code import ConditionCompiler, check_bound
from tachk.engine.compiler.slot_layout import SlotLayout
from tachk.model.clock_sums import clock_assignments, clock_sum
from tachk.model.expressions import Assign, Constant, Expression
from tachk.model.network import Network
from tachk.model.types import ClockType


class ClockUpdates:
    """Attributes:
    values: the largest constant that each clock may be set to, or begin with.
    unit: divides all that clocks may be set to or advanced by; 0 if that is always 0.
    copies: what may set a clock to the value of a clock, each with a place where it is written.
    largest: the largest value a clock may begin with, be set to or be advanced by.
    """

    def __init__(self, layout: SlotLayout, compiler: ConditionCompiler) -> None:
        self.layout = layout
        self.compiler = compiler
        self.values: dict[int, int] = {}
        self.unit = 0
        self.copies: dict[ClockCopy, Span] = {}
        self.largest = 0

    def find(self, network: Network, known: Known) -> None:
        """Notes what clocks may be set to: the largest value of each, what divides all of them, and copies. Raises
        UnsupportedError for a value that is too large."""
        self.values = {clock: value for clock, value in enumerate(self.layout.starts, start=1) if value > 0}
        self.largest = max(self.layout.starts, default=0)
        for node in clock_assignments(network_expressions(network)):
            whole = clock_sum(node.value)
            if whole is None:
                raise clock_form_unsupported(node.value.span)
            low = high = 0
            if whole.offset is not None:
                offset = fold(whole.offset, known)
                low, high = interval(offset, known)
                check_bound(max(low, 0), max(high, 0), node.span)
                self.unit = gcd(self.unit, divisor(offset, known))
                self.largest = max(self.largest, high)
            if whole.clock is not None:
                for copy in self.copies_of([node], known):
                    self.copies.setdefault(copy, node.span)
                continue
            for clock in self.compiler.possible_clocks(fold_place(node.target, known), known):
                self.values[clock] = max(self.values.get(clock, 0), high)

    def copies_of(self, updates: Sequence[Expression], known: Known) -> Iterator[ClockCopy]:
        """The clocks that the updates and the functions that they call may set to the values of clocks."""
        for node in clock_assignments(updates):
            whole = clock_sum(node.value)
            if whole is None or whole.clock is None:
                continue
            low, high = (0, 0) if whole.offset is None else interval(fold(whole.offset, known), known)
            for clock in self.compiler.possible_clocks(fold_place(node.target, known), known):
                for source in self.compiler.possible_clocks(fold_place(whole.clock, known), known):
                    yield ClockCopy(clock, source, low, high)

    def reset(self, update: Assign) -> tuple[int, int, int] | None:
        """The clock that is set, by how much it is more than the clock that it is set to, and that clock (0 for none);
        None where any of it has to be computed."""
        whole = clock_sum(update.value)
        target = self.layout.known_slot(update.target)
        if whole is None or target is None or not isinstance(whole.offset, Constant | None):
            return None
        value = 0 if whole.offset is None else whole.offset.value
        source = None if whole.clock is None else self.layout.known_slot(whole.clock)
        if value < 0 or (whole.clock is not None and source is None):
            return None
        slots = self.layout.slots
        return slots[target].initial, value, 0 if source is None else slots[source].initial

    def always_set(self, updates: tuple[Expression, ...]) -> Iterator[int]:
        """The clocks that the updates set in every case."""
        for update in updates:
            if isinstance(update, Assign) and isinstance(update.target.type, ClockType):
                slot = self.layout.known_slot(update.target)
                if slot is not None:
                    yield self.layout.slots[slot].initial

    def copied(self, diagonals: Sequence[tuple[int, int, int]], most: int) -> tuple[tuple[int, int, int], ...]:
        """The difference constraints between clocks, and what copies make of them. Raises UnsupportedError where these
        are more than so many, perhaps without end."""
        found = copied_diagonals(diagonals, self.copies, most)
        if found is None:
            raise _too_many_differences(most, next(span for copy, span in self.copies.items() if copy.largest > 0))
        return found


def _too_many_differences(most: int, span: Span) -> UnsupportedError:
    return UnsupportedError(
        Diagnostic(
            "E0712",
            f"this assignment makes more than {most} differences of clocks count, perhaps without end",
            span,
            "copy clocks without adding to them, or compare them with numbers only",
        )
    )
