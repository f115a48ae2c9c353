"""`tachk requirements`: find requirements that contradict each other."""

from __future__ import annotations

from pathlib import Path

import click

from tachk.cli import options, trace_options


@click.command(name="requirements")
@click.argument("file", metavar="FILE", type=click.Path(), help="A file of formulas and sentences, or a single one.")
@click.option(
    "form",
    "--format",
    type=click.Choice(("text", "json")),
    default="text",
    show_default=True,
    help="Form of the report.",
)
@click.option("output", "-o", "--output", metavar="FILE", type=options.type_of_file, help="Write the report to a file.")
@trace_options.definitions
@options.max_seconds("Stop each search after this time; what it was to find out is then not known.")
def command(file: str, form: str, output: Path | None, seconds: float | None, definitions: tuple[str, ...]) -> None:
    """Examine requirements before there is a model: can all be satisfied, can two deadlines collide, does one follow
    from others, is a trigger impossible?

    Exit status: 0 nothing was found, 10 something was, 20 a question has no answer.
    """
    from tachk.cli.actions.requirements import run_requirements

    options.finish(lambda: run_requirements(file, form, output, seconds, definitions))
