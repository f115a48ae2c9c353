"""`tachk check`."""

from __future__ import annotations

from functools import partial

from tachk import api
from tachk.cli.arguments import parse_definitions
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import guarded, print_diagnostics


def run_check(models: tuple[str, ...], definitions: tuple[str, ...]) -> ExitStatus:
    """Reads every model and prints one line about each that has no error."""
    constants = parse_definitions(definitions)
    return worst([guarded(partial(_check, path, constants), path if len(models) > 1 else "") for path in models])


def _check(path: str, constants: dict[str, str]) -> ExitStatus:
    model = api.load(path, **constants)
    print_diagnostics(model.warnings)
    network = model.network
    locations = sum(len(process.locations) for process in network.processes)
    edges = sum(len(process.edges) for process in network.processes)
    counts = (
        (len(network.processes), "process", "processes"),
        (locations, "location", "locations"),
        (edges, "edge", "edges"),
        (len(model.properties), "property", "properties"),
        (len(model.warnings), "warning", "warnings"),
    )
    print(f"{path}: " + ", ".join(f"{n} {one if n == 1 else many}" for n, one, many in counts))
    return ExitStatus.AS_EXPECTED
