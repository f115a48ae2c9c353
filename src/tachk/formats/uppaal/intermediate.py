"""UPPAAL's intermediate format: the numbering to which its symbolic traces (`tachk.formats.uppaal.xtr`) refer.

The format is the one that the program ``tracer`` of UPPAAL's open parsing library reads: sections of lines, each
section ended by an empty line. Memory slots, locations and expressions are numbered through; clocks, variables and
locations have numbers of their own besides. Expressions are given as text, so there are no instructions.
"""

from __future__ import annotations

from collections.abc import Iterator

from tachk.formats.edge_text import ALWAYS, edge_text
from tachk.formats.network_text import expression_text
from tachk.model.network import Location, Network
from tachk.model.types import ChannelType, ClockType
from tachk.model.variable_layout import variable_layout

REFERENCE_CLOCK = "t(0)"


def network_to_intermediate(network: Network) -> str:
    """The network in the intermediate format. Edges through branchpoints are one edge each, as in the network."""
    expressions: dict[str, int] = {}

    def number_of(text: str) -> int:
        return expressions.setdefault(text, len(expressions))

    slots = list(_slots(network))
    first_location = len(slots)
    processes, locations, edges = [], [], []
    at = first_location
    for number, process in enumerate(network.processes):
        processes.append(f"{number}:{at + process.initial}:{_word(process.name)}")
        for offset, location in enumerate(process.locations):
            slots.append(f"location:{_kind(location)}:{_word(location.name)}")
            invariant = ALWAYS if location.invariant is None else _text(network, process.name, location)
            locations.append(f"{at + offset}:{number}:{number_of(invariant)}")
        for edge in process.edges:
            said = edge_text(network, process, edge, "=")
            labels = [number_of(text) for text in (said.guard, said.synchronisation, said.updates)]
            places = f"{number}:{at + edge.source}:{at + edge.target}"
            edges.append(f"{places}:{':'.join(map(str, labels))}")
        at += len(process.locations)
    sections = {
        "layout": [f"{number}:{slot}" for number, slot in enumerate(slots)],
        "instructions": [],
        "processes": processes,
        "locations": locations,
        "edges": edges,
        "expressions": [f"{number}:::{text}" for text, number in expressions.items()],
    }
    return "".join("\n".join((name, *lines)) + "\n\n" for name, lines in sections.items())


def _slots(network: Network) -> Iterator[str]:
    """The clocks and variables in the order of their declaration; channels hold nothing."""
    yield f"clock:0:{REFERENCE_CLOCK}"
    layout = variable_layout(network)
    clocks, variables = 1, 0
    for name, leaf, (low, high), initial, meta in zip(
        layout.names, layout.types, layout.ranges, layout.initial, layout.meta, strict=True
    ):
        match leaf:
            case ClockType():
                yield f"clock:{clocks}:{_word(name)}"
                clocks += 1
            case ChannelType():
                continue
            case _:
                yield f"{'meta' if meta else 'var'}:{low}:{high}:{initial}:{variables}:{_word(name)}"
                variables += 1


def _kind(location: Location) -> str:
    return "committed" if location.committed else "urgent" if location.urgent else ""


def _text(network: Network, process: str, location: Location) -> str:
    assert location.invariant is not None
    return " ".join(expression_text(location.invariant, network, process).split())


def _word(name: str) -> str:
    """A name without blanks, at which readers of the format stop."""
    return "".join(name.split())
