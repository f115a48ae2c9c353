"""`tachk diff`: show how the behaviour of two models differs."""

from __future__ import annotations

import click

from tachk.cli import options


@click.command(name="diff")
@click.argument("before", metavar="A", type=click.Path(), help="A model.")
@click.argument("after", metavar="B", type=click.Path(), help="The same model, changed.")
@options.definitions
@options.max_seconds()
def command(before: str, after: str, definitions: tuple[str, ...], seconds: float | None) -> None:
    """Show how the behaviour of two models differs. Layout, comments and most order do not count.

    Exit status: 0 no difference, 1 some difference.
    """
    from tachk.cli.actions.diff import run_diff

    options.finish(lambda: run_diff(before, after, definitions), seconds)
