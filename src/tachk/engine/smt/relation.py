"""The transition relation of a network, as formulas over the variables of a frame and of the next one.

A frame is a discrete state with two moments: when it was entered and, after a delay, when it is left. A clock is the
present moment minus the moment of its last reset, so that all clock constraints are about differences of moments.
Invariants are convex: that they hold at both ends of a delay is enough.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import combinations

import z3

from tachk.base.job import check_job
from tachk.engine.smt.actions import Instance, SymbolicAction, TooManyComparisonsError, actions, sometimes, unblocked
from tachk.engine.smt.conditions import certain, guard
from tachk.engine.smt.frame import ClocksOf, StateFrame, fresh_frame, machine_of, participants
from tachk.engine.smt.machine import Machine, PossibleFault, unsupported
from tachk.engine.smt.storage import CLOCK_SOURCE, CLOCK_VALUE, STATE, Storage
from tachk.engine.smt.terms import (
    Formula,
    all_of,
    any_of,
    choose,
    conj,
    constant,
    disj,
    in_range,
    neg,
    of_each_value,
    real,
)
from tachk.meaning.discrete import prepare
from tachk.model.expressions import Expression
from tachk.model.network import Edge, Location, Network
from tachk.model.run import Participant
from tachk.model.traversal import reads_clock
from tachk.model.types import ChannelType
from tachk.model.variable_layout import VariableLayout, variable_layout


@dataclass(slots=True)
class TransitionRelation:
    """Attributes:
    template: the variables that all formulas are about; `after` are those of the frame behind a step.
    stay: that the invariants hold at both moments, and that time may pass between them.
    state_faults: the run-time errors that are possible where guards are evaluated, at the end of the delay.
    entry_faults: what may go wrong in the invariants when the frame is entered.
    step: what the step out of the frame makes of it.
    step_faults: what may go wrong in the updates of the step, also of one that a higher priority blocks.
    deadlock: whether no action is possible at the end of the delay nor later, and what may go wrong then.
    """

    network: Network
    layout: VariableLayout
    template: StateFrame
    after: StateFrame
    instances: tuple[Participant, ...]
    initiators: tuple[bool, ...]
    stay: Formula
    state_faults: tuple[PossibleFault, ...]
    entry_faults: tuple[PossibleFault, ...]
    step: Formula
    step_possible: Formula
    step_faults: tuple[PossibleFault, ...]
    stopped: dict[int, Formula]
    deadlock: Callable[[], tuple[Formula, Sequence[PossibleFault]]]

    def frame(self, name: str) -> StateFrame:
        """Fresh variables of the same shape."""
        return fresh_frame(self.network, self.layout, self.template, name)

    def at(self, formula: Formula, frame: StateFrame, after: StateFrame | None = None) -> Formula:
        """A formula about the template, said of a frame and of the one behind it."""
        if isinstance(formula, bool):
            return formula
        pairs = list(zip(self.template.variables(), frame.variables(), strict=True))
        if after is not None:
            pairs += list(zip(self.after.state(), after.state(), strict=True))
        return z3.substitute(formula, *pairs)

    def initial(self, frame: StateFrame) -> Formula:
        """The formula that a frame is the first one of a run."""
        parts: list[Formula] = [
            number.is_value(process.initial)
            for number, process in zip(frame.locations, self.network.processes, strict=True)
        ]
        parts += [number.is_value(value) for number, value in zip(frame.slots, self.layout.initial, strict=True)]
        parts += [reset == -start for reset, start in zip(frame.resets, self.layout.starts, strict=True)]
        return all_of([*parts, frame.entered == 0])

    def any_frame(self, frame: StateFrame) -> Formula:
        """The constraints of every frame: ranges of variables, and that clocks are not negative."""
        parts = [in_range(number) for number in (*frame.locations, *frame.slots)]
        return all_of([*parts, *(reset <= frame.entered for reset in frame.resets), frame.entered <= frame.left])

    def where(self, predicate: Expression) -> tuple[Formula, Formula, list[PossibleFault]]:
        """The formulas that a predicate is true, and that a part decides it that cannot be evaluated; and the possible
        run-time errors."""
        machine = machine_of(self.layout, self.template, ClocksOf(self.template, self.stopped, self.template.left))

        def deadlock() -> Formula:
            stuck, faults = self.deadlock()
            for fault in faults:
                machine.goes_wrong(fault.condition, fault.kind, fault.span)
            return stuck

        machine.is_deadlock = deadlock
        wrong: list[PossibleFault] = []
        yes, no = certain(machine, predicate, wrong)
        return yes, neg(disj(yes, no)) if wrong else False, wrong

    def clock(self, number: int) -> z3.ArithRef:
        """The value of a clock at the end of the delay of the template frame; 0 for number 0."""
        if number == 0:
            return z3.RealVal(0)
        return ClocksOf(self.template, self.stopped, self.template.left).now(number) - self.template.resets[number - 1]


def relation(network: Network) -> TransitionRelation:
    """Encodes a network. Raises UnsupportedError for what is not encoded."""
    layout = variable_layout(network)
    channels = [layout.types[slot] for slot in layout.channel_slots]
    return _Encoder(network, layout, [c for c in channels if isinstance(c, ChannelType)]).encode()


@dataclass(slots=True)
class _Encoder:
    network: Network
    layout: VariableLayout
    channels: Sequence[ChannelType]
    frame: StateFrame = field(init=False)
    instances: list[Instance] = field(init=False)
    committed: Formula = field(init=False)
    may_go: list[Formula] = field(init=False)
    stopped: dict[int, Formula] = field(default_factory=dict)
    faults: list[PossibleFault] = field(default_factory=list)

    def encode(self) -> TransitionRelation:
        self.frame = fresh_frame(self.network, self.layout, None, "s")
        after = fresh_frame(self.network, self.layout, self.frame, "n")
        self.stopped = stopped = self._stopped()
        at_end = ClocksOf(self.frame, stopped, self.frame.left)
        self._add_conditions()
        invariant, _ = self._invariant(at_end)
        on_entry, entry_faults = self._invariant(ClocksOf(self.frame, stopped, self.frame.entered))
        waits = self.frame.left > self.frame.entered
        stay = all_of([invariant, on_entry, disj(neg(waits), self._time_may_pass())])
        chosen = self._chosen()
        changed, step_faults = self._updated(after)
        first = unblocked(self._actions()) if self.network.has_priorities else True
        return TransitionRelation(
            self.network,
            self.layout,
            self.frame,
            after,
            tuple(instance.participant for instance in self.instances),
            tuple(not instance.receives for instance in self.instances),
            stay,
            tuple(self.faults),
            tuple(entry_faults),
            all_of([chosen, first, changed, neg(any_of(fault.condition for fault in step_faults))]),
            chosen,
            tuple(step_faults),
            stopped,
            cache(self._deadlock),
        )

    def _edge(self, participant: Participant) -> Edge:
        return self.network.processes[participant.process].edges[participant.edge]

    def _at(self, process: int, locations: Iterable[int]) -> Formula:
        return any_of(self.frame.locations[process].is_value(location) for location in locations)

    # ---- possible actions -------------------------------------------------------------------------------------------

    def _add_conditions(self) -> None:
        """Encodes which edges are open at the end of the delay, over which channels; and the run-time errors in their
        guards where these are evaluated."""
        machine = machine_of(self.layout, self.frame, ClocksOf(self.frame, self.stopped, self.frame.left))
        self.instances = [
            Instance(p, self._edge(p), fires, self._at(p.process, [self._edge(p).source]))
            for p, fires in zip(participants(self.network), self.frame.fires, strict=True)
        ]
        self._add_committed()
        for instance in self.instances:
            if not instance.receives:
                admitted = True if instance.sends else self.may_go[instance.process]
                self._add_edge(machine, instance, conj(instance.at_source, admitted))
        for instance in self.instances:
            if instance.receives:
                self._add_edge(machine, instance, self._is_called(machine, instance))

    def _add_committed(self) -> None:
        """Encodes the committed rule: is some process committed, and which processes may go (`Location.may_go`)?"""

        def at(wanted: Callable[[Location], bool]) -> list[Formula]:
            return [
                self._at(number, [n for n, location in enumerate(process.locations) if wanted(location)])
                for number, process in enumerate(self.network.processes)
            ]

        committed = at(lambda location: location.committed)
        first = any_of(at(lambda location: location.commitment > 1))
        self.committed = any_of(committed)
        self.may_go = [
            any_of([neg(self.committed), observes, conj(own, neg(first))])
            for own, observes in zip(committed, at(lambda location: location.observes), strict=True)
        ]

    def _is_called(self, machine: Machine, receiver: Instance) -> Formula:
        """The formula that some sender makes the guard of a receiver evaluated."""
        named = self._channels_named(machine, receiver)
        calls: list[Formula] = []
        for sender in self.instances:
            if not sender.sends or sender.process == receiver.process:
                continue
            meet = disj(self.may_go[sender.process], self.may_go[receiver.process])
            calls += [
                conj(sender.open, condition, True if self.channels[channel].broadcast else meet)
                for condition, channel in sender.channels
                if channel in named
            ]
        return conj(receiver.at_source, any_of(calls))

    def _channels_named(self, machine: Machine, instance: Instance) -> set[int]:
        """The channels that an edge may name, whatever goes wrong."""
        assert instance.edge.synchronisation is not None
        before = len(machine.faults)
        machine.path = True
        self._bind(machine, instance)
        named = {number for _, number in machine.clocks_named(instance.edge.synchronisation.channel)}
        del machine.faults[before:]
        return named

    def _bind(self, machine: Machine, instance: Instance) -> None:
        for variable, value in zip(instance.edge.selects, instance.participant.selects, strict=True):
            machine.bind(variable, value)

    def _add_edge(self, machine: Machine, instance: Instance, enabled: Formula) -> None:
        check_job()
        self._bind(machine, instance)
        machine.faults = []
        machine.path = enabled
        _, whole = guard(machine, instance.edge.guard)
        instance.open = conj(enabled, whole)
        synchronisation = instance.edge.synchronisation
        if synchronisation is not None:
            machine.path = instance.open
            instance.channels = machine.clocks_named(synchronisation.channel)
            machine.path = enabled
        self.faults += machine.faults

    def _invariant(self, clocks: ClocksOf) -> tuple[Formula, list[PossibleFault]]:
        machine = machine_of(self.layout, self.frame, clocks)
        whole: list[Formula] = []
        enabled: Formula = True
        for number, process in enumerate(self.network.processes):
            integers: list[Formula] = []
            for place, location in enumerate(process.locations):
                if location.invariant is None:
                    continue
                here = self._at(number, [place])
                machine.path = conj(enabled, here)
                integer, all_of_it = guard(machine, location.invariant)
                whole.append(disj(neg(here), all_of_it))
                integers.append(disj(neg(here), integer))
            enabled = conj(enabled, all_of(integers))
        return all_of(whole), machine.faults

    def _time_may_pass(self) -> Formula:
        still = any_of(
            self._at(number, [n for n, place in enumerate(process.locations) if place.urgent or place.committed])
            for number, process in enumerate(self.network.processes)
        )
        return conj(neg(still), neg(self._urgent()))

    def _urgent(self) -> Formula:
        """The formula that a synchronisation over an urgent channel is enabled."""
        found: list[Formula] = []
        for sender in self.instances:
            if not sender.sends:
                continue
            for condition, channel in sender.channels:
                type_ = self.channels[channel]
                if not type_.urgent:
                    continue
                self._refuse_clock(sender)
                partner: Formula = True
                if not type_.broadcast:
                    partner = any_of(
                        conj(receiver.open, also)
                        for receiver in self.instances
                        if receiver.receives and receiver.process != sender.process
                        for also, other in receiver.channels
                        if other == channel
                    )
                    for receiver in self.instances:
                        if receiver.receives and any(other == channel for _, other in receiver.channels):
                            self._refuse_clock(receiver)
                found.append(all_of([sender.open, condition, partner]))
        return any_of(found)

    def _refuse_clock(self, instance: Instance) -> None:
        if instance.edge.guard is not None and reads_clock(instance.edge.guard):
            raise unsupported("a clock guard on an urgent channel", instance.edge.guard.span)

    def _stopped(self) -> dict[int, Formula]:
        """The clocks that may stand still, with when they do."""
        machine = machine_of(self.layout, self.frame, ClocksOf(self.frame, {}, self.frame.left))
        found: dict[int, Formula] = {}
        for number, process in enumerate(self.network.processes):
            for place, location in enumerate(process.locations):
                for clock, rate in location.rates:
                    stands = conj(self._at(number, [place]), machine.number(rate).is_value(0))
                    for condition, named in machine.clocks_named(clock):
                        found[named] = disj(found.get(named, False), conj(stands, condition))
        if machine.faults:
            raise unsupported("a rate that may go wrong", machine.faults[0].span)
        return {clock: formula for clock, formula in found.items() if formula is not False}

    # ---- single actions ---------------------------------------------------------------------------------------------

    def _actions(self) -> list[SymbolicAction]:
        return actions(self.network, self, [priority for _, priority in prepare(self.network).channels])

    def behind(self, instances: Sequence[Instance], condition: Formula) -> tuple[Formula, list[PossibleFault]]:
        """The formula that invariants allow some edges to fire together where a condition holds; and the run-time
        errors that are possible there."""
        machine = machine_of(self.layout, self.frame, ClocksOf(self.frame, self.stopped, self.frame.left))
        machine.path = condition
        locations = list(self.frame.locations)
        for instance in instances:
            self._bind(machine, instance)
            machine.execute(instance.edge.updates)
            locations[instance.process] = constant(instance.edge.target)
        slots = [
            number if number.term is None else machine.storage.slots[STATE, position]
            for position, number in enumerate(self.frame.slots)
        ]
        clocks = range(1, len(self.frame.resets) + 1)
        resets = [self._reset(machine.storage, clock) for clock in clocks]
        there = _Encoder(self.network, self.layout, self.channels)
        there.frame = StateFrame(tuple(locations), tuple(slots), tuple(resets), self.frame.left, self.frame.left, ())
        invariant, wrong = there._invariant(ClocksOf(there.frame, {}, there.frame.entered))
        wrong = [replace(fault, condition=conj(condition, fault.condition)) for fault in wrong]
        return invariant, [*machine.faults, *wrong]

    def _deadlock(self) -> tuple[Formula, Sequence[PossibleFault]]:
        """The formula that no action is possible at the end of the delay nor later; and the run-time errors that are
        possible then in guards, updates, or invariants after an action, which leave open if it is a deadlock."""
        moment = z3.Real("later")
        later = _Encoder(self.network, self.layout, self.channels)
        later.frame, later.stopped = replace(self.frame, left=moment), self.stopped
        later._add_conditions()
        invariant, _ = later._invariant(ClocksOf(later.frame, self.stopped, moment))
        waits = disj(moment == self.frame.left, self._time_may_pass())
        found = later._actions()
        wrong = [*later.faults, *(fault for action in found for fault in action.wrong)]

        def from_now_on(formula: Formula) -> Formula:
            return sometimes(all_of([invariant, waits, formula]), moment, self.frame.left)

        try:
            stuck = neg(from_now_on(any_of(action.possible for action in found)))
            return stuck, [replace(fault, condition=from_now_on(fault.condition)) for fault in wrong]
        except TooManyComparisonsError:
            what = "deadlock where what is possible later depends on clocks in too many ways"
            raise unsupported(what, self.network.processes[0].span) from None

    # ---- the step ---------------------------------------------------------------------------------------------------

    def _chosen(self) -> Formula:
        """The formula that edges fire together: one sender or internal edge, with its receivers."""
        parts: list[Formula] = []
        by_process: list[list[Instance]] = [[] for _ in self.network.processes]
        for instance in self.instances:
            by_process[instance.process].append(instance)
            parts.append(disj(neg(instance.fires), instance.open))
        parts += [_at_most_one([i.fires for i in of_process]) for of_process in by_process]
        starting = [instance.fires for instance in self.instances if not instance.receives]
        parts += [any_of(starting), _at_most_one(starting)]
        sends = [
            any_of(
                conj(sender.fires, condition)
                for sender in self.instances
                if sender.sends
                for condition, named in sender.channels
                if named == channel
            )
            for channel in range(len(self.channels))
        ]
        receiving: list[list[Formula]] = [[] for _ in self.channels]
        receivers = [instance for instance in self.instances if instance.receives]
        for receiver in receivers:
            called = [conj(condition, sends[named]) for condition, named in receiver.channels]
            parts.append(disj(neg(receiver.fires), any_of(called)))
            for condition, named in receiver.channels:
                receiving[named].append(conj(receiver.fires, condition))
        announced = any_of(sends[number] for number, type_ in enumerate(self.channels) if type_.broadcast)
        parts.append(disj(announced, _at_most_one([receiver.fires for receiver in receivers])))
        for number, type_ in enumerate(self.channels):
            if not type_.broadcast:
                parts.append(disj(neg(sends[number]), any_of(receiving[number])))
        parts += self._forced_to_receive(by_process, sends)
        moves = [conj(may, any_of(i.fires for i in own)) for may, own in zip(self.may_go, by_process, strict=True)]
        parts.append(disj(neg(self.committed), any_of(moves)))
        return all_of(parts)

    def _forced_to_receive(self, by_process: Sequence[Sequence[Instance]], sends: Sequence[Formula]) -> list[Formula]:
        """The condition that every process that can receive a broadcast of another one takes part in it."""
        parts: list[Formula] = []
        for of_process in by_process:
            takes_part = any_of(instance.fires for instance in of_process)
            for receiver in of_process:
                if not receiver.receives:
                    continue
                for condition, named in receiver.channels:
                    if self.channels[named].broadcast:
                        parts.append(neg(all_of([sends[named], receiver.open, condition, neg(takes_part)])))
        return parts

    def _updated(self, after: StateFrame) -> tuple[Formula, list[PossibleFault]]:
        machine = machine_of(self.layout, self.frame, ClocksOf(self.frame, self.stopped, self.frame.left))
        self._execute(machine, [instance for instance in self.instances if not instance.receives])
        for process in range(len(self.network.processes)):
            self._execute(machine, [i for i in self.instances if i.receives and i.process == process])
        parts: list[Formula] = []
        for position, number in enumerate(after.slots):
            if number.term is not None:
                made = machine.storage.slots[STATE, position]
                parts.append(number.term == made.at_width(number.term.size()))
        for process, number in enumerate(after.locations):
            if number.term is not None:
                target = self.frame.locations[process]
                for instance in self.instances:
                    if instance.process == process:
                        target = choose(instance.fires, constant(instance.edge.target), target)
                parts.append(number.term == target.at_width(number.term.size()))
        for clock, reset in enumerate(after.resets, 1):
            parts.append(reset == self._reset(machine.storage, clock))
        return all_of([*parts, after.entered == self.frame.left]), machine.faults

    def _execute(self, machine: Machine, alternatives: Sequence[Instance]) -> None:
        """The updates of those of some edges that fire; at most one does."""
        changes = []
        for instance in alternatives:
            check_job()
            if not instance.edge.updates or instance.open is False:
                continue
            self._bind(machine, instance)
            machine.path = instance.fires
            _, changed = machine.storage.undone(lambda edge=instance.edge: machine.execute(edge.updates))  # type: ignore[misc]
            changes.append((instance.fires, changed))
        machine.path = True
        for fires, changed in changes:
            machine.storage.apply(changed, fires)

    def _reset(self, storage: Storage, clock: int) -> z3.ArithRef:
        """The moment at which a clock would have been 0, as the next frame sees it."""
        source, value = storage.slots[CLOCK_SOURCE, clock], storage.slots[CLOCK_VALUE, clock]
        if source.is_value(clock) is True and value.is_value(0) is True:
            return self._clock_value(clock)
        moment: z3.ArithRef | None = None
        for number in source.values:
            is_source = source.is_value(number)
            if is_source is False:
                continue
            zero = self._clock_value(number) if number else self.frame.left
            moment = zero if moment is None or is_source is True else z3.If(is_source, zero, moment)
        assert moment is not None
        listed = of_each_value(value)
        if listed is None:
            return moment - real(value)
        earlier = moment - listed[-1][1] if listed[-1][1] else moment
        for condition, number in listed[:-1]:
            if not isinstance(condition, bool):
                earlier = z3.If(condition, moment - number if number else moment, earlier)
        return earlier

    def _clock_value(self, clock: int) -> z3.ArithRef:
        """The moment at which a clock that is not set would have been 0, as the next frame sees it."""
        since_reset, stopped = self.frame.resets[clock - 1], self.stopped.get(clock, False)
        if stopped is False:
            return since_reset
        later = since_reset + (self.frame.left - self.frame.entered)
        return later if stopped is True else z3.If(stopped, later, since_reset)


def _at_most_one(fires: Sequence[z3.BoolRef]) -> Formula:
    if len(fires) < 2:
        return True
    if len(fires) <= 6:
        return all_of(z3.Not(z3.And(a, b)) for a, b in combinations(fires, 2))
    return z3.AtMost(*fires, 1)
