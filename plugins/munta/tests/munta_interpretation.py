"""A second interpretation of Munta's networks, after Munta's theory ``Simple_Network_Language``.

Written for the tests of the export, which cannot call Munta. Only what tachk writes is read: guards are conjunctions of
comparisons with constants, updates assign constants, formulas are disjunctions of conjunctions.
"""

from __future__ import annotations

import json
import operator
import re
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

from tachk.meaning.dbm import (
    INFINITY,
    Constraint,
    Zone,
    close,
    constrain_all,
    extrapolate_max,
    includes,
    point,
    raw_bound,
    reset,
    up,
)

State = tuple[tuple[int, ...], tuple[int, ...]]
"""The locations, then the variables."""

_COMPARISONS = {"==": operator.eq, "<=": operator.le, ">=": operator.ge, "<": operator.lt, ">": operator.gt}
_ATOM = re.compile(r"(\w+) (==|<=|>=|<|>) (-?\d+)")


@dataclass(frozen=True)
class Edge:
    source: int
    target: int
    conditions: tuple[tuple[int, str, int], ...]
    clocks: tuple[Constraint, ...]
    label: str
    writes: tuple[tuple[int, int], ...]
    resets: tuple[int, ...]


class MuntaInterpretation:
    """A network that was read, with the question that its formula asks."""

    def __init__(self, text: str, renaming: str) -> None:
        document, numbers = json.loads(text), json.loads(renaming)
        self.clocks: dict[str, int] = {name: n for name, n in numbers["clocks"].items() if n}
        self.variables: dict[str, int] = numbers["vars"]
        bounds = re.findall(r"(\w+)\[(-?\d+):(-?\d+)\]", document["vars"])
        assert [name for name, _, _ in bounds] == list(self.variables), "Munta wants the bounds in the order of numbers"
        self.bounds = [(int(low), int(high)) for _, low, high in bounds]
        assert all(low <= 0 <= high for low, high in self.bounds), "Munta's variables begin with 0"
        self.broadcast = set(document["broadcast"])
        self.automata: list[dict[str, Any]] = document["automata"]
        self.edges = [[self._edge(edge) for edge in automaton["edges"]] for automaton in self.automata]
        self.invariants = [
            {node["id"]: self._guard(node["invariant"])[1] for node in automaton["nodes"]}
            for automaton in self.automata
        ]
        self.formula: str = document["formula"].removeprefix("E<> ")
        for automaton, edges in zip(self.automata, self.edges, strict=True):
            assert any(edge.source == automaton["initial"] for edge in edges), "Munta wants an edge to begin with"
            assert len({node["name"] for node in automaton["nodes"]}) == len(automaton["nodes"])

    def _guard(self, text: str) -> tuple[tuple[tuple[int, str, int], ...], tuple[Constraint, ...]]:
        conditions, clocks = [], []
        for part in filter(None, text.split(" && ")):
            match = _ATOM.fullmatch(part)
            assert match, part
            name, comparison, value = match[1], match[2], int(match[3])
            if name in self.variables:
                conditions.append((self.variables[name], comparison, value))
                continue
            assert value >= 0, "Munta compares clocks with natural numbers"
            clock = self.clocks[name]
            if comparison in ("<", "<=", "=="):
                clocks.append((clock, 0, raw_bound(value, comparison == "<")))
            if comparison in (">", ">=", "=="):
                clocks.append((0, clock, raw_bound(-value, comparison == ">")))
        return tuple(conditions), tuple(clocks)

    def _edge(self, given: Mapping[str, Any]) -> Edge:
        conditions, clocks = self._guard(given["guard"])
        writes, resets = [], []
        for name, value in re.findall(r"(\w+) = (-?\d+)", given["update"]):
            if name in self.variables:
                writes.append((self.variables[name], int(value)))
            else:
                assert value == "0", "Munta sets clocks to 0"
                resets.append(self.clocks[name])
        label = given["label"]
        if label[:-1] in self.broadcast and label.endswith("?"):
            assert not clocks, "Munta wants no clock guards where a broadcast is received"
        return Edge(given["source"], given["target"], conditions, clocks, label, tuple(writes), tuple(resets))

    # ---- steps ------------------------------------------------------------------------------------------------------

    @property
    def initial(self) -> State:
        return tuple(automaton["initial"] for automaton in self.automata), (0,) * len(self.variables)

    def _enabled(self, state: State, process: int) -> Iterator[Edge]:
        locations, values = state
        for edge in self.edges[process]:
            if edge.source == locations[process]:
                if all(_COMPARISONS[c](values[v], constant) for v, c, constant in edge.conditions):
                    yield edge

    def transitions(self, state: State) -> Iterator[list[tuple[int, Edge]]]:
        """The edges of transitions in the order in which Munta executes them."""
        processes = range(len(self.automata))
        committed = {p for p in processes if state[0][p] in self.automata[p]["committed"]}
        for taken in self._candidates(state):
            if not committed or committed & {p for p, _ in taken}:
                yield taken

    def _candidates(self, state: State) -> Iterator[list[tuple[int, Edge]]]:
        processes = range(len(self.automata))
        for p in processes:
            for edge in self._enabled(state, p):
                name = edge.label[:-1]
                if not edge.label:
                    yield [(p, edge)]
                elif edge.label.endswith("!"):
                    receiving = [
                        [(q, other) for other in self._enabled(state, q) if other.label == f"{name}?"]
                        for q in processes
                        if q != p
                    ]
                    if name in self.broadcast:
                        for chosen in product(*filter(None, receiving)):
                            yield [(p, edge), *chosen]
                    else:
                        for of_process in receiving:
                            for receiver in of_process:
                                yield [receiver, (p, edge)]

    def successors(self, state: State, zone: Zone) -> Iterator[tuple[State, Zone]]:
        """First a delay, then a transition."""
        delayed = self._inside(state, self._delayed(state, zone))
        if delayed is None:
            return
        for taken in self.transitions(state):
            locations, values = list(state[0]), list(state[1])
            after = constrain_all(delayed, (c for _, edge in taken for c in edge.clocks))
            for process, edge in taken:
                locations[process] = edge.target
                for variable, value in edge.writes:
                    values[variable] = value
            if after is None or not all(lo <= v <= hi for v, (lo, hi) in zip(values, self.bounds, strict=True)):
                continue
            for clock in {clock for _, edge in taken for clock in edge.resets}:
                after = reset(after, clock, 0)
            following = tuple(locations), tuple(values)
            inside = self._inside(following, after)
            if inside is not None:
                yield following, inside

    def _delayed(self, state: State, zone: Zone) -> Zone:
        still = any(place in automaton["urgent"] for place, automaton in zip(state[0], self.automata, strict=True))
        return zone if still else up(zone)

    def _inside(self, state: State, zone: Zone) -> Zone | None:
        return constrain_all(zone, (c for p, place in enumerate(state[0]) for c in self.invariants[p][place]))

    # ---- questions --------------------------------------------------------------------------------------------------

    def holds(self, state: State) -> bool:
        """Whether the formula is true."""
        names = {a["name"]: (p, {n["name"]: n["id"] for n in a["nodes"]}) for p, a in enumerate(self.automata)}

        def location(match: re.Match[str]) -> str:
            process, places = names[match[1]]
            return str(state[0][process] == places[match[2]])

        def comparison(match: re.Match[str]) -> str:
            return str(_COMPARISONS[match[2]](state[1][self.variables[match[1]]], int(match[3])))

        text = re.sub(r"(\w+)\.(\w+)", location, _ATOM.sub(comparison, self.formula))
        text = text.replace("&&", "and").replace("||", "or").replace("!", "not ")
        assert set(re.findall(r"\w+", text)) <= {"True", "False", "and", "or", "not"}, text
        return bool(eval(text))

    def is_reached(self) -> bool:
        """Whether a state of the formula is reachable: a search with Munta's abstraction."""
        dimension = len(self.clocks) + 1
        limits = [0] * dimension
        edges = (edge.clocks for of_process in self.edges for edge in of_process)
        invariants = (i for of_process in self.invariants for i in of_process.values())
        for i, j, raw in (c for conjunction in (*edges, *invariants) for c in conjunction):
            limits[i or j] = max(limits[i or j], abs(raw >> 1))
        found: dict[State, list[Zone]] = {}
        waiting = [(self.initial, point((0,) * (dimension - 1)))]
        while waiting:
            state, zone = waiting.pop()
            if self.holds(state):
                return True
            known = found.setdefault(state, [])
            if not any(includes(old, zone) for old in known):
                known.append(zone)
                waiting += [(s, extrapolate_max(z, limits)) for s, z in self.successors(state, zone)]
        return False

    def is_proof(self, certificate: bytes) -> bool:
        """Whether a certificate shows that no state of the formula is reachable."""
        words = iter(struct.unpack(f">{len(certificate) // 8}q", certificate))
        sizes = (len(self.automata), len(self.clocks) + 1, len(self.variables))
        if (next(words), next(words), next(words), next(words)) != (42, *sizes):
            return False
        dimension = sizes[1]
        held: dict[State, list[Zone]] = {}
        for _ in range(next(words)):
            state = tuple(next(words) for _ in range(sizes[0])), tuple(next(words) for _ in range(sizes[2]))
            count = next(words)
            matrices = ([next(words) for _ in range(dimension**2)] for _ in range(count))
            zones = (close(dimension, (min(raw, INFINITY) for raw in matrix)) for matrix in matrices)
            held.setdefault(state, []).extend(zone for zone in zones if zone is not None)
        assert next(words, None) is None

        def has(state: State, zone: Zone) -> bool:
            return any(includes(one, zone) for one in held.get(state, ()))

        return (
            has(self.initial, point((0,) * (dimension - 1)))
            and not any(self.holds(state) for state in held)
            and all(
                has(*successor)
                for state, zones in held.items()
                for zone in zones
                for successor in self.successors(state, zone)
            )
        )
