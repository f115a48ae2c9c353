"""`tachk synthesize`: find the values of constants for which a property holds."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options
from tachk.cli.reporting import Reporting, WantedAnswer
from tachk.engine.options import Limits


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
    help="Which answer the region is to have.",
)
@options.report("text", "json", "csv")
@click.option(
    "certificates",
    "--certificates",
    metavar="FOLDER",
    type=options.type_of_file,
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
    help="Take the answer for one value of a constant for other values, too, where the constant is proved to be an "
    "upper bound only, or a lower bound only.",
)
@click.option(
    "reuse",
    "--reuse/--no-reuse",
    default=True,
    show_default=True,
    help="Try the run that was found with other values before a search.",
)
def command(**given: Any) -> None:
    """Find the values of constants for which a property holds.

    \b
    tachk synthesize fischer.ta --property mutual_exclusion --over WRITE=1..20,WAIT=1..20

    With -o and a name that ends in .png, .svg or .pdf, tachk draws the region into that file and prints the report.
    Exit status: 0 the region is not empty, 10 it is empty, 20 something is unknown.
    """
    from tachk.cli.actions.synthesize import SynthesizeArguments, run_synthesize

    arguments = options.distributed(given, SynthesizeArguments, Limits, Reporting)
    options.finish(lambda: run_synthesize(*arguments))
