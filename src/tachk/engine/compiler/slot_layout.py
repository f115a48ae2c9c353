"""The layout of a compiled network: slots of the discrete state, clock numbers, channel numbers, frame slots."""

from __future__ import annotations

from collections.abc import Collection

from tachk.analysis.fold import Known, known_slot
from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.operators import CONSTANT_HIGH, CONSTANT_LOW
from tachk.engine.compiler.program import ProgramChannel, Slot
from tachk.model.expressions import Expression, Variable
from tachk.model.network import Network
from tachk.model.types import ChannelType, ClockType, IntType, Type, leaves
from tachk.model.variable_layout import default_value, slot_range


class SlotLayout:
    """The slots of a network; frame slots are added while code is generated.

    Attributes:
        processes: how many of the slots hold locations.
        slots: all slots so far (`Program.slots`).
        state_slots: how many of them are the state.
        clock_names, channels: by number; clock number ``i`` is entry ``i - 1``.
        starts: what each clock shows at first.
    """

    def __init__(self, network: Network, known: Known, tables: Collection[Variable] = ()) -> None:
        """The variables in ``tables`` have no slots. Raises InputError for an initial value outside its variable's
        range."""
        self.processes = len(network.processes)
        self.slots: list[Slot] = [
            Slot(process.name, 0, max(len(process.locations) - 1, 0), process.initial) for process in network.processes
        ]
        self.clock_names: list[str] = []
        self.starts: list[int] = []
        self.channels: list[ProgramChannel] = []
        self._first: dict[Variable, int] = {}
        problems: list[Diagnostic] = []
        for variable in network.all_variables():
            if variable in tables:
                continue
            self._first[variable] = len(self.slots)
            for i, (path, type_) in enumerate(leaves(variable.type)):
                initial = variable.initial[i] if variable.initial else default_value(type_)
                slot = self._slot(network, variable, i, path, type_, initial)
                if variable in known.values and isinstance(type_, IntType):
                    slot = Slot(slot.name, initial, initial, initial, slot.meta)
                elif not slot.low <= slot.initial <= slot.high:
                    problems.append(_initial_value_outside(slot, initial, variable))
                self.slots.append(slot)
        if problems:
            raise InputError(problems)
        self.state_slots = len(self.slots)

    def _slot(self, network: Network, variable: Variable, i: int, path: str, type_: Type, initial: int) -> Slot:
        name = variable.name + path
        if isinstance(type_, ClockType):
            self.clock_names.append(name)
            self.starts.append(initial)
            number = len(self.clock_names)
            return Slot(name, number, number, number)
        if isinstance(type_, ChannelType):
            number = len(self.channels)
            priority = variable.priorities[i] if variable.priorities else network.default_priority
            self.channels.append(ProgramChannel(name, type_.broadcast, type_.urgent, priority))
            return Slot(name, number, number, number)
        low, high = slot_range(type_)
        return Slot(name, low, high, initial, network.resets(variable))

    def first_slot(self, variable: Variable) -> int:
        """The first slot of a variable; a frame variable gets its slots when it is first looked up."""
        if variable not in self._first:
            self._first[variable] = len(self.slots)
            if variable.reference:
                self.slots.append(Slot(variable.name, CONSTANT_LOW, CONSTANT_HIGH, 0))
            else:
                self.block(variable.name, variable.type)
        return self._first[variable]

    def temporary(self, size: int) -> int:
        """The first of fresh frame slots without a range."""
        first = len(self.slots)
        self.slots.extend(Slot("", CONSTANT_LOW, CONSTANT_HIGH, 0) for _ in range(size))
        return first

    def block(self, name: str, type_: Type) -> int:
        """The first of fresh frame slots for a value of a type, with its ranges."""
        first = len(self.slots)
        self.slots.extend(Slot(name + path, *slot_range(t), default_value(t)) for path, t in leaves(type_))
        return first

    def known_slot(self, place: Expression) -> int | None:
        """The slot a place denotes, if that does not depend on the state."""
        component = known_slot(place)
        return None if component is None else self.first_slot(component[0]) + component[1]

    def is_state(self, slot: int) -> bool:
        return slot < self.state_slots


def _initial_value_outside(slot: Slot, initial: int, variable: Variable) -> Diagnostic:
    return Diagnostic(
        "E0701",
        f"the initial value {initial} of `{slot.name}` is outside its range [{slot.low}, {slot.high}]",
        variable.span,
        "change the initial value or the declared range",
    )
