"""`tachk explain`: explain a message, a formula or a sentence."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli import options
from tachk.cli.exit_status import ExitStatus

if TYPE_CHECKING:
    from tachk.logic.patterns import Pattern


@click.command(name="explain")
@click.argument(
    "subjects",
    metavar="CODE|FORMULA|FILE",
    type=click.Path(),
    nargs=-1,
    help="The code of a message, such as E0201; a formula or sentence; or a file with formulas or sentences.",
)
@click.option(
    "sentences",
    "--sentences",
    is_flag=True,
    help="List the sentences that express properties; with words behind it, those that contain them.",
)
@options.max_seconds()
def command(subjects: tuple[str, ...], sentences: bool, seconds: float | None) -> None:
    """Explain a message of tachk, or a property that is written as a formula or a sentence.

    For a message: what it means, an example, how to mend it. For a property: its formula in canonical form, how far it
    looks ahead, and the automaton that observes it. Without an argument: the codes of all messages.
    """
    if sentences:
        options.finish(lambda: run_sentences(subjects), seconds)
    if not subjects:
        options.finish(run_codes, seconds)
    if len(subjects) > 1:
        raise click.UsageError(f"Got unexpected extra arguments ({' '.join(subjects[1:])})")
    options.finish(lambda: run_explain(subjects[0]), seconds)


def run_explain(what: str) -> ExitStatus:
    """Prints the meaning of the code of a message, of a formula, a sentence or the properties of a file."""
    from tachk.base.diagnostics.explanation import CODE, message_text

    if CODE.fullmatch(what):
        print(message_text(what))
        return ExitStatus.AS_EXPECTED
    from tachk.recordings.monitors.formulas import read_formulas
    from tachk.report.formula_lines import formula_lines

    formulas = read_formulas(what)
    for number, named in enumerate(formulas):
        if number:
            print()
        if len(formulas) > 1:
            print(f"{named.name}: {named.title}" if named.title else named.name)
        for line in formula_lines(named):
            print(line)
    return ExitStatus.AS_EXPECTED


def run_codes() -> ExitStatus:
    """Prints the code of each message with its title."""
    from tachk.base.diagnostics.explanation import all_explanations

    for code, explanation in sorted(all_explanations().items()):
        print(f"{code}  {explanation.title}")
    return ExitStatus.AS_EXPECTED


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
        raise UsageError(f"no pattern has the word {' '.join(words)}", "tachk explain --sentences lists them all")
    return ExitStatus.AS_EXPECTED


def _searched(pattern: Pattern) -> str:
    return f"{pattern.name} {pattern.meaning} {pattern.example} {pattern.formula}".lower()
