"""The variables of one moment of a run: a discrete state, its clocks, and the step that ends it."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import z3

from tachk.base.job import check_job
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass
from tachk.engine.smt.machine import Clocks, Machine
from tachk.engine.smt.storage import CLOCK_SOURCE, CLOCK_VALUE, STATE, Storage
from tachk.engine.smt.terms import (
    Formula,
    SymbolicNumber,
    any_of,
    compare,
    conj,
    constant,
    of_each_value,
    real,
    unknown,
)
from tachk.model.network import Network
from tachk.model.run import Participant
from tachk.model.traversal import process_expressions, written_variables
from tachk.model.types import ChannelType, ClockType, bounds, slot_count
from tachk.model.variable_layout import VariableLayout


@dataclass(frozen=True, slots=True)
class StateFrame:
    """The variables of one frame, or of the template of all of them.

    Attributes:
        locations: of each process.
        slots: of every variable of the network; known where nothing writes it.
        resets: for each clock, from number 1 on, the moment when it was 0.
        entered, left: the two moments.
        fires: for each edge instance whether it takes part in the step that ends the frame.
    """

    locations: tuple[SymbolicNumber, ...]
    slots: tuple[SymbolicNumber, ...]
    resets: tuple[z3.ArithRef, ...]
    entered: z3.ArithRef
    left: z3.ArithRef
    fires: tuple[z3.BoolRef, ...]

    def state(self) -> list[z3.ExprRef]:
        """The decisions of the step before, in the same order for every frame."""
        numbers = [number.term for number in (*self.locations, *self.slots) if number.term is not None]
        return [*numbers, *self.resets, self.entered]

    def variables(self) -> list[z3.ExprRef]:
        return [*self.state(), self.left, *self.fires]


@dataclass(frozen=True, slots=True)
class ClocksOf:
    """The clocks of a frame at a moment of it."""

    frame: StateFrame
    stopped: dict[int, Formula]
    moment: z3.ArithRef

    def now(self, clock: int) -> z3.ArithRef:
        """Until when a clock has run."""
        stopped = self.stopped.get(clock, False)
        if isinstance(stopped, bool):
            return self.frame.entered if stopped else self.moment
        return z3.If(stopped, self.frame.entered, self.moment)

    def compare(self, operator: BinaryOperator, plus: Clocks, less: Clocks, bound: SymbolicNumber) -> Formula:
        added = [clock for clock in plus if clock not in less]
        taken = [clock for clock in less if clock not in plus]
        known = of_each_value(bound)
        if not added and not taken:
            return compare(operator, constant(0), bound)
        if len(added) == len(taken) == 1 and not (set(added) | set(taken)) & set(self.stopped):
            difference = self.frame.resets[taken[0] - 1] - self.frame.resets[added[0] - 1]
        else:
            value = z3.RealVal(0)
            for clock in added:
                value = value + self.now(clock) - self.frame.resets[clock - 1]
            for clock in taken:
                value = value - (self.now(clock) - self.frame.resets[clock - 1])
            difference = z3.simplify(value)
        if known is None:
            return _compared(operator, difference, real(bound))
        return any_of(conj(is_value, _compared(operator, difference, z3.RealVal(value))) for is_value, value in known)


def _compared(operator: BinaryOperator, left: z3.ArithRef, right: z3.ArithRef) -> z3.BoolRef:
    match operator:
        case BinaryOperator.LESS:
            return left < right
        case BinaryOperator.LESS_EQUAL:
            return left <= right
        case BinaryOperator.GREATER:
            return left > right
        case BinaryOperator.GREATER_EQUAL:
            return left >= right
        case BinaryOperator.EQUAL:
            return left == right
        case BinaryOperator.NOT_EQUAL:
            return left != right
        case _:
            raise ValueError(f"{operator} does not compare clocks")


def fresh_frame(network: Network, layout: VariableLayout, like: StateFrame | None, name: str) -> StateFrame:
    """Variables of a frame; without a pattern those that nothing writes are known."""
    locations = tuple(
        unknown(f"{name}.{number}", 0, len(process.locations) - 1) for number, process in enumerate(network.processes)
    )
    if like is None:
        written = written_variables([e for process in network.processes for e in process_expressions(process)])
        varies = [False] * len(layout.names)
        for variable in written:
            first = layout.first.get(variable)
            if first is not None and not network.resets(variable):
                varies[first : first + slot_count(variable.type)] = [True] * slot_count(variable.type)
        varies = [v and not isinstance(t, ClockType | ChannelType) for v, t in zip(varies, layout.types, strict=True)]
    else:
        varies = [number.term is not None for number in like.slots]
    slots = tuple(
        unknown(f"{name}.{layout.names[slot]}", *layout.ranges[slot]) if varies[slot] else constant(value)
        for slot, value in enumerate(layout.initial)
    )
    resets = tuple(z3.Real(f"{name}.r{number}") for number in range(1, len(layout.clock_slots) + 1))
    count = _count(network) if like is None else len(like.fires)
    fires = tuple(z3.Bool(f"{name}.fire{number}") for number in range(count))
    return StateFrame(locations, slots, resets, z3.Real(f"{name}.entered"), z3.Real(f"{name}.left"), fires)


def participants(network: Network) -> Iterator[Participant]:
    """The edges of all processes, once for each combination of select values."""
    for number, process in enumerate(network.processes):
        for edge_number, edge in enumerate(process.edges):
            ranges = [bounds(variable.type) for variable in edge.selects]  # type: ignore[arg-type]
            for values in product(*(range(low, high + 1) for low, high in ranges)):
                check_job()
                yield Participant(number, edge_number, values)


def _count(network: Network) -> int:
    return sum(1 for _ in participants(network))


def machine_of(layout: VariableLayout, frame: StateFrame, clocks: ClocksOf) -> Machine:
    slots = {(STATE, position): number for position, number in enumerate(frame.slots)}
    for clock in range(1, len(layout.clock_slots) + 1):
        slots[CLOCK_SOURCE, clock], slots[CLOCK_VALUE, clock] = constant(clock), constant(0)
    return Machine(layout, frame.locations, Storage(slots, {STATE: layout.ranges}), clocks.compare)
