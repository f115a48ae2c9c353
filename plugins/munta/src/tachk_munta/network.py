"""A network as Munta sees it: what its file holds, and which of its names stand for what in the model."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from tachk.api.plugin import Conjunction, bound_value, is_strict
from tachk_munta.cases import SlotCondition

IMPOSSIBLE = "never?"
"""A label of edges that are never taken: no process sends over this channel."""


@dataclass(frozen=True, slots=True)
class MuntaEdge:
    """Attributes:
    source, target: locations of the process.
    writes: slots with their new content.
    """

    source: int
    target: int
    conditions: tuple[SlotCondition, ...] = ()
    clocks: Conjunction = ()
    label: str = ""
    writes: tuple[tuple[int, int], ...] = ()
    resets: tuple[int, ...] = ()


@dataclass(slots=True)
class MuntaProcess:
    """Attributes:
    locations: the names.
    invariants: of each location.
    still: the locations in which no time passes.
    committed: the locations that must be left first.
    added: if the model has no such process, where it may be, whatever the others do.
    """

    name: str
    locations: list[str]
    invariants: list[Conjunction]
    still: set[int]
    committed: set[int]
    initial: int
    edges: list[MuntaEdge] = field(default_factory=list)
    added: tuple[int, ...] = ()

    def added_location(self, name: str) -> int:
        """The number of a new location."""
        self.locations.append(MuntaNames(self.locations).fresh(name))
        self.invariants.append(())
        return len(self.locations) - 1

    def used(self) -> list[int]:
        """The locations that Munta may know: those that have an edge."""
        ends = {end for edge in self.edges for end in (edge.source, edge.target)}
        return sorted(ends)


@dataclass(frozen=True, slots=True)
class Variables:
    """The slots that Munta has variables for, negative ones for locations of processes, and the clocks.

    Attributes:
        slots: in the order of Munta's variables.
        clocks: their numbers, in the order of Munta's clocks.
        starts: what is 0 in Munta, where all variables begin with 0.
    """

    slots: tuple[int, ...]
    clocks: tuple[int, ...]
    names: dict[int, str]
    clock_names: dict[int, str]
    starts: dict[int, int]
    ranges: dict[int, tuple[int, int]]

    def condition(self, condition: SlotCondition) -> str:
        name, start = self.names[condition.slot], self.starts[condition.slot]
        low, high = condition.low, condition.high
        if low == high:
            return f"{name} == {low - start}"
        all_low, all_high = self.ranges[condition.slot]
        parts = [f"{name} >= {low - start}"] * (low > all_low) + [f"{name} <= {high - start}"] * (high < all_high)
        return " && ".join(parts)

    def clock(self, constraint: tuple[int, int, int]) -> str:
        i, j, raw = constraint
        strict, value = is_strict(raw), bound_value(raw)
        if i:
            return f"{self.clock_names[i]} {'<' if strict else '<='} {value}"
        return f"{self.clock_names[j]} {'>' if strict else '>='} {-value}"

    def guard(self, conditions: Iterable[SlotCondition], clocks: Conjunction) -> str:
        return " && ".join([*map(self.condition, conditions), *map(self.clock, clocks)])

    def update(self, edge: MuntaEdge) -> str:
        writes = [f"{self.names[c]} = {value - self.starts[c]}" for c, value in edge.writes if c in self.names]
        return ", ".join([*writes, *(f"{self.clock_names[c]} = 0" for c in edge.resets if c in self.clock_names)])


@dataclass(frozen=True, slots=True)
class MuntaNetwork:
    """Attributes:
    places: for each process the locations that Munta knows, in the order of Munta's numbers for them.
    formula: in Munta's words.
    """

    processes: tuple[MuntaProcess, ...]
    variables: Variables
    broadcast: tuple[str, ...]
    formula: str
    places: tuple[tuple[int, ...], ...]

    def text(self) -> str:
        """The content of the model file (.muntax)."""
        variables = self.variables
        bounds = (
            f"{variables.names[slot]}[{low - variables.starts[slot]}:{high - variables.starts[slot]}]"
            for slot in variables.slots
            for low, high in [variables.ranges[slot]]
        )
        document = {
            "automata": [self._automaton(p, places) for p, places in zip(self.processes, self.places, strict=True)],
            "clocks": ", ".join(variables.clock_names[clock] for clock in variables.clocks) or "none",
            "vars": ", ".join(bounds),
            "broadcast": list(self.broadcast),
            "formula": self.formula,
        }
        return _in_lines(document) + "\n"

    def _automaton(self, process: MuntaProcess, places: Sequence[int]) -> dict[str, object]:
        number = {place: n for n, place in enumerate(places)}
        return {
            "name": process.name,
            "initial": number[process.initial],
            "committed": [number[place] for place in places if place in process.committed],
            "urgent": [number[place] for place in places if place in process.still],
            "nodes": [
                {
                    "id": number[place],
                    "name": process.locations[place],
                    "invariant": self.variables.guard((), process.invariants[place]),
                }
                for place in places
            ],
            "edges": [
                {
                    "source": number[edge.source],
                    "target": number[edge.target],
                    "guard": self.variables.guard(edge.conditions, edge.clocks),
                    "label": edge.label,
                    "update": self.variables.update(edge),
                }
                for edge in process.edges
            ],
        }

    def renaming(self) -> str:
        """The content of the file that names what each number in a certificate stands for."""
        variables = self.variables
        document = {
            "vars": {variables.names[slot]: n for n, slot in enumerate(variables.slots)},
            "clocks": {"0": 0} | {variables.clock_names[clock]: n for n, clock in enumerate(variables.clocks, 1)},
            "processes": {process.name: n for n, process in enumerate(self.processes)},
            "locations": {
                process.name: {str(n): n for n in range(len(places))}
                for process, places in zip(self.processes, self.places, strict=True)
            },
        }
        return _in_lines(document) + "\n"


def _in_lines(value: object, depth: int = 3) -> str:
    """JSON whose values down to a depth are on lines of their own."""
    opening, closing, parts = "", "", []
    match value:
        case dict():
            opening, closing = "{}"
            parts = [f"{json.dumps(key)}: {_in_lines(inner, depth - 1)}" for key, inner in value.items()]
        case list():
            opening, closing = "[]"
            parts = [_in_lines(inner, depth - 1) for inner in value]
        case _:
            return json.dumps(value)
    junction = ",\n" if depth > 0 or any(isinstance(inner, dict) for inner in value) else ", "
    if not parts or junction == ", ":
        return opening + junction.join(parts) + closing
    return f"{opening}\n{junction.join(parts)}\n{closing}"


class MuntaNames:
    """Names of letters, digits and underscores, each given once."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = set(taken)

    def fresh(self, wanted: str) -> str:
        plain = re.sub(r"[^A-Za-z0-9]+", "_", wanted).strip("_") or "unnamed"
        name, number = plain, 1
        while name in self._taken:
            number += 1
            name = f"{plain}_{number}"
        self._taken.add(name)
        return name
