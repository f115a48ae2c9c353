"""`tachk synthesize`: find the values of constants for which a property holds."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import limited
from tachk.base.optional_packages import require
from tachk.base.records import dataclass, replace
from tachk.cli import options
from tachk.cli.destination import destination
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.cli.reporting import Reporting, WantedAnswer
from tachk.cli.terminal import can_rewrite_lines
from tachk.engine.options import Limits
from tachk.model.grid import Grid, grid_of

if TYPE_CHECKING:
    from tachk.api import model as api
    from tachk.report.region.synthesis import Synthesis
    from tachk.verify.synthesis.region import Region


@click.command(name="synthesize")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.argument("query", metavar="[QUERY]", required=False, help="A query, in place of --property.")
@click.option("property", "--property", metavar="NAME", help="The property of the model.")
@click.option(
    "over",
    "--over",
    metavar="NAME=LOW..HIGH[:STEP],...",
    multiple=True,
    help="The constants to vary and their values; -D with several values does the same.",
)
@options.definitions
@click.option(
    "wanted",
    "--answer",
    type=options.Choice(WantedAnswer),
    default=WantedAnswer.HOLDS.value,
    show_default=True,
    help="Find values for which the property holds, or fails.",
)
@options.report("text", "json", "csv")
@click.option(
    "picture",
    "--plot",
    metavar="FILE",
    type=options.written_file,
    help="Draw the region into this .svg, .png or .pdf file.",
)
@click.option(
    "certificates",
    "--certificates",
    metavar="FOLDER",
    type=options.written_file,
    help="Write a proof for each corner at which something is never reached into this folder. `tachk certify` checks "
    "them without a search.",
)
@click.option("every_corner", "--all-corners", is_flag=True, help="List every corner of the border.")
@options.max_states("; its values are unknown then")
@options.max_seconds("Stop after this time, which all searches share. Cells without an answer by then are unknown.")
@options.max_memory
@click.option(
    "infer",
    "--infer/--no-infer",
    default=True,
    show_default=True,
    help="Skip values that monotonicity decides: where a constant is proved to be an upper or a lower bound only.",
)
@click.option(
    "reuse",
    "--reuse/--no-reuse",
    default=True,
    show_default=True,
    help="Try earlier counterexamples before a search.",
)
def command(**given: Any) -> None:
    """Find the values of constants for which a property holds.

    \b
    tachk synthesize fischer.ta --property mutual_exclusion --over WRITE=1..20,WAIT=1..20

    Exit status: 0 the region is not empty, 10 it is empty, 20 something is unknown.
    """

    arguments = distributed(given, SynthesizeArguments, Limits, Reporting)
    options.finish(lambda: run_synthesize(*arguments))


_PICTURES = (".png", ".svg", ".pdf")
"""Endings with which -o meant the picture in version 0.2."""


@dataclass(frozen=True, slots=True)
class SynthesizeArguments:
    """Arguments of `tachk synthesize`.

    Attributes:
        over: the constants with their ranges.
        max_memory: such as ``2G``.
        certificates: the folder for the proofs of corners.
        picture: the file for a picture of the region.
    """

    model: str
    query: str | None = None
    property: str | None = None
    over: tuple[str, ...] = ()
    definitions: tuple[str, ...] = ()
    wanted: WantedAnswer = WantedAnswer.HOLDS
    every_corner: bool = False
    max_memory: str | None = None
    infer: bool = True
    reuse: bool = True
    certificates: Path | None = None
    picture: Path | None = None


def run_synthesize(
    arguments: SynthesizeArguments, limits: Limits = Limits(), reporting: Reporting = Reporting()
) -> ExitStatus:
    from tachk.api import model as api
    from tachk.cli.arguments import parse_size, split_definitions

    if (arguments.query is None) is (arguments.property is None):
        raise UsageError("a region is that of one property", "give --property NAME, or a query behind the model")
    constants, several = split_definitions(arguments.definitions)
    grid = grid_of((*arguments.over, *several), "--over")
    twice = constants.keys() & set(grid.names)
    if twice:
        raise UsageError(f"{min(twice)} is set by -D and by --over", "leave out one of them")
    if arguments.max_memory is not None:
        limits = replace(limits, memory_bytes=parse_size(arguments.max_memory))
    picture = arguments.picture
    if picture is None and reporting.output is not None and reporting.output.suffix.lower() in _PICTURES:
        picture, reporting = reporting.output, replace(reporting, output=None)
        print(f"note: `-o {picture}` is now `--plot {picture}`; -o is the file of the report", file=sys.stderr)
    if picture is not None:
        require("matplotlib")
    with limited(limits.seconds):
        with limited(memory=limits.memory_bytes):
            model = api.load(arguments.model, **constants)
        print_diagnostics((*model.refusals, *model.warnings))
        found = _found(model, arguments, grid, limits, reporting)
    if picture is not None:
        found.plot(picture)
    if arguments.certificates is not None:
        written = found.certificates(arguments.certificates)
        print(f"{arguments.certificates}: {len(written)} proof{'s' * (len(written) != 1)}", file=sys.stderr)
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None:
            out.write(_report(found, arguments, reporting.form, picture))
    return _status(found.region)


def _found(
    model: api.Model, arguments: SynthesizeArguments, grid: Grid, limits: Limits, reporting: Reporting
) -> Synthesis:
    from tachk.cli.progress import ProgressLine
    from tachk.verify.verdict import Answer

    progress = ProgressLine() if can_rewrite_lines(sys.stderr) and not reporting.quiet else None
    try:
        return model.synthesize(
            *([] if arguments.query is None else [arguments.query]),
            over=grid,
            property=arguments.property,
            answer=Answer(arguments.wanted.value),
            limits=limits,
            progress=progress,
            infer=arguments.infer,
            reuse=arguments.reuse,
            certify=arguments.certificates is not None,
        )
    finally:
        if progress is not None:
            progress.clear()


def _report(found: Synthesis, arguments: SynthesizeArguments, form: str, picture: Path | None) -> str:
    if form == "json":
        from tachk.report.json_text import json_text

        return json_text(found.to_dict())
    if form == "csv":
        from tachk.report.region.json import region_to_csv

        return region_to_csv(found.region)
    written = f"written: {picture}\n" if picture else ""
    return found.to_text(arguments.every_corner) + written


def _status(region: Region) -> ExitStatus:
    if region.interrupted:
        return ExitStatus.INTERRUPTED
    if region.unknown:
        return ExitStatus.UNKNOWN
    return ExitStatus.AS_EXPECTED if region.holding else ExitStatus.NOT_AS_EXPECTED
