"""`tachk export --format fmu`."""

from __future__ import annotations

import re
from pathlib import Path

from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.arguments import parse_definitions
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.simulation.fmi.archive import write_unit
from tachk.simulation.fmi.description import FmiVersion
from tachk.simulation.fmi.unit import closed_unit, open_unit

_NAMES = re.compile(r"(?:\([^)]*\)|[^,()])+")
"""Parts between commas, but not those in parentheses: `Link(0, 1),Client`."""


def run_export_unit(
    *,
    model: str,
    output: Path | None,
    fmi: str,
    processes: str | None,
    definitions: tuple[str, ...],
    explain: bool,
    keep_names: bool,
    observers: bool,
) -> ExitStatus:
    """Writes a model as a unit for co-simulation.

    Args:
        processes: the names of those that are in it, with commas between; by default all.
        explain, keep_names, observers: for other formats; a unit has the model as it is.
    """
    if output is None:
        raise UsageError("a unit is a file of its own", "name it with -o FILE.fmu")
    if explain or keep_names or not observers:
        raise UsageError("--explain, --keep-names and --no-observers are for texts, not for units")
    source = api.load(model, **parse_definitions(definitions))
    print_diagnostics((*source.refusals, *source.warnings))
    version, name = FmiVersion(fmi), Path(model).stem
    if processes is None:
        unit = closed_unit(source.network, name)
    else:
        names = [part.strip() for part in _NAMES.findall(processes)]
        unit = open_unit(source.network, names, name, clocks=version is FmiVersion.THREE)
    write_unit(unit, version, output)
    print(f"written: {output}, FMI {fmi}.0, {len(unit.variables)} variables")
    return ExitStatus.AS_EXPECTED
