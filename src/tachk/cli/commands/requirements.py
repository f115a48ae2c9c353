"""`tachk requirements`: find requirements that contradict each other."""

from __future__ import annotations

import json
from fractions import Fraction
from math import lcm
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tachk.cli import options, trace_options
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus
from tachk.engine.options import Limits

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from tachk.recordings.monitors.formulas import NamedFormula
    from tachk.syntax.formula import Formula
    from tachk.verify.requirements.analysis import RequirementAnalysis, RequirementFinding, WitnessMoment


# ---- for people -----------------------------------------------------------------------------------------------------


def print_analysis(analysis: RequirementAnalysis, unit: str, scale: int, console: Console) -> None:
    total = len(analysis.requirements)
    console.print(f"{total} requirement{'s' if total != 1 else ''} about {', '.join(analysis.signals) or 'nothing'}")
    for finding in analysis.findings:
        console.print(f"\n{_sentence(finding)}", markup=False)
        if finding.run and finding.run[0].values:
            console.print(_table(finding.run, unit, scale))
    if analysis.undecided:
        console.print()
    for undecided in analysis.undecided:
        console.print(f"not known: {undecided}", markup=False)
    if not analysis.findings and not analysis.undecided:
        console.print("\nAll can be satisfied, whatever has happened so far; none is redundant or vacuous.")


def _sentence(finding: RequirementFinding) -> str:
    from tachk.verify.requirements.analysis import FindingKind

    names, by = _listed(finding.names), _listed(finding.by) if finding.by else ""
    match finding.kind:
        case FindingKind.INCONSISTENT:
            return f"inconsistent: no run satisfies {names} for ever"
        case FindingKind.COLLIDING:
            return f"colliding: {names}. This run has broken nothing yet, and nothing can save it:"
        case FindingKind.REDUNDANT:
            return f"redundant: {names} follows from {by}" if by else f"redundant: {names} always holds"
        case FindingKind.VACUOUS:
            reason = f" if {by} {'hold' if len(finding.by) > 1 else 'holds'}" if by else ""
            trigger = "trigger" if len(finding.names) == 1 else "triggers"
            return f"vacuous: the {trigger} of {names} never happen{'s' if trigger == 'trigger' else ''}{reason}"


def _listed(names: tuple[str, ...]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def _table(run: tuple[WitnessMoment, ...], unit: str, scale: int) -> Table:
    from rich.table import Table

    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for heading in ("  time", *run[0].values, ""):
        table.add_column(heading)
    for number, moment in enumerate(run):
        end = "<- stuck" if number + 1 == len(run) else ""
        table.add_row(f"  {_time(moment.time, unit, scale)}", *moment.values.values(), end)
    return table


def _time(time: Fraction, unit: str, scale: int) -> str:
    from tachk.syntax.formulas.printer import print_number

    return f"{print_number(time / scale)} {unit}".rstrip()


# ---- for programs ---------------------------------------------------------------------------------------------------


def to_json(analysis: RequirementAnalysis, named: tuple[NamedFormula, ...], unit: str, scale: int) -> dict[str, object]:
    from tachk.base.plain_data import Fields, PlainData
    from tachk.syntax.formulas.printer import print_number
    from tachk.verify.requirements.analysis import RequirementAnalysis, RequirementFinding, WitnessMoment

    plain = PlainData(
        {
            RequirementAnalysis: Fields("findings undecided"),
            RequirementFinding: Fields(
                "kind requirements=names by run", run=lambda found: [m for m in found.run if m.values]
            ),
            WitnessMoment: Fields("time signals=values", time=lambda moment: print_number(moment.time / scale)),
        }
    )
    return {
        "unit": unit,
        "requirements": [
            {"name": each.name, "formula": given.text, "followed": not each.unfollowed, "reason": each.unfollowed}
            for each, given in zip(analysis.requirements, named, strict=True)
        ],
        **plain.of(analysis),
    }


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
@click.option("output", "-o", "--output", metavar="FILE", type=options.written_file, help="Write the report to a file.")
@trace_options.definitions
@options.max_seconds("Stop each search after this time; its question then has no answer.")
def command(file: str, form: str, output: Path | None, seconds: float | None, definitions: tuple[str, ...]) -> None:
    """Examine requirements before there is a model: can all be satisfied, can two deadlines collide, does one follow
    from others, is a trigger impossible?

    Exit status: 0 nothing was found, 10 something was, 20 a question has no answer.
    """

    options.finish(lambda: run_requirements(file, form, output, seconds, definitions))


def run_requirements(
    file: str,
    form: str = "text",
    output: Path | None = None,
    seconds: float | None = None,
    definitions: tuple[str, ...] = (),
) -> ExitStatus:
    """Reports the defects of a set of requirements.

    Args:
        seconds: for each search.
        definitions: values of names in bounds and conditions, each ``NAME=VALUE``.
    """
    from tachk.cli.arguments import parse_definitions
    from tachk.logic.durations import scaled
    from tachk.recordings.monitors.formulas import in_trace_units, read_formulas
    from tachk.report.plain_console import ReportConsole
    from tachk.verify.requirements.analysis import analyse

    named = read_formulas(file, parse_definitions(definitions))
    unit = _unit(named)
    formulas = [in_trace_units(each.within(()), (), unit) for each in named]
    scale = _scale(formulas)
    whole = [(each.name, scaled(formula, Fraction(scale))) for each, formula in zip(named, formulas, strict=True)]
    analysis = analyse(whole, Limits(seconds=seconds))
    with destination(output) as out:
        if form == "json":
            print(json.dumps(to_json(analysis, named, unit, scale), indent=2, ensure_ascii=False), file=out)
        else:
            console = ReportConsole(file=out, highlight=False, soft_wrap=True, force_jupyter=False)
            print_analysis(analysis, unit, scale, console)
    if analysis.findings:
        return ExitStatus.NOT_AS_EXPECTED
    return ExitStatus.UNKNOWN if analysis.undecided else ExitStatus.AS_EXPECTED


def _unit(named: tuple[NamedFormula, ...]) -> str:
    """The unit of time of the report: that of the first bound that has a unit; empty if no bound has one."""
    from tachk.syntax.formula import Duration
    from tachk.syntax.walk import nodes_of_kind

    bounds = (bound.unit for each in named for bound in nodes_of_kind(each.formula, Duration) if bound.value != 0)
    timed = any(each.durations for each in named)
    return next((unit for unit in bounds if unit), "s" if timed else "")


def _scale(formulas: list[Formula]) -> int:
    """By what durations have to be multiplied to be whole numbers."""
    from tachk.syntax.formula import Duration
    from tachk.syntax.walk import nodes_of_kind

    values = (duration.value for formula in formulas for duration in nodes_of_kind(formula, Duration))
    return lcm(*(value.denominator for value in values if isinstance(value, Fraction)))
