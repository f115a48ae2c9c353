"""The options of `tachk report`."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options


@click.command(name="report", short_help="Check a model and write a page that one can hand on.")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.argument("queries", metavar="[QUERY]...", nargs=-1, required=False, help="Queries.")
@click.option(
    "properties",
    "--property",
    metavar="NAME",
    multiple=True,
    help="Check only this property; several can be given.",
)
@options.definitions
@click.option(
    "pictures",
    "--picture",
    metavar="FILE.svg",
    multiple=True,
    type=options.type_of_file,
    help="Add a picture that tachk has drawn: a heat map, a plot of signals, a chart of a capture.",
)
@click.option("title", "--title", metavar="TEXT", help="The title; without it the name of the model.")
@click.option(
    "output", "-o", "--output", metavar="FILE.html", type=options.type_of_file, required=True, help="The page."
)
@options.max_states()
@options.max_memory
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Check a model and write one HTML file about it, which needs no other file and no network.

    It has every answer with the run behind it, as a chart, in words, and to step through with the automata beside it,
    and what is needed to repeat it. Exit status: as of `tachk verify`.
    """
    from tachk.cli.actions.report_page import Reported, run_report_page

    (asked,) = options.distributed(given, Reported)
    options.finish(lambda: run_report_page(asked, seconds))
