"""Symbolic states by names: which process is where, what the variables are, how the clocks lie."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.engine.zone_graph import ZoneGraph
from tachk.meaning import dbm
from tachk.meaning.dbm import INFINITY, LESS_EQUAL_ZERO, Zone
from tachk.meaning.run_view import RunNames, TransitionView
from tachk.model.network import Network


@dataclass(frozen=True, slots=True)
class ZoneState:
    """A node of a zone graph. Two are equal if everything but the number is.

    Attributes:
        number: in the order of the search, from 0.
        locations: process and location, in the order of the processes.
        variables: every slot of every variable with its value.
        constraints: the clock values that are possible, as few constraints as say it; empty for all of them.
        zone: the same as a difference bound matrix.
    """

    number: int = field(compare=False)
    locations: tuple[tuple[str, str], ...]
    variables: tuple[tuple[str, int | bool], ...]
    constraints: tuple[str, ...]
    zone: Zone = field(repr=False)

    def at(self, process: str) -> str:
        """The location of a process. Raises UsageError if there is no such process."""
        known = dict(self.locations)
        if process not in known:
            raise UsageError(f"there is no process `{process}`", f"the processes are {', '.join(known)}")
        return known[process]

    def __str__(self) -> str:
        parts = [", ".join(f"{process}.{location}" for process, location in self.locations)]
        parts += [", ".join(f"{name} = {_value(value)}" for name, value in self.variables)] if self.variables else []
        parts += [", ".join(self.constraints)] if self.constraints else []
        return "; ".join(parts)

    def __repr__(self) -> str:
        return f"<{self.number}: {self}>"

    def _repr_html_(self) -> str:
        return f"<code>{self.number}: {escape(str(self))}</code>"


def _value(value: int | bool) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def as_networkx(network: Network, graph: ZoneGraph) -> Any:
    """The graph as a `networkx.DiGraph` whose nodes are `ZoneState`.

    An edge has ``transitions``, a tuple of texts such as ``press! User: Idle → Idle, press? Lamp: Off → Low``, and
    ``label``, the same as one text. The graph has ``initial`` (a tuple of nodes), ``reason`` and ``exact``, see
    `ZoneGraph`.
    """
    import networkx

    names = RunNames(network)
    clocks = [names.layout.names[slot] for slot in names.layout.clock_slots]
    states = []
    for number, (discrete, zone) in enumerate(graph.nodes):
        snapshot = names.snapshot(discrete)
        states.append(ZoneState(number, snapshot.locations, snapshot.variables, constraint_texts(zone, clocks), zone))
    found = networkx.DiGraph(
        initial=tuple(states[: graph.initial]), reason=graph.reason, exact=graph.exact, time_unit=network.time_unit
    )
    found.add_nodes_from(states)
    transitions: dict[tuple[int, int], list[str]] = {}
    for source, transition, target in graph.edges:
        event = names.event(graph.nodes[source][0], transition)
        transitions.setdefault((source, target), []).append(event_text(event))
    for (source, target), texts in transitions.items():
        found.add_edge(states[source], states[target], transitions=tuple(texts), label="\n".join(texts))
    return found


def event_text(event: TransitionView) -> str:
    return ", ".join(
        f"{f'{event.channel}{move.direction.value} ' if move.direction else ''}{move.process}: "
        f"{move.source} → {move.target}" + "".join(f" [{name} = {value}]" for name, value in move.selects)
        for move in event.moves
    )


def constraint_texts(zone: Zone, clocks: Sequence[str]) -> tuple[str, ...]:
    """The zone in as few constraints as say it: first what is equal, then bounds, then differences.

    Args:
        clocks: the names of the clocks 1, 2, ...
    """
    names = ["0", *clocks]
    first = [_first_equal(zone, clock) for clock in range(zone.dimension)]
    texts = [
        _relation(names[clock], names[first[clock]], "==", dbm.bound_value(zone[clock, first[clock]]))
        for clock in range(1, zone.dimension)
        if first[clock] != clock
    ]
    representatives = [clock for clock in range(zone.dimension) if first[clock] == clock]
    for i, j, raw in _needed(zone, representatives):
        sign = "<" if dbm.is_strict(raw) else "<="
        value = dbm.bound_value(raw)
        if i == 0:
            texts.append(f"{names[j]} {sign.replace('<', '>')} {-value}")
        else:
            texts.append(_relation(names[i], names[j], sign, value))
    return tuple(texts)


def _first_equal(zone: Zone, clock: int) -> int:
    """The first clock from which this one has a fixed distance."""
    for other in range(clock):
        there, back = zone[clock, other], zone[other, clock]
        if there < INFINITY and back < INFINITY and dbm.add(there, back) == LESS_EQUAL_ZERO:
            return other
    return clock


def _needed(zone: Zone, clocks: Sequence[int]) -> Iterator[dbm.Constraint]:
    """The constraints between clocks without fixed distances that do not follow from others; bounds come first."""
    pairs = sorted(
        ((i, j) for i in clocks for j in clocks if i != j), key=lambda pair: (0 not in pair, pair[0] or pair[1])
    )
    for i, j in pairs:
        raw = zone[i, j]
        trivial = i == 0 and raw == LESS_EQUAL_ZERO
        if raw >= INFINITY or trivial:
            continue
        if any(dbm.add(zone[i, k], zone[k, j]) <= raw for k in clocks if k not in (i, j)):
            continue
        yield i, j, raw


def _relation(left: str, right: str, sign: str, value: int) -> str:
    if right == "0":
        return f"{left} {sign} {value}"
    if value == 0:
        return f"{left} {sign} {right}"
    return (
        f"{left} - {right} {sign} {value}"
        if sign != "=="
        else f"{left} == {right} {'+' if value > 0 else '-'} {abs(value)}"
    )
