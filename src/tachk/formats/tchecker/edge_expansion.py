"""The edges of a network one by one: `select` expanded, one channel each, guards that TChecker can say.

Meta variables are ordinary ones in TChecker: edges restore them, so that every transition begins as in the network.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product

from tachk.analysis.conditions import split_conjunction
from tachk.analysis.fold import Known, fold, fold_place, known_slot, negate
from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.base.words import Direction
from tachk.formats.tchecker.expression_writer import TermPrinter, initial_slots, slots, unsupported, written_out
from tachk.formats.tchecker.leaves import leaf_types
from tachk.frontend.declarations.channels import channel_variable
from tachk.model.expressions import BOOL, Binary, Constant, Expression, Index, Reference, Variable
from tachk.model.network import Edge, Network
from tachk.model.traversal import walk
from tachk.model.types import ArrayType, ChannelType
from tachk.model.variable_layout import slot_range

MAXIMUM_EDGES = 2**17
"""Edges of one file after the expansion of ``select``."""


@dataclass(frozen=True, slots=True)
class FlatEdge:
    """An edge after expansion.

    Attributes:
        guard: parts of a conjunction, as text.
        channel: the variable and slot of its channel, and the direction; None for an internal edge.
    """

    source: int
    target: int
    guard: tuple[str, ...]
    updates: tuple[str, ...]
    channel: tuple[Variable, int] | None
    direction: Direction | None
    span: Span


def choices(edge: Edge, known: Known) -> Iterator[Known]:
    """The constants with each value of `select`. Raises UnsupportedError if there are too many."""
    ranges = [range(low, high + 1) for low, high in (slot_range(v.type) for v in edge.selects)]
    total = 1
    for values in ranges:
        total *= len(values)
    if total > MAXIMUM_EDGES:
        raise unsupported(f"select, and this one stands for {total} edges", edge.spans[0])
    for chosen in product(*ranges):
        yield Known(known.values, {**known.bound, **dict(zip(edge.selects, chosen, strict=True))})


@dataclass(frozen=True, slots=True)
class EdgeExpansion:
    """Makes edges of the network into edges of TChecker."""

    network: Network
    known: Known
    printer: TermPrinter

    def expanded(self, edge: Edge) -> Iterator[FlatEdge]:
        """The edges that an edge stands for. Raises UnsupportedError."""
        for known in choices(edge, self.known):
            yield from self._instances(edge, known)

    def _instances(self, edge: Edge, known: Known) -> Iterator[FlatEdge]:
        statements = tuple(
            text for update in edge.updates for text in self.printer.statements(written_out(update, known))
        )
        for channel, tests in self._channels(edge, known):
            before, after = self._resets(edge, channel)
            updates = (*before, *statements, *after)
            for guard in self._guards(edge, known, tests):
                if "0 == 1" in guard:
                    continue
                conditions = tuple(part for part in guard if part != "1 == 1")
                direction = None if edge.synchronisation is None else edge.synchronisation.direction
                yield FlatEdge(edge.source, edge.target, conditions, updates, channel, direction, edge.spans[0])

    def _channels(
        self, edge: Edge, known: Known
    ) -> Iterator[tuple[tuple[Variable, int] | None, tuple[Expression, ...]]]:
        """The channels an edge may synchronise over, each with the conditions under which it is that one."""
        if edge.synchronisation is None:
            yield None, ()
            return
        pending: list[tuple[Expression, tuple[Expression, ...]]] = [
            (fold_place(edge.synchronisation.channel, known), ())
        ]
        while pending:
            place, tests = pending.pop()
            slot = known_slot(place)
            if slot is not None:
                yield slot, tests
                continue
            computed = next(
                (n for n in walk(place) if isinstance(n, Index) and not isinstance(n.index, Constant)), None
            )
            if computed is None or not isinstance(computed.base.type, ArrayType):
                raise unsupported("such choice of a channel", edge.synchronisation.span)
            low, size = computed.base.type.low, computed.base.type.size
            for value in reversed(range(low, low + size)):
                test = Binary(BinaryOperator.EQUAL, computed.index, Constant(value), BOOL, computed.span)
                pending.append((_with_index(place, computed, value), (*tests, test)))

    def _guards(self, edge: Edge, known: Known, tests: tuple[Expression, ...]) -> Iterator[tuple[str, ...]]:
        """The guard as conjunctions: a clock condition behind a disjunction gives two edges."""
        parts = [self.printer.condition(fold(test, known)) for test in tests]
        if edge.guard is None:
            yield tuple(parts)
            return
        at_rest = Known({**known.values, **self._metas()}, known.bound)
        split = split_conjunction(written_out(edge.guard, at_rest), at_rest)
        parts += [self.printer.condition(written_out(condition, known)) for condition in split.integers]
        parts += [self.printer.atom(atom) for condition, atom in split.clocks if condition is None]
        conditional = [(condition, atom) for condition, atom in split.clocks if condition is not None]
        for chosen in product((True, False), repeat=len(conditional)):
            more = []
            for wanted, (condition, atom) in zip(chosen, conditional, strict=True):
                more.append(self.printer.condition(condition if wanted else negate(condition)))
                if wanted:
                    more.append(self.printer.atom(atom))
            yield (*parts, *more)

    # ---- meta variables ---------------------------------------------------------------------------------------------

    def _metas(self) -> dict[Variable, tuple[int, ...]]:
        """The meta variables with the values they have whenever a transition begins."""
        return {v: initial_slots(v) for v in self.network.all_variables() if self.network.resets(v)}

    def _resets(self, edge: Edge, channel: tuple[Variable, int] | None) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """The updates before and after those of an edge that reset meta variables for every transition.

        The last edge of a transition restores them. Of a broadcast no edge is the last for certain, so what a broadcast
        uses is restored by the first edge of every transition as well.
        """
        touched = self._touched(edge if channel is None else channel[0])
        if not touched:
            return (), ()
        direction = None if edge.synchronisation is None else edge.synchronisation.direction
        broadcast = {m for c in self._broadcasts() for m in self._touched(c)}
        before = [m for m in touched if m in broadcast and direction is not Direction.RECEIVE]
        ends = channel is None or (direction is Direction.RECEIVE and channel[0] not in self._broadcasts())
        after = touched if ends else []
        return tuple(self._restored(before)), tuple(self._restored(after))

    def _restored(self, metas: Iterable[Variable]) -> Iterator[str]:
        for variable in metas:
            for slot, value in zip(slots(Reference(variable)), initial_slots(variable), strict=True):
                yield f"{self.printer.place(slot)} = {value}"

    def _broadcasts(self) -> set[Variable]:
        return {
            v
            for v in self.network.all_variables()
            if any(isinstance(t, ChannelType) and t.broadcast for t in leaf_types(v.type))
        }

    def _touched(self, by: Edge | Variable) -> list[Variable]:
        """The meta variables in the updates of an edge, or of all edges that synchronise over a channel."""
        if isinstance(by, Edge):
            updates = [*by.updates]
        else:
            updates = [
                update
                for process in self.network.processes
                for edge in process.edges
                if edge.synchronisation is not None and channel_variable(edge.synchronisation.channel) is by
                for update in edge.updates
            ]
        found = dict.fromkeys(n.variable for u in updates for n in walk(u) if isinstance(n, Reference))
        return [v for v in found if self.network.resets(v) and v not in self.known.values]


def _with_index(place: Expression, computed: Index, value: int) -> Expression:
    if place is computed:
        return Index(computed.base, Constant(value), computed.type, computed.span)
    if isinstance(place, Index):
        return Index(_with_index(place.base, computed, value), place.index, place.type, place.span)
    return place
