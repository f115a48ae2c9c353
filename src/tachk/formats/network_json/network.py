"""A network as JSON, and back: docs/schema/network.schema.json describes it.

The JSON says everything about a network's behaviour and nothing about where it was written, and equal networks have
equal JSON, so it is also how networks are compared: `same_network`.
"""

from __future__ import annotations

from itertools import islice

from tachk.base.diagnostics.diagnostic import Diagnostic, UsageError
from tachk.base.job import check_job
from tachk.base.words import Direction
from tachk.formats.exported import Exported, Writing
from tachk.formats.network_json.expressions import ExpressionReader, ExpressionWriter
from tachk.formats.network_json.json_lines import json_pieces
from tachk.formats.network_json.types import Json
from tachk.frontend.loaded import LoadedModel
from tachk.model.network import Branching, Chance, Edge, Location, Network, Process, Signal, Synchronisation

FORMAT, VERSION = "tachk network", 1


def network_to_json(network: Network) -> Json:
    """The argument of `json.dumps`."""
    writer = ExpressionWriter(network.lasting)
    variables = [writer.variable(v) for v in network.variables]
    local = [[writer.variable(v) for v in p.variables] for p in network.processes]
    processes = [_process(p, v, writer) for p, v in zip(network.processes, local, strict=True)]
    signals = [{"name": s.name, "expression": writer.expression(s.expression)} for s in network.signals]
    return {
        "format": FORMAT,
        "version": VERSION,
        "time_unit": network.time_unit,
        "constants": [{"name": name, "value": value} for name, value in network.constants],
        "default_priority": network.default_priority,
        "variables": variables,
        "functions": writer.bodies,
        "processes": processes,
        "signals": signals,
    }


def export_json(model: LoadedModel, writing: Writing) -> Exported:
    """A row of `tachk.formats.catalogue`."""
    return Exported(network_to_json_text(model.network))


def network_to_json_text(network: Network) -> str:
    """The JSON of a network, with a line feed at its end."""
    written, pieces = json_pieces(network_to_json(network)), []
    while piece := "".join(islice(written, 10_000)):
        check_job()
        pieces.append(piece)
    return "".join((*pieces, "\n"))


def network_from_json(value: Json) -> Network:
    """The network; ``network_to_json`` of it is ``value`` again. Raises UsageError for anything else."""
    try:
        if value["format"] != FORMAT or value["version"] != VERSION:
            raise UsageError(f"this is not {FORMAT}, version {VERSION}")
        return _network(value)
    except (KeyError, IndexError, TypeError, ValueError, AttributeError) as error:
        raise UsageError(f"this is not a network as docs/schema/network.schema.json describes it: {error}") from error


def same_network(left: Network, right: Network) -> bool:
    """True if two networks are the same, names and documentation included, places in texts left aside."""
    return bool(network_to_json(left) == network_to_json(right))


def _process(process: Process, variables: list[Json], writer: ExpressionWriter) -> Json:
    check_job()
    return {
        "name": process.name,
        "template": process.template,
        "priority": process.priority,
        "initial": process.initial,
        "variables": variables,
        "locations": [_location(place, writer) for place in process.locations],
        "edges": [_edge(edge, writer) for edge in process.edges],
    }


def _location(location: Location, writer: ExpressionWriter) -> Json:
    return {
        "name": location.name,
        "invariant": writer.optional(location.invariant),
        "rates": [
            {"clock": writer.expression(clock), "rate": writer.expression(rate)} for clock, rate in location.rates
        ],
        "urgent": location.urgent,
        "committed": location.committed,
        "doc": location.doc,
        **_chance("exponential_rate", location.exponential_rate, writer),
    }


def _chance(name: str, value: Chance | None, writer: ExpressionWriter) -> dict[str, Json]:
    """A rate or weight, where there is one that can be computed."""
    return {} if value is None or isinstance(value, Diagnostic) else {name: writer.expression(value)}


def _branch(branching: Branching, writer: ExpressionWriter) -> Json:
    return {
        "way": branching.way,
        "selects": branching.selects,
        **_chance("weight", branching.weight, writer),
    }


def _edge(edge: Edge, writer: ExpressionWriter) -> Json:
    selects = [writer.variable(v) for v in edge.selects]
    synchronisation = edge.synchronisation
    return {
        "source": edge.source,
        "target": edge.target,
        "selects": selects,
        "guard": writer.optional(edge.guard),
        "synchronisation": None
        if synchronisation is None
        else {
            "channel": writer.expression(synchronisation.channel),
            "direction": synchronisation.direction.value,
        },
        "updates": writer.expressions(edge.updates),
        "doc": edge.doc,
        **({} if edge.branch is None else {"branch": _branch(edge.branch, writer)}),
    }


def _network(value: Json) -> Network:
    reader = ExpressionReader(value["functions"])
    variables = tuple(reader.variable(v) for v in value["variables"])
    local = [tuple(reader.variable(v) for v in p["variables"]) for p in value["processes"]]
    processes = tuple(
        Process(
            p["name"],
            p["template"],
            tuple(_read_location(place, reader) for place in p["locations"]),
            tuple(_read_edge(edge, reader) for edge in p["edges"]),
            p["initial"],
            own,
            p["priority"],
        )
        for p, own in zip(value["processes"], local, strict=True)
    )
    signals = tuple(Signal(s["name"], reader.expression(s["expression"])) for s in value["signals"])
    constants = tuple((c["name"], c["value"]) for c in value["constants"])
    return Network(processes, variables, value["default_priority"], constants, signals, value["time_unit"])


def _read_location(value: Json, reader: ExpressionReader) -> Location:
    rates = tuple((reader.expression(r["clock"]), reader.expression(r["rate"])) for r in value["rates"])
    invariant = reader.optional(value["invariant"])
    return Location(
        value["name"],
        invariant,
        rates,
        value["urgent"],
        value["committed"],
        value["doc"],
        exponential_rate=reader.optional(value.get("exponential_rate")),
    )


def _read_edge(value: Json, reader: ExpressionReader) -> Edge:
    selects = tuple(reader.variable(v) for v in value["selects"])
    guard = reader.optional(value["guard"])
    synchronisation = None
    if value["synchronisation"] is not None:
        synchronisation = Synchronisation(
            reader.expression(value["synchronisation"]["channel"]), Direction(value["synchronisation"]["direction"])
        )
    updates = reader.expressions(value["updates"])
    branch = value.get("branch")
    return Edge(
        value["source"],
        value["target"],
        selects,
        guard,
        synchronisation,
        updates,
        value["doc"],
        branch=None
        if branch is None
        else Branching(branch["way"], branch["selects"], reader.optional(branch.get("weight"))),
    )
