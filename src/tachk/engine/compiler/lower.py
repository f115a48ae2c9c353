"""Compilation of a network to the integers the core runs."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from math import gcd

from tachk.analysis.conditions import Conjunction, split_conjunction
from tachk.analysis.fold import Known, drawn_values, fold, fold_place, is_integer, known_values
from tachk.analysis.never_taken import never_taken
from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.span import Span
from tachk.base.words import Direction
from tachk.engine.compiler.assembler import Assembler
from tachk.engine.compiler.bounds import (
    BoundEdge,
    ConstraintRange,
    LocationBounds,
    collect,
    diagonal_bounds,
    joined_copies,
    network_bounds,
)
from tachk.engine.compiler.clock_updates import ClockUpdates
from tachk.engine.compiler.codegen import CodeGenerator
from tachk.engine.compiler.condition_code import ConditionCompiler
from tachk.engine.compiler.edge_pattern import CompiledEdge, EdgePattern, pattern_of, uniform_ranges
from tachk.engine.compiler.features import rate_of
from tachk.engine.compiler.goal import ObservedByGoal, compile_goal
from tachk.engine.compiler.hybrid import hybrid_clocks, rate_of_computed_clock
from tachk.engine.compiler.program import (
    NO_CODE,
    Chances,
    Computed,
    Condition,
    Goal,
    Measure,
    Program,
    ProgramEdge,
    ProgramLocation,
    Update,
)
from tachk.engine.compiler.slot_layout import SlotLayout
from tachk.model.connectives import negation
from tachk.model.expressions import BOOL, Assign, Binary, Constant, Expression, Field, Index, Reference, Variable
from tachk.model.floating import DOUBLE
from tachk.model.floating_calls import constant_number
from tachk.model.network import Chance, Edge, Location, Network, Process
from tachk.model.remembered import by_network_where
from tachk.model.traversal import walk
from tachk.model.types import ChannelType, ClockType, leaves
from tachk.model.variable_layout import slot_range

MAXIMAL_EDGES = 1_000_000
MAXIMAL_DIAGONALS = 1024
WIDE_SELECT = 32
"""A select variable with more values is looked at for a pattern of its edges."""
_FEW_VALUES = 4
"""So many values of one form are compiled on their own."""


def lower(
    network: Network, predicates: Sequence[Expression] = (), tables: Collection[Variable] = ()
) -> tuple[Program, tuple[Goal, ...]]:
    """The program of a network, and for each predicate the goal of reaching a state where it is true.

    Large arrays of integers that are only read, and only by index, may be ``tables``: states do not hold them then.
    The clock bounds of the program cover all the predicates. Raises InputError for an initial value outside its range
    and UnsupportedError for what the engine cannot represent.
    """
    # Equal predicates of other places in the text have other programs, for these say where a run-time error is.
    places = tuple(node.span for predicate in predicates for node in walk(predicate))
    return _program_and_goals(network, tuple(predicates), tuple(tables), places)


_FEW_EDGES = 1_000
"""So many edges are compiled in a few milliseconds, as long as it takes to search what small models have."""


def _is_small(compiled: tuple[Program, tuple[Goal, ...]]) -> bool:
    return len(compiled[0].edges) <= _FEW_EDGES


@by_network_where(_is_small)
def _program_and_goals(
    network: Network, predicates: tuple[Expression, ...], tables: tuple[Variable, ...], places: tuple[Span, ...]
) -> tuple[Program, tuple[Goal, ...]]:
    known = known_values(network, predicates)
    lowering = _lowered(network, known, tables, never_taken(network))
    goals = []
    observed: list[ObservedByGoal] = []
    for goal, compared in (compile_goal(predicate, known, lowering.compiler) for predicate in predicates):
        goals.append(goal)
        observed.extend(compared)
    lowering.generator.finish()
    return lowering.program(observed), tuple(goals)


def lower_obligation(
    network: Network, avoided: Expression, begins: Expression | None
) -> tuple[Program, Goal, Goal | None]:
    """The program of a network, and the goals of what runs avoid and of where they may begin to (None: initially).

    The clock bounds count the constants of both as lower and as upper ones. Raises as `lower` does.
    """
    avoidance = [avoided] if begins is None else [avoided, begins]
    program, goals = lower(network, [*avoidance, *map(negation, avoidance)])
    return program, goals[0], None if begins is None else goals[1]


def lower_recurrence(
    network: Network, avoided: Expression, ends: Expression, begins: Expression | None, again: Sequence[Expression]
) -> tuple[Program, tuple[Goal, ...]]:
    """The program of a network, and the goals of what runs avoid, where they may end, where they may begin to avoid it
    (None: initially, and no goal) and what they meet again and again, in this order. As `lower_obligation`."""
    avoidance = [avoided, ends, *([] if begins is None else [begins]), *again]
    program, goals = lower(network, [*avoidance, *map(negation, avoidance)])
    return program, tuple(goals[: len(avoidance)])


def lower_measures(
    network: Network,
    measured: Sequence[MeasuredExpression],
    tables: Collection[Variable] = (),
    avoidance: Sequence[Expression] = (),
) -> tuple[Program, tuple[Goal, ...], tuple[Measure, ...]]:
    """The program of a network, the goals (predicates, and clocks whose largest value is searched), and the measures.

    The goal is that the clock is beyond its time bound. Up to there the clock bounds of the program distinguish its
    values. Raises as `lower` does, and ValueError for a clock that depends on the state.
    """
    known = known_values(network, [*avoidance, *(part for m in measured for part in (m.where, m.beyond))])
    lowering = _lowered(network, known, tables)
    measures = []
    compiled = [compile_goal(each, known, lowering.compiler) for each in avoidance]
    goals = [goal for goal, _ in compiled]
    observed = [each for _, compared in compiled for each in compared]
    for each in measured:
        where, compared = compile_goal(each.where, known, lowering.compiler)
        observed.extend(compared)
        if not isinstance(each.expression.type, ClockType):
            measures.append(Measure(where, each.largest, code=lowering.generator.value_code(each.expression, known)))
            continue
        slot = lowering.layout.known_slot(fold_place(each.expression, known))
        if slot is None:
            raise ValueError("the clock that is measured depends on the state")
        measures.append(Measure(where, each.largest, clock=lowering.layout.slots[slot].initial))
        beyond, compared = compile_goal(each.beyond, known, lowering.compiler)
        observed.extend(compared)
        if each.largest:
            goals.append(beyond)
    lowering.generator.finish()
    return lowering.program(observed), tuple(goals), tuple(measures)


def lower_simulation(
    network: Network, observed: Sequence[Expression | int], predicates: Sequence[Expression] = ()
) -> tuple[Program, Chances]:
    """The program of a network, and what a simulation needs beside it, with what it observes: expressions and slots.
    Raises as `lower` does, and UnsupportedError for a rate or weight that cannot be computed."""
    known = known_values(network, [*(each for each in observed if not isinstance(each, int)), *predicates])
    lowering = _lowered(network, known)
    rates = tuple(
        tuple(lowering.chance(location.exponential_rate, known) for location in process.locations)
        for process in network.processes
    )
    choices, weights = lowering.branches(known)
    values = tuple(
        Computed(slot=each) if isinstance(each, int) else lowering.computed(each, known) for each in observed
    )
    goals = tuple(compile_goal(predicate, known, lowering.compiler)[0] for predicate in predicates)
    hybrid = hybrid_clocks(network, known, lowering.layout, lowering.computed)
    starts = tuple(lowering.generator.update_code((drawn,)) for drawn in drawn_values(network))
    lowering.generator.finish()
    return lowering.program([]), Chances(rates, choices, weights, values, goals, hybrid, starts)


@dataclass(frozen=True, slots=True)
class MeasuredExpression:
    """The least or the largest value of an expression where a predicate holds.

    Attributes:
        where: without ``deadlock``.
        expression: an integer or a clock.
        time_bound: of a clock: the largest value is found if it is at most so large, the least one if it is smaller.
    """

    where: Expression
    expression: Expression
    largest: bool
    time_bound: int = 0

    @property
    def beyond(self) -> Expression:
        """The comparison that a search has to be exact about for what is measured, where the predicate holds."""
        operator = BinaryOperator.GREATER if self.largest else BinaryOperator.LESS
        return Binary(
            BinaryOperator.AND, self.where, Binary(operator, self.expression, Constant(self.time_bound), BOOL), BOOL
        )


def _lowered(
    network: Network,
    known: Known,
    tables: Collection[Variable] = (),
    never: Collection[tuple[int, int]] = frozenset(),
) -> _Lowering:
    """The processes of a network, as far as no predicate counts.

    Args:
        never: edges that are left out. Processes may be interchangeable but for edges that are never taken, and have to
            have the same clock bounds then. In a part of a network such an edge may be taken with another part.
    """
    layout = SlotLayout(network, known, tables)
    lowering = _Lowering(network, layout, CodeGenerator(layout, known, tables))
    lowering.clocks.find(network, known)
    for number, process in enumerate(network.processes):
        lowering.add_process(number, process, known, never)
    return lowering


class _Lowering:
    """The program under construction."""

    def __init__(self, network: Network, layout: SlotLayout, generator: CodeGenerator) -> None:
        self.network = network
        self.layout = layout
        self.generator = generator
        self.compiler = ConditionCompiler(layout, generator, network.has_hybrid_clocks)
        self.clocks = ClockUpdates(layout, self.compiler)
        self.locations: list[list[ProgramLocation]] = []
        self.invariants: list[list[tuple[ConstraintRange, ...]]] = []
        self.edges: list[ProgramEdge] = []
        self.bound_edges: list[list[BoundEdge]] = []

    # ---- processes --------------------------------------------------------------------------------------------------

    def add_process(self, number: int, process: Process, known: Known, never: Collection[tuple[int, int]]) -> None:
        compiled = [self._location(location, known) for location in process.locations]
        self.locations.append([location for location, _ in compiled])
        self.invariants.append([ranges for _, ranges in compiled])
        self.bound_edges.append([])
        for edge_number, edge in enumerate(process.edges):
            if (number, edge_number) in never:
                continue
            for selects, bound, pattern in self._instances(number, edge_number, edge, known):
                if pattern is not None:
                    self.edges.append(pattern.copy(selects, self.generator.assembler))
                elif (compiled_edge := self._edge(number, edge_number, edge, selects, bound)) is not None:
                    self.edges.append(compiled_edge[0])
                    self.bound_edges[number].append(compiled_edge[1])
                if len(self.edges) > MAXIMAL_EDGES:
                    raise _too_many_edges(edge.spans[0])

    def _location(self, location: Location, known: Known) -> tuple[ProgramLocation, tuple[ConstraintRange, ...]]:
        invariant, ranges = Condition(), tuple[ConstraintRange, ...]()
        if location.invariant is not None:
            compiled = self.compiler.compile(split_conjunction(location.invariant, known), known)
            invariant, ranges = compiled if compiled is not None else (self.compiler.never(), ())
        stopped = []
        for place, rate in location.rates:
            code = self._rate_code(rate, known)
            if code is not None:
                slot = self.layout.known_slot(fold_place(place, known))
                if slot is None:
                    raise rate_of_computed_clock(place.span)
                stopped.append((self.layout.slots[slot].initial, code))
        kinds = location.urgent, location.committed, location.observes
        return ProgramLocation(invariant, *kinds, tuple(stopped)), ranges

    def _rate_code(self, rate: Expression, known: Known) -> int | None:
        """Code for a rate that may be 0; None if it is always 1."""
        folded = rate_of(rate, known)
        if isinstance(folded, Constant):
            return NO_CODE if folded.value == 0 else None
        return self.generator.value_code(folded)

    # ---- edges ------------------------------------------------------------------------------------------------------

    def _instances(
        self, process: int, number: int, edge: Edge, known: Known
    ) -> Iterator[tuple[tuple[int, ...], Known, EdgePattern | None]]:
        """The values of the select variables for which the guard is not false at once, with what is known then, or with
        the pattern of the edge, whose clock bounds are noted already."""
        guard = None if edge.guard is None else fold(edge.guard, known)

        def expand(
            chosen: tuple[int, ...], guard: Expression | None, bound: Known
        ) -> Iterator[tuple[tuple[int, ...], Known, EdgePattern | None]]:
            if isinstance(guard, Constant) and guard.value == 0:
                return
            if len(chosen) == len(edge.selects):
                yield chosen, bound, None
                return
            variable = edge.selects[len(chosen)]
            low, high = slot_range(variable.type)
            if high - low >= MAXIMAL_EDGES:
                raise _too_many_edges(edge.spans[0])
            ranges = []
            if len(chosen) + 1 == len(edge.selects) and high - low >= WIDE_SELECT:
                ranges = uniform_ranges(edge, variable, bound, self.layout)
            for values in ranges or [range(low, high + 1)]:
                pattern = self._pattern(process, number, edge, chosen, bound, values) if ranges else None
                for value in values:
                    if pattern is not None:
                        yield (*chosen, value), bound, pattern
                        continue
                    inner = bound.with_bound(variable, value)
                    yield from expand((*chosen, value), None if guard is None else fold(guard, inner), inner)

        yield from expand((), guard, known)

    def _pattern(
        self, process: int, number: int, edge: Edge, chosen: tuple[int, ...], known: Known, values: range
    ) -> EdgePattern | None:
        """The pattern of the edges for these values of the last select variable, if they have one; notes the clock
        bounds of them all."""
        if len(values) <= _FEW_VALUES:
            return None
        samples = []
        bounds = []
        for value in (values[0], values[1], values[-1]):
            assembler, self.generator.assembler = self.generator.assembler, Assembler()
            try:
                inner = known.with_bound(edge.selects[-1], value)
                found = self._edge(process, number, edge, (*chosen, value), inner)
                piece = self.generator.assembler
            finally:
                self.generator.assembler = assembler
            if found is None:
                return None
            samples.append(CompiledEdge(found[0], piece))
            bounds.append(found[1])
        pattern = pattern_of(samples[0], samples[1], samples[2]) if bounds[0] == bounds[1] == bounds[2] else None
        if pattern is not None:
            self.bound_edges[process].append(bounds[0])
        return pattern

    def _edge(
        self, process: int, number: int, edge: Edge, selects: tuple[int, ...], known: Known
    ) -> tuple[ProgramEdge, BoundEdge] | None:
        """The edge for these values, and what clock bounds need of it; None if its guard is false in every state."""
        conjunction = Conjunction() if edge.guard is None else split_conjunction(edge.guard, known)
        compiled = self.compiler.compile(conjunction, known)
        if compiled is None:
            return None
        guard, ranges = compiled
        channel, channels, channel_code, sends, broadcast = -1, 0, NO_CODE, False, False
        if edge.synchronisation is not None:
            place = fold_place(edge.synchronisation.channel, known)
            sends = edge.synchronisation.direction is Direction.SEND
            broadcast = isinstance(place.type, ChannelType) and place.type.broadcast
            slot = self.layout.known_slot(place)
            if slot is not None:
                channel, channels = self.layout.slots[slot].initial, 1
            else:
                channel, channels = self._possible_channels(place)
                channel_code = self.generator.number_code(place, known)
        updates = tuple(fold(update, known) for update in edge.updates)
        return (
            ProgramEdge(
                process,
                number,
                selects,
                edge.source,
                edge.target,
                guard,
                channel,
                channels,
                channel_code,
                sends,
                self._update(updates),
            ),
            BoundEdge(
                edge.source,
                edge.target,
                frozenset(self.clocks.always_set(updates)),
                ranges,
                joined_copies(self.clocks.copies_of(updates, known)),
                both_directions=broadcast and not sends,
            ),
        )

    def _possible_channels(self, place: Expression) -> tuple[int, int]:
        """The first of the channels that a place may denote, and their number: all of the variable it is built on."""
        match place:
            case Index(base) | Field(base):
                return self._possible_channels(base)
            case Reference(variable):
                first = self.layout.first_slot(variable)
                of_channels = [isinstance(leaf, ChannelType) for _, leaf in leaves(variable.type)]
                return self.layout.slots[first + of_channels.index(True)].initial, sum(of_channels)
            case _:
                return 0, len(self.layout.channels)

    def _update(self, updates: tuple[Expression, ...]) -> Update:
        stores: dict[int, int] = {}
        resets: list[tuple[int, int, int]] = []
        for update in updates:
            match update:
                case Assign(target, Constant(value), _, None) if is_integer(target.type):
                    slot = self.layout.known_slot(target)
                    if slot is None or not self.layout.slots[slot].low <= value <= self.layout.slots[slot].high:
                        return Update(code=self.generator.update_code(updates))
                    stores[slot] = value
                case Assign(target) if isinstance(target.type, ClockType):
                    reset = self.clocks.reset(update)
                    if reset is None:
                        return Update(code=self.generator.update_code(updates))
                    resets = [*_not_overwritten(resets, reset), reset]
                case _:
                    return Update(code=self.generator.update_code(updates))
        return Update(tuple(stores.items()), tuple(resets))

    # ---- chances ----------------------------------------------------------------------------------------------------

    def chance(self, value: Chance | None, known: Known) -> Computed:
        """A rate or weight, 1 by default. Raises UnsupportedError for an unsupported one."""
        if isinstance(value, Diagnostic):
            raise UnsupportedError(replace(value, code="E0722"))
        return Computed(constant=1) if value is None else self.computed(value, known)

    def computed(self, value: Expression, known: Known) -> Computed:
        """An integer or floating point expression."""
        folded = fold(value, known)
        floating = value.type == DOUBLE
        number = folded.value if isinstance(folded, Constant) else constant_number(folded)
        if number is not None:
            return Computed(constant=number, floating=floating)
        piece = self.generator.slots_code if floating else self.generator.value_code
        return Computed(code=piece(value, known), floating=floating)

    def branches(self, known: Known) -> tuple[tuple[int, ...], tuple[Computed, ...]]:
        """For each edge the first one that is a branch of the same way into a branchpoint, and its weight."""
        choices: list[int] = []
        weights: list[Computed] = []
        first: dict[tuple[int, int, tuple[int, ...]], int] = {}
        for number, instance in enumerate(self.edges):
            edge = self.network.processes[instance.process].edges[instance.edge]
            if edge.branch is None:
                choices.append(number)
                weights.append(Computed(constant=1))
                continue
            way = instance.process, edge.branch.way, instance.selects[: edge.branch.selects]
            choices.append(first.setdefault(way, number))
            bound = known
            for variable, value in zip(edge.selects, instance.selects, strict=True):
                bound = bound.with_bound(variable, value)
            weights.append(self.chance(edge.branch.weight, bound))
        return tuple(choices), tuple(weights)

    # ---- the whole --------------------------------------------------------------------------------------------------

    def program(self, observed: Sequence[ObservedByGoal]) -> Program:
        """The finished program, with the clock bounds filled in."""
        network = self.network
        priorities = {network.default_priority, *(c.priority for c in self.layout.channels)}
        has_priorities = len(priorities) > 1 or len({p.priority for p in network.processes}) > 1
        model_ranges = [r for process in self.invariants for ranges in process for r in ranges]
        model_ranges += [r for process in self.bound_edges for edge in process for r in edge.constraints]
        diagonals = self._diagonals([*model_ranges, *(o.constraint for o in observed)])
        bounds = self._bounds(observed, diagonals, has_priorities)
        maximum = [-1] * (len(self.layout.clock_names) + 1)
        for process in bounds:
            for location in process:
                for clock, constant in (*location.lower, *location.upper):
                    maximum[clock] = max(maximum[clock], constant)
        locations = tuple(
            tuple(replace(l, lower=b.lower, upper=b.upper) for l, b in zip(process, found, strict=True))
            for process, found in zip(self.locations, bounds, strict=True)
        )
        return Program(
            process_priorities=tuple(p.priority for p in network.processes),
            locations=locations,
            edges=tuple(self.edges),
            channels=tuple(self.layout.channels),
            clock_names=tuple(self.layout.clock_names),
            slots=tuple(self.layout.slots),
            state_slots=self.layout.state_slots,
            code=tuple(self.generator.assembler.code),
            sites=tuple(self.generator.assembler.sites),
            default_priority=network.default_priority,
            maximum_constants=tuple(maximum),
            diagonals=diagonals,
            has_priorities=has_priorities,
            has_stopwatches=any(l.stopped for process in self.locations for l in process),
            copies_clocks=bool(self.clocks.copies),
            largest_reset=self.clocks.largest,
            computed_unit=gcd(self.clocks.unit, self.compiler.computed_unit),
            starts=tuple((clock, value) for clock, value in enumerate(self.layout.starts, start=1) if value > 0),
        )

    def _bounds(
        self,
        observed: Sequence[ObservedByGoal],
        diagonals: tuple[tuple[int, int, int], ...],
        has_priorities: bool,
    ) -> list[tuple[LocationBounds, ...]]:
        of_diagonals = diagonal_bounds(diagonals, self.clocks.values)
        lower, upper = dict(of_diagonals), dict(of_diagonals)
        at_location = [[list(ranges) for ranges in process] for process in self.invariants]
        for constraint, place in ((o.constraint, self._place(o)) for o in observed):
            if place is None:
                collect(constraint, lower, upper)
            else:
                at_location[place[0]][place[1]].append(constraint)
        symmetric = None if has_priorities else frozenset(of_diagonals)
        return network_bounds(at_location, self.bound_edges, (lower, upper), symmetric)

    def _diagonals(self, ranges: Sequence[ConstraintRange]) -> tuple[tuple[int, int, int], ...]:
        """The difference constraints between clocks, and what copies make of them. Raises UnsupportedError where these
        are too many, perhaps without end."""
        written = _diagonals(ranges)
        return self.clocks.copied(written, MAXIMAL_DIAGONALS)

    def _place(self, observed: ObservedByGoal) -> tuple[int, int] | None:
        """A location where the constraint can be counted instead of everywhere: the predicate looks at it only there,
        and the process resets the clocks itself, so that they are free on the way there."""
        constraint = observed.constraint
        clocks = {*constraint.lefts, *constraint.rights} - {0}
        for process, location in observed.places:
            if clocks <= {clock for edge in self.bound_edges[process] for clock in edge.resets}:
                return process, location
        return None


def _not_overwritten(resets: list[tuple[int, int, int]], then: tuple[int, int, int]) -> list[tuple[int, int, int]]:
    """Without those of a clock that is set once more, if nothing reads it in between."""
    clock, _, source = then
    read = clock in (source, *(each for _, _, each in resets))
    return resets if read else [each for each in resets if each[0] != clock]


def _diagonals(ranges: Sequence[ConstraintRange]) -> tuple[tuple[int, int, int], ...]:
    """The difference constraints between two clocks, each value of a variable bound on its own."""
    found: dict[tuple[int, int, int], None] = {}
    for constraint in ranges:
        if not constraint.is_diagonal:
            continue
        pairs = [(x, y) for x in constraint.lefts for y in constraint.rights if x != y]
        if len(pairs) * (constraint.high - constraint.low + 1) > MAXIMAL_DIAGONALS:
            raise _too_many_diagonals(constraint.span)
        for left, right in pairs:
            for bound in range(constraint.low, constraint.high + 1):
                found[left, right, 2 * bound + (0 if constraint.strict else 1)] = None
    return tuple(found)


def _too_many_edges(span: Span) -> UnsupportedError:
    return UnsupportedError(
        Diagnostic(
            "E0708",
            f"expanding the select labels gives more than {MAXIMAL_EDGES} edges",
            span,
            "select from smaller ranges, or replace a select by a variable that is set step by step",
        )
    )


def _too_many_diagonals(span: Span) -> UnsupportedError:
    return UnsupportedError(
        Diagnostic(
            "E0709",
            f"the bound of this clock difference may have more than {MAXIMAL_DIAGONALS} values",
            span,
            "declare a smaller range for the variables of the bound",
        )
    )
