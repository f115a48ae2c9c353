"""The options of `tachk sentences`."""

from __future__ import annotations

import click

from tachk.cli import options


@click.command(name="sentences", short_help="List the sentences that properties can be.")
@click.argument("words", metavar="WORD...", nargs=-1, help="Only patterns with these words.")
def command(words: tuple[str, ...]) -> None:
    """List the sentences in which properties can be written, each with its formula and its meaning."""
    from tachk.cli.actions.sentences import run_sentences

    options.finish(lambda: run_sentences(words))
