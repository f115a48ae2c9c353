"""`tachk sentences`: list the sentences that express properties."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli import options
from tachk.cli.exit_status import ExitStatus

if TYPE_CHECKING:
    from tachk.logic.patterns import Pattern


@click.command(name="sentences")
@click.argument("words", metavar="WORD...", nargs=-1, help="List only sentences that contain these words.")
def command(words: tuple[str, ...]) -> None:
    """List the sentences that express properties, each with its formula and its meaning."""

    options.finish(lambda: run_sentences(words))


def run_sentences(words: tuple[str, ...]) -> ExitStatus:
    """Prints the catalogue, or the patterns in which every word occurs."""
    from tachk.logic.patterns import CATALOGUE

    wanted = [word.lower() for word in words]
    found = False
    for family in CATALOGUE:
        chosen = [pattern for pattern in family.patterns if all(word in _searched(pattern) for word in wanted)]
        if not chosen:
            continue
        print(f"\n{family.title}" if found else family.title)
        found = True
        for pattern in chosen:
            print(f"\n  {pattern.name}: {pattern.meaning}")
            print(f"      {pattern.example}")
            print(f"      {pattern.formula}")
    if not found:
        raise UsageError(f"no pattern has the word {' '.join(words)}", "tachk sentences lists them all")
    return ExitStatus.AS_EXPECTED


def _searched(pattern: Pattern) -> str:
    return f"{pattern.name} {pattern.meaning} {pattern.example} {pattern.formula}".lower()
