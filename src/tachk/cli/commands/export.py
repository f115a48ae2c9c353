"""`tachk export`: write a model for UPPAAL, TChecker, Munta or Graphviz, or as a unit (FMU)."""

from __future__ import annotations

import re
import sys
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.whole_files import write_whole
from tachk.cli import options
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.formats.catalogue import EXPORT_FORMATS, export_model, format_of
from tachk.formats.exported import Exported, Writing

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
    from tachk.api import model as api
    from tachk.cli.arguments import parse_definitions
    from tachk.simulation.fmi.archive import write_unit
    from tachk.simulation.fmi.description import FmiVersion
    from tachk.simulation.fmi.unit import closed_unit, open_unit

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


_UNIT = "fmu"
"""Not one of the formats of texts: a unit for co-simulation."""


@click.command(name="export")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.option("output", "-o", "--output", metavar="FILE", type=options.type_of_file, help="The file to write.")
@click.option(
    "--format",
    type=click.Choice([*EXPORT_FORMATS, _UNIT]),
    help="The format; by default the one that the ending of FILE stands for.",
)
@options.definitions
@click.option("--explain", is_flag=True, help="Print what is written differently than in the model, and where.")
@click.option("--keep-names", is_flag=True, help="Keep names that some version of UPPAAL refuses.")
@click.option(
    "--observers/--no-observers",
    default=True,
    show_default=True,
    help="Write temporal properties as observer automata, or as comments.",
)
@click.option("--fmi", type=click.Choice(["2", "3"]), help="The version of FMI of a unit; 3 by default.")
@click.option("--processes", metavar="NAMES", help="Of a unit: only these processes or templates, with commas between.")
@options.max_seconds()
def command(
    seconds: float | None, output: Path | None, format: str | None, fmi: str | None, processes: str | None, **given: Any
) -> None:
    """Write a model for UPPAAL, TChecker, Munta, Graphviz or other programs, and its queries in a file beside it.

    With --format fmu it becomes a unit for co-simulation by the standard FMI.
    """
    if format == _UNIT or (format is None and output is not None and output.suffix.lower() == f".{_UNIT}"):
        options.finish(lambda: run_export_unit(output=output, fmi=fmi or "3", processes=processes, **given), seconds)
        return

    for_unit = tuple(name for name, value in (("--fmi", fmi), ("--processes", processes)) if value is not None)
    options.finish(lambda: run_export(output=output, format=format, for_unit=for_unit, **given), seconds)


def run_export(
    *,
    model: str,
    output: Path | None,
    format: str | None,
    definitions: tuple[str, ...],
    explain: bool,
    keep_names: bool,
    observers: bool,
    for_unit: tuple[str, ...] = (),
) -> ExitStatus:
    """Writes a model in another format, with its queries beside it where the format has no place for them.

    Args:
        format: without it, what the ending of the output says.
        explain: tell what is written differently, and where.
        for_unit: options that were given and are for units only. Raises UsageError if there are any.
    """
    from tachk.api import model as api
    from tachk.cli.arguments import parse_definitions

    if for_unit:
        raise UsageError(f"{for_unit[0]} goes with --format fmu")
    constants = parse_definitions(definitions)
    wanted = format or ("xta" if output is None else format_of(output))
    source = api.load(model, **constants)
    print_diagnostics(source.warnings)
    exported = export_model(source.loaded, wanted, Writing(tuple(constants), not keep_names, observers))
    write_exported(exported, output)
    if explain:
        _explain(exported)
    return ExitStatus.AS_EXPECTED


def write_exported(exported: Exported, output: Path | None) -> None:
    """Writes the file and its side files; without a name only the text, to standard output."""
    if output is None:
        sys.stdout.write(exported.text)
    else:
        write_files(files_of(exported, output))


def files_of(exported: Exported, output: Path) -> dict[Path, str]:
    """The file and its side files, each with its content."""
    return {output: exported.text} | ({output.with_suffix(".q"): exported.queries} if exported.queries else {})


def write_files(files: Mapping[Path, str]) -> None:
    """Writes files and says which."""
    for path, text in files.items():
        write_whole(path, text)
    print(f"written: {', '.join(map(str, files))}")


def _explain(exported: Exported) -> None:
    """Prints each construct that was written differently, with its place, then the number of each kind."""
    for step in exported.steps:
        print(step, file=sys.stderr)
    counts = Counter(step.kind for step in exported.steps)
    summary = ", ".join(f"{kind} {count}" for kind, count in counts.items()) or "nothing was written differently"
    print(f"expanded: {summary}", file=sys.stderr)
