"""Symbolic traces in UPPAAL's XML form (``verifyta -X``): the parts of the system with names, and one node a state."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement, tostring

from tachk.formats.edge_text import edge_text
from tachk.formats.network_text import expression_text
from tachk.meaning.dbm import Zone, bound_value, is_strict
from tachk.meaning.zones_of_run import zones_of_run
from tachk.model.network import Network, Process
from tachk.model.run import TimedTrace, Transition
from tachk.model.types import ChannelType, ClockType
from tachk.model.variable_layout import variable_layout

_GLOBAL = "sys"


def run_to_trace_xml(network: Network, run: TimedTrace) -> str:
    """The run as a symbolic trace: its transitions, with all valuations that can take them."""
    layout = variable_layout(network)
    value_slots = [slot for slot, leaf in enumerate(layout.types) if not isinstance(leaf, ClockType | ChannelType)]
    variables = [_identifier(layout.names[slot], network) for slot in value_slots]
    clocks = [f"{_GLOBAL}.#t(0)", *(_identifier(layout.names[slot], network) for slot in layout.clock_slots)]
    root = Element("trace", initial_node="State1", trace_options="symbolic")
    _system(root, network, clocks, variables)
    taken = [step for step in run.steps if step.transition is not None]
    states = [run.initial.discrete, *(step.state.discrete for step in taken)]
    for number, (state, zone) in enumerate(zip(states, zones_of_run(network, run), strict=True), 1):
        here = zip(network.processes, state.locations, strict=True)
        names = " ".join(f"{process.name}.{process.locations[place].name}" for process, place in here)
        SubElement(root, "location_vector", id=f"LocVec{number}", locations=f"{names} ")
        vector = SubElement(root, "variable_vector", id=f"varvec.{number}")
        for name, slot in zip(variables, value_slots, strict=True):
            SubElement(vector, "variable_state", variable=name, value=str(state.values[slot]))
        SubElement(
            root,
            "node",
            id=f"State{number}",
            location_vector=f"LocVec{number}",
            dbm_instance=f"DBM{number}",
            variable_vector=f"varvec.{number}",
        )
        _zone(root, number, clocks, zone)
    for number, step in enumerate(taken, 1):
        assert step.transition is not None
        edges = f"{' '.join(_edges(network, step.transition))} "
        SubElement(root, "transition", {"from": f"State{number}", "to": f"State{number + 1}", "edges": edges})
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="unicode") + "\n"


def _system(root: Element, network: Network, clocks: Iterable[str], variables: Iterable[str]) -> None:
    system = SubElement(root, "system")
    for kind, identifiers in (("clock", clocks), ("variable", variables)):
        for identifier in identifiers:
            if identifier.startswith(f"{_GLOBAL}."):
                SubElement(system, kind, name=identifier.removeprefix(f"{_GLOBAL}."), id=identifier)
    for process in network.processes:
        node = SubElement(system, "process", id=process.name, name=process.name)
        for kind, identifiers in (("clock", clocks), ("variable", variables)):
            for identifier in identifiers:
                if identifier.startswith(f"{process.name}."):
                    SubElement(node, kind, name=identifier.removeprefix(f"{process.name}."), id=identifier)
        _automaton(node, network, process)


def _automaton(node: Element, network: Network, process: Process) -> None:
    for location in process.locations:
        place = SubElement(node, "location", id=f"{process.name}.{location.name}", name=location.name)
        if location.invariant is not None:
            place.text = expression_text(location.invariant, network, process.name)
    for number, edge in enumerate(process.edges, 1):
        said = edge_text(network, process, edge, "=")
        drawn = SubElement(
            node,
            "edge",
            {
                "id": f"{process.name}.Edge{number}",
                "from": f"{process.name}.{process.locations[edge.source].name}",
                "to": f"{process.name}.{process.locations[edge.target].name}",
            },
        )
        for label, text in (("guard", said.guard), ("sync", said.synchronisation), ("update", said.updates)):
            SubElement(drawn, label).text = text


def _zone(root: Element, number: int, clocks: list[str], zone: Zone) -> None:
    bounds = SubElement(root, "dbm_instance", id=f"DBM{number}")
    for i, j, raw in zone.constraints():
        SubElement(
            bounds,
            "clockbound",
            clock1=clocks[i],
            clock2=clocks[j],
            bound=str(bound_value(raw)),
            comp="<" if is_strict(raw) else "<=",
        )


def _edges(network: Network, transition: Transition) -> Iterable[str]:
    return (f"{network.processes[p.process].name}.Edge{p.edge + 1}" for p in transition.participants)


def _identifier(name: str, network: Network) -> str:
    local = any(name.startswith(f"{process.name}.") for process in network.processes)
    return name if local else f"{_GLOBAL}.{name}"
