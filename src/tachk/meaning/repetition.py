"""The condition that a loop of transitions can be taken again with the same delays: clocks that must return to their
values."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

from tachk.base.records import dataclass
from tachk.meaning.clock_constants import clock_copies
from tachk.meaning.dbm import INFINITY, bound_value
from tachk.meaning.discrete import PreparedNetwork, stopped_clocks
from tachk.meaning.step import observable_constraints
from tachk.model.expressions import Expression
from tachk.model.run import DiscreteState


@dataclass(frozen=True, slots=True)
class ObservableClocks:
    """The observations of clocks in the discrete states of a loop.

    Attributes:
        largest: for each clock that is compared with constants the largest of these.
        related: the clocks that are compared with other clocks, or stop, or that others may be set to.
    """

    largest: dict[int, int]
    related: frozenset[int]

    def same(self, clock: int, before: Fraction, after: Fraction) -> bool:
        """True if nothing can tell one value of a clock from the other, now or after the same delay: they are equal,
        or the clock is compared with nothing, or both are larger than all it is compared with."""
        if before == after:
            return True
        if clock in self.related:
            return False
        return clock not in self.largest or min(before, after) > self.largest[clock]


def observable_clocks(
    model: PreparedNetwork, states: Iterable[DiscreteState], predicates: Sequence[Expression]
) -> ObservableClocks:
    """The constants that the guards and invariants of some discrete states, and the predicates, compare clocks with.

    A clock that is set in one of these states has from then on the same value in both rounds of a loop.
    """
    largest: dict[int, int] = {}
    related = {clock for copy in clock_copies(model.network) for clock in copy.sources}
    for state in set(states):
        related |= stopped_clocks(model, state)
        for i, j, raw in observable_constraints(model, state, tuple(predicates)):
            if raw >= INFINITY:
                continue
            if i and j:
                related |= {i, j}
            else:
                clock = i or j
                largest[clock] = max(largest.get(clock, 0), abs(bound_value(raw)))
    return ObservableClocks(largest, frozenset(related))
