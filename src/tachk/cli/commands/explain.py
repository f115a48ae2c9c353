"""`tachk explain`: explain a message, a formula or a sentence."""

from __future__ import annotations

import difflib
import re
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING

import click

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.cli import options
from tachk.cli.exit_status import ExitStatus

if TYPE_CHECKING:
    from tachk.logic.patterns import Pattern
    from tachk.recordings.monitors.formulas import NamedFormula
    from tachk.syntax.formula import Formula


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
    looks ahead, and whether all its intervals begin at 0.
    """
    if sentences:
        options.finish(lambda: run_sentences(subjects), seconds)
    if not subjects:
        raise click.UsageError("Missing argument 'CODE|FORMULA|FILE'.")
    if len(subjects) > 1:
        raise click.UsageError(f"Got unexpected extra arguments ({' '.join(subjects[1:])})")
    options.finish(lambda: run_explain(subjects[0]), seconds)


_INSTANTS = "instants  what is true for no time only, such as in a committed location of a model, does not count"


def run_explain(what: str) -> ExitStatus:
    """Prints the meaning of the code of a message, of a formula, a sentence or the properties of a file."""
    from tachk.recordings.monitors.formulas import read_formulas

    if re.fullmatch(r"[A-Za-z]+[0-9]+|[A-Za-z]\w?", what):
        print(_message(what))
        return ExitStatus.AS_EXPECTED
    formulas = read_formulas(what)
    for number, named in enumerate(formulas):
        if number:
            print()
        if len(formulas) > 1:
            print(f"{named.name}: {named.title}" if named.title else named.name)
        for line in _lines(named):
            print(line)
    return ExitStatus.AS_EXPECTED


def _message(code: str) -> str:
    from tachk.base.diagnostics.explanation import all_explanations, explain

    text = explain(code)
    if text is None:
        close = difflib.get_close_matches(code.upper(), all_explanations(), n=3)
        help = f"did you mean {' or '.join(close)}?" if close else "a code is a letter and four digits, such as E0101"
        raise UsageError(f"no message has the code {code}", help)
    return text


def _lines(named: NamedFormula) -> list[str]:
    from tachk.logic.fragment import outside_fragment
    from tachk.logic.simplify import simplify
    from tachk.syntax.formula import Duration
    from tachk.syntax.formulas.printer import print_formula
    from tachk.syntax.walk import nodes_of_kind

    lines = [f"sentence  {named.sentence}"] if named.sentence else []
    lines.append(f"formula   {named.text}")
    named = named.within(())
    formula = named.formula
    if (simpler := simplify(formula)) != formula:
        lines.append(f"simpler   {print_formula(simpler)}")
    try:
        formula, unit = _resolved(named)
        lines.append(f"horizon   {_horizon(formula, unit)}")
    except InputError as error:
        lines.append(f"horizon   not known: {error.diagnostics[0].message}")
    lines.append(_INSTANTS)
    offence = outside_fragment(formula)
    if offence is None:
        lines.append("STL_lb=0  yes: every interval begins at 0, and only an outermost G has no end")
    else:
        lines.append(f"STL_lb=0  no, because of {print_formula(offence.formula)}: {offence.reason}")
    if all(isinstance(duration.value, Fraction) for duration in nodes_of_kind(formula, Duration)):
        lines.append(f"observer  {_observer(formula)}")
    return lines


def _observer(formula: Formula) -> str:
    """The size of the observer automaton of the formula. It does not depend on the unit of time, which is taken small
    enough for all bounds."""
    from tachk.logic.durations import scaled
    from tachk.logic.observer.construction import NoObserver, build_observer
    from tachk.syntax.ast import BuiltinType, VariableDeclaration
    from tachk.syntax.formula import Duration
    from tachk.syntax.walk import nodes_of_kind

    values = [duration.value for duration in nodes_of_kind(formula, Duration) if isinstance(duration.value, Fraction)]
    scale = lcm(*(value.denominator for value in values))
    try:
        template = build_observer(scaled(formula, Fraction(scale)), "Observer").template
    except NoObserver as reason:
        return f"none: {reason.reason}"
    names = ", ".join(location.name.name for location in template.locations)
    clocks = sum(
        len(declaration.declarators)
        for declaration in template.declarations
        if isinstance(declaration, VariableDeclaration)
        and declaration.type is not None
        and declaration.type.base == BuiltinType(declaration.span, "clock")
    )
    return f"{len(template.locations)} locations ({names}), {clocks} {'clock' if clocks == 1 else 'clocks'}"


def _resolved(named: NamedFormula) -> tuple[Formula, str]:
    """The formula with numbers as bounds, and their unit, empty where it is not known."""
    from tachk.logic.durations import resolve
    from tachk.recordings.monitors.given_constants import constants_by_name
    from tachk.syntax.formula import Duration
    from tachk.syntax.walk import nodes_of_kind

    unit = named.unit
    if not unit:
        given = {bound.unit for bound in nodes_of_kind(named.formula, Duration) if bound.value != 0}
        unit = next(iter(given)) if len(given) == 1 else "s" if "" not in given or named.durations else ""
    formula = resolve(named.formula, constants_by_name(named.numbers(unit or "s" if named.durations else unit)), unit)
    return formula, unit


def _horizon(formula: Formula, unit: str) -> str:
    from tachk.logic.horizon import horizon

    reach = horizon(formula)
    if reach is None:
        return "none: the verdict can stay open as long as the run goes on"
    return f"decided after {_time(reach, unit)}" if reach else "decided at once"


def _time(reach: Fraction, unit: str) -> str:
    from tachk.syntax.formulas.printer import print_number

    amount, _, name = unit.rpartition(" ")
    if not name:
        return f"{print_number(reach)} time unit{'' if reach == 1 else 's'}"
    return f"{print_number(reach * Fraction(amount or 1))} {name}"


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
