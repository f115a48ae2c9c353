"""`tachk sentences`: list the sentences that express properties."""

from __future__ import annotations

import click

from tachk.cli import options


@click.command(name="sentences")
@click.argument("words", metavar="WORD...", nargs=-1, help="List only sentences that contain these words.")
def command(words: tuple[str, ...]) -> None:
    """List the sentences that express properties, each with its formula and its meaning."""
    from tachk.cli.actions.sentences import run_sentences

    options.finish(lambda: run_sentences(words))
