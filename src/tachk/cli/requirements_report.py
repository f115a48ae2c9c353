"""What was found out about requirements, for people and for programs."""

from __future__ import annotations

from fractions import Fraction

from rich.console import Console
from rich.table import Table

from tachk.base.plain_data import Fields, PlainData
from tachk.recordings.monitors.formulas import NamedFormula
from tachk.syntax.formulas.printer import print_number
from tachk.verify.requirements.analysis import FindingKind, RequirementAnalysis, RequirementFinding, WitnessMoment

# ---- for people -----------------------------------------------------------------------------------------------------


def tell(analysis: RequirementAnalysis, unit: str, scale: int, console: Console) -> None:
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
            return f"vacuous: what {names} speak{'s' if len(finding.names) == 1 else ''} of never happens{reason}"


def _listed(names: tuple[str, ...]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def _table(run: tuple[WitnessMoment, ...], unit: str, scale: int) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for heading in ("  time", *run[0].values, ""):
        table.add_column(heading)
    for number, moment in enumerate(run):
        end = "<- stuck" if number + 1 == len(run) else ""
        table.add_row(f"  {_time(moment.time, unit, scale)}", *moment.values.values(), end)
    return table


def _time(time: Fraction, unit: str, scale: int) -> str:
    return f"{print_number(time / scale)} {unit}".rstrip()


# ---- for programs ---------------------------------------------------------------------------------------------------


def to_json(analysis: RequirementAnalysis, named: tuple[NamedFormula, ...], unit: str, scale: int) -> dict[str, object]:
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
