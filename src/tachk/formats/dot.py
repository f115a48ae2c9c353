"""A network as a drawing for Graphviz: one cluster for each process.

Urgent locations have dashed, committed ones bold outlines; an arrow from a dot leads to the initial location.
"""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.job import check_job
from tachk.formats.exported import Exported, Writing
from tachk.formats.network_text import expression_text, type_text
from tachk.frontend.loaded import LoadedModel
from tachk.model.network import Edge, Location, Network, Process


def export_dot(model: LoadedModel, writing: Writing) -> Exported:
    """A row of `tachk.formats.catalogue`."""
    return Exported(to_dot(model.network))


def to_dot(network: Network) -> str:
    """The text of a .dot file."""
    lines = [
        "digraph network {",
        "    rankdir=TB;",
        '    node [shape=box, style=rounded, fontname="Helvetica", fontsize=11];',
        '    edge [fontname="Helvetica", fontsize=10];',
    ]
    for number, process in enumerate(network.processes):
        lines += _process(number, process, network)
    return "\n".join([*lines, "}"]) + "\n"


def _process(number: int, process: Process, network: Network) -> Iterator[str]:
    check_job()
    yield f"    subgraph cluster_{number} {{"
    yield f"        label={_quoted(process.name)};"
    for place, location in enumerate(process.locations):
        yield f"        p{number}_{place} [{_node(location, process, network)}];"
    yield f"        p{number}_init [shape=point];"
    yield f"        p{number}_init -> p{number}_{process.initial};"
    for edge in process.edges:
        label = _quoted("\n".join(_label(edge, process, network)))
        yield f"        p{number}_{edge.source} -> p{number}_{edge.target} [label={label}];"
    yield "    }"


def _node(location: Location, process: Process, network: Network) -> str:
    lines = [location.name]
    if location.invariant is not None:
        lines.append(expression_text(location.invariant, network, process.name))
    for clock, rate in location.rates:
        name, value = (expression_text(part, network, process.name) for part in (clock, rate))
        lines.append(f"{name}' == {value}")
    style = 'style="rounded,bold", ' if location.committed else 'style="rounded,dashed", ' if location.urgent else ""
    return f"{style}label={_quoted(chr(10).join(lines))}"


def _label(edge: Edge, process: Process, network: Network) -> Iterator[str]:
    if edge.selects:
        yield ", ".join(f"{variable.name} : {type_text(variable.type)}" for variable in edge.selects)
    if edge.guard is not None:
        yield expression_text(edge.guard, network, process.name)
    if edge.synchronisation is not None:
        channel = expression_text(edge.synchronisation.channel, network, process.name)
        yield f"{channel}{edge.synchronisation.direction.value}"
    if edge.updates:
        yield ", ".join(expression_text(update, network, process.name) for update in edge.updates)


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
