"""`tachk report`: write a page that one can hand on."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options


@click.command(name="report")
@click.argument(
    "inputs",
    metavar="[MODEL [QUERY]...] [RESULT.json|PICTURE.svg|TEXT.md]...",
    nargs=-1,
    required=True,
    help="A model file and queries about it; results of tachk verify, sweep, simulate and monitor that were written "
    "with --format json; pictures that tachk has drawn; texts in Markdown. All are shown in the order given.",
)
@click.option(
    "properties",
    "--property",
    metavar="NAME",
    multiple=True,
    help="Check only this property; several can be given.",
)
@options.definitions
@click.option("title", "--title", metavar="TEXT", help="The title; without it the name of the first file.")
@click.option(
    "output", "-o", "--output", metavar="FILE.html", type=options.type_of_file, required=True, help="The page."
)
@options.max_states()
@options.max_memory
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Write one HTML file with verdicts, runs and pictures, which needs no other file and no network.

    MODEL is checked. The page has every answer with the run behind it, as a chart, in words, and to step through with
    the automata beside it, and what is needed to repeat it. Exit status: as of `tachk verify`.
    """
    from tachk.cli.actions.report import ReportArguments, run_report_page

    (request,) = options.distributed(given, ReportArguments)
    options.finish(lambda: run_report_page(request, seconds))
