"""A unit for co-simulation: a network, and the variables that a master sees."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from enum import IntEnum
from fractions import Fraction
from functools import partial, reduce

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass
from tachk.base.time_units import length_of
from tachk.engine.compiler.features import check_units
from tachk.engine.compiler.lower import lower_simulation
from tachk.engine.compiler.program import Chances, Program
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT
from tachk.model.expressions import BOOL, Binary, Constant, Expression, LocationTest
from tachk.model.floating import DOUBLE
from tachk.model.network import Network
from tachk.model.types import BoolType, leaves
from tachk.simulation.columns import Column, changing_columns, observed
from tachk.simulation.fmi.environment import OUTSIDE, SENT, OpenNetwork, open_network

_NANOSECONDS = 10**9
_COMMITTED = "committed"


class Role(IntEnum):
    """The role of a variable: `src/core/fmi/resource_file.hpp` has the same list."""

    TIME = 0
    SEED = 1
    RUN = 2
    POLICY = 3
    TRANSITIONS = 4
    OBSERVED = 5
    INPUT = 6
    RECEIVES = 7
    SENDS = 8


class FmiType(IntEnum):
    """The type of a variable, in the order of `src/core/fmi/resource_file.hpp`."""

    REAL = 0
    INTEGER = 1
    TRUTH = 2
    ENUMERATION = 3
    NATURAL = 4
    CLOCK = 5


@dataclass(frozen=True, slots=True)
class UnitVariable:
    """A variable of a unit; its place is its value reference.

    Attributes:
        number: which one it is among those of its role; of an input its slot.
        target: of an input: the slot of the variable whose value it is; -1 if that does not last.
        labels: of an enumeration, from 0 on.
        start: what it has before it is set, if it can be.
        bounds: the least and the largest value, where known.
    """

    name: str
    role: Role
    kind: FmiType
    number: int = 0
    labels: tuple[str, ...] = ()
    start: int | None = None
    bounds: tuple[int, int] | None = None
    target: int = -1


@dataclass(frozen=True, slots=True)
class CoSimulationUnit:
    """Attributes:
    name: of the model, an identifier of C.
    second: how many ticks are a second.
    nudge: the edge by which the environment changes inputs without sending anything; -1 if there are no inputs.
    """

    name: str
    program: Program
    chances: Chances
    variables: tuple[UnitVariable, ...]
    second: Fraction
    nudge: int = -1


def closed_unit(network: Network, name: str) -> CoSimulationUnit:
    """A network without environment. Raises UnsupportedError for what is not simulated."""
    check_units(network)
    columns = changing_columns(network)
    program, chances = lower_simulation(network, observed(columns))
    return CoSimulationUnit(
        identifier(name),
        program,
        chances,
        (*common(), *observations(columns, program)),
        ticks_of_a_second(network),
    )


def open_unit(network: Network, names: Sequence[str], name: str, clocks: bool) -> CoSimulationUnit:
    """Some processes of a network, with variables and channels that lead out of it.

    Args:
        clocks: channels are clocks; otherwise they are numbers of messages.

    Raises UsageError for a part that cannot run on its own, and UnsupportedError for what is not simulated.
    """
    check_units(network)
    for column in changing_columns(network):
        if column.name == _COMMITTED or column.name.startswith((OUTSIDE, SENT)):
            raise UsageError(
                f"units of parts have {column.name} for something else", "choose another name in the model"
            )
    opened = open_network(network, names)
    columns = [column for column in changing_columns(opened.network) if not column.name.startswith(OUTSIDE)]
    columns.append(Column(_COMMITTED, _is_committed(opened.network), truth=True))
    program, chances = lower_simulation(opened.network, observed(columns))
    last = len(opened.network.processes) - 1
    numbers = {edge.edge: n for n, edge in enumerate(program.edges) if edge.process == last}
    kind, start = (FmiType.CLOCK, None) if clocks else (FmiType.INTEGER, 0)
    return CoSimulationUnit(
        identifier(name),
        program,
        chances,
        (
            *common(),
            *observations(columns, program),
            *_inputs(opened, program),
            *(
                UnitVariable(f"{channel}?", Role.RECEIVES, kind, numbers[edge], start=start)
                for channel, edge in opened.receives
            ),
            *(UnitVariable(f"{channel}!", Role.SENDS, kind, numbers[edge]) for channel, edge in opened.sends),
        ),
        ticks_of_a_second(network),
        numbers[opened.nudge],
    )


def _is_committed(network: Network) -> Expression:
    """The condition that some process is in a committed location."""
    tests: list[Expression] = [
        LocationTest(number, place)
        for number, process in enumerate(network.processes)
        for place, location in enumerate(process.locations)
        if location.committed
    ]
    return reduce(partial(Binary, BinaryOperator.OR, type=BOOL), tests) if tests else Constant(0, BOOL)


def _inputs(opened: OpenNetwork, program: Program) -> Iterator[UnitVariable]:
    """The components of the inputs, each with its slot and that of the variable that it is for."""
    network = opened.network
    slots: dict[str, int] = {}
    for variable in network.all_variables():
        for path, _ in leaves(variable.type):
            slots[variable.name + path] = len(network.processes) + len(slots)
    for input_, variable in opened.inputs:
        for path, type_ in leaves(variable.type):
            slot = slots[input_.name + path]
            known, truth = program.slots[slot], isinstance(type_, BoolType)
            yield UnitVariable(
                input_.name + path,
                Role.INPUT,
                FmiType.TRUTH if truth else FmiType.INTEGER,
                slot,
                start=known.initial,
                bounds=None if truth else (known.low, known.high),
                target=-1 if network.resets(variable) else slots[variable.name + path],
            )


def identifier(name: str) -> str:
    """A name that a C compiler and a file system take."""
    plain = re.sub(r"\W", "_", name, flags=re.ASCII)
    return plain if plain[:1].isalpha() else f"model_{plain}"


def ticks_of_a_second(network: Network) -> Fraction:
    """Time is in seconds; in a model without a unit of time, 1 is a second."""
    length = length_of(network.time_unit) if network.time_unit else None
    return Fraction(TICKS_PER_UNIT) * (1 if length is None else Fraction(_NANOSECONDS) / length)


def common() -> tuple[UnitVariable, ...]:
    """The variables of every unit."""
    policies = tuple(policy.value for policy in Policy)
    return (
        UnitVariable("time", Role.TIME, FmiType.REAL),
        UnitVariable("seed", Role.SEED, FmiType.NATURAL, start=0),
        UnitVariable("run", Role.RUN, FmiType.NATURAL, start=0),
        UnitVariable("policy", Role.POLICY, FmiType.ENUMERATION, labels=policies, start=0),
        UnitVariable("transitions", Role.TRANSITIONS, FmiType.NATURAL),
    )


def observations(columns: Sequence[Column], program: Program) -> Iterator[UnitVariable]:
    """The columns of a run, under the names that they have in a recording."""
    taken = {variable.name for variable in common()}
    for number, column in enumerate(columns):
        name = f"model.{column.name}" if column.name in taken else column.name
        kind, bounds = _kind(column), None
        if kind is FmiType.INTEGER and isinstance(column.value, int):
            slot = program.slots[column.value]
            bounds = slot.low, slot.high
        yield UnitVariable(name, Role.OBSERVED, kind, number, column.labels, bounds=bounds)


def _kind(column: Column) -> FmiType:
    if column.labels:
        return FmiType.ENUMERATION
    if column.truth:
        return FmiType.TRUTH
    return FmiType.INTEGER if isinstance(column.value, int) or column.value.type != DOUBLE else FmiType.REAL
