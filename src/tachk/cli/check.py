"""`tachk check`."""

from __future__ import annotations

from functools import partial

from tachk import api
from tachk.cli.arguments import parse_definitions
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import guarded, print_diagnostics
from tachk.diagnostics.diagnostic import Severity
from tachk.export.portability import Version, portability


def run_check(models: tuple[str, ...], definitions: tuple[str, ...], version: str | None = None) -> ExitStatus:
    """Reads every model and prints one line about each that has no error.

    Args:
        version: of UPPAAL; report also what it would refuse or treat otherwise.
    """
    constants = parse_definitions(definitions)
    wanted = None if version is None else Version(version)
    return worst(
        [guarded(partial(_check, path, constants, wanted), path if len(models) > 1 else "") for path in models]
    )


def _check(path: str, constants: dict[str, str], version: Version | None) -> ExitStatus:
    model = api.load(path, **constants)
    print_diagnostics((*model.refusals, *model.warnings))
    if model.refusals:
        return ExitStatus.UNSUPPORTED
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
    return ExitStatus.AS_EXPECTED if version is None else _check_portability(path, model, version)


def _check_portability(path: str, model: api.Model, version: Version) -> ExitStatus:
    found = portability(model.loaded, version)
    print_diagnostics(found)
    refused = sum(diagnostic.severity is Severity.ERROR for diagnostic in found)
    print(f"{path}: {version.full_name} would refuse {refused}, treat otherwise {len(found) - refused}")
    return ExitStatus.NOT_AS_EXPECTED if refused else ExitStatus.AS_EXPECTED
