"""`tachk requirements`: find requirements that contradict each other."""

from __future__ import annotations

import json
from fractions import Fraction
from math import lcm
from pathlib import Path

import click

from tachk.cli import options, trace_options
from tachk.cli.arguments import parse_definitions
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import ReportForm
from tachk.cli.requirements_report import tell, to_json
from tachk.engine.options import Limits
from tachk.logic.durations import scaled
from tachk.recordings.monitors.formulas import NamedFormula, in_trace_units, read_formulas
from tachk.report.plain_console import ReportConsole
from tachk.syntax.formula import Duration, Formula
from tachk.syntax.walk import nodes_of_kind
from tachk.verify.requirements.analysis import analyse


@click.command(name="requirements")
@click.argument("file", metavar="FILE", type=click.Path(), help="A file of formulas and sentences, or a single one.")
@click.option(
    "form",
    "--format",
    type=options.Choice((ReportForm.TEXT, ReportForm.JSON)),
    default=ReportForm.TEXT.value,
    show_default=True,
    help="Form of the report.",
)
@click.option("output", "-o", "--output", metavar="FILE", type=options.type_of_file, help="Write the report to a file.")
@trace_options.definitions
@options.max_seconds("Stop each search after this time; what it was to find out is then not known.")
def command(
    file: str, form: ReportForm, output: Path | None, seconds: float | None, definitions: tuple[str, ...]
) -> None:
    """Examine requirements before there is a model: can all be satisfied, can two deadlines collide, does one follow
    from others, does what one speaks of never happen?

    Exit status: 0 nothing was found, 10 something was, 20 a question has no answer.
    """

    options.finish(lambda: run_requirements(file, form, output, seconds, definitions))


def run_requirements(
    file: str,
    form: ReportForm = ReportForm.TEXT,
    output: Path | None = None,
    seconds: float | None = None,
    definitions: tuple[str, ...] = (),
) -> ExitStatus:
    """Tells what is wrong with a set of requirements.

    Args:
        seconds: for each search.
        definitions: values of names in bounds and conditions, each ``NAME=VALUE``.
    """
    named = read_formulas(file, parse_definitions(definitions))
    unit = _unit(named)
    formulas = [in_trace_units(each.within(()), (), unit) for each in named]
    scale = _scale(formulas)
    whole = [(each.name, scaled(formula, Fraction(scale))) for each, formula in zip(named, formulas, strict=True)]
    analysis = analyse(whole, Limits(seconds=seconds))
    with destination(output) as out:
        if form is ReportForm.JSON:
            print(json.dumps(to_json(analysis, named, unit, scale), indent=2, ensure_ascii=False), file=out)
        else:
            console = ReportConsole(file=out, highlight=False, soft_wrap=True, force_jupyter=False)
            tell(analysis, unit, scale, console)
    if analysis.findings:
        return ExitStatus.NOT_AS_EXPECTED
    return ExitStatus.UNKNOWN if analysis.undecided else ExitStatus.AS_EXPECTED


def _unit(named: tuple[NamedFormula, ...]) -> str:
    """The unit in which times are told: that of the first bound which has one; empty if none has."""
    bounds = (bound.unit for each in named for bound in nodes_of_kind(each.formula, Duration) if bound.value != 0)
    timed = any(each.durations for each in named)
    return next((unit for unit in bounds if unit), "s" if timed else "")


def _scale(formulas: list[Formula]) -> int:
    """By what durations have to be multiplied to be whole numbers."""
    values = (duration.value for formula in formulas for duration in nodes_of_kind(formula, Duration))
    return lcm(*(value.denominator for value in values if isinstance(value, Fraction)))
