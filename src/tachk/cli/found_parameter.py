"""`tachk monitor --find`: the tightest value of a name in a formula with which recorded traces satisfy it."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import Reporting, ViolationReporting
from tachk.cli.row_by_row import RowByRow
from tachk.cli.trace_arguments import TraceArguments
from tachk.recordings.traces.conventions import EvaluationOptions


@dataclass(frozen=True, slots=True)
class FindOptions:
    """Attributes:
    over: the name whose value is looked for and its range, as ``T=0..200``.
    step: only multiples of this number are tried.
    """

    over: tuple[str, ...] = ()
    step: str | None = None


def run_find(
    search: FindOptions,
    arguments: TraceArguments,
    evaluation: EvaluationOptions,
    rows: RowByRow,
    violations: ViolationReporting,
    reporting: Reporting,
) -> ExitStatus:
    """Finds the tightest value of a parameter. Raises UsageError for options that belong to verdicts alone."""
    from tachk.api.mining import mine
    from tachk.cli.arguments import parse_definitions
    from tachk.recordings.monitors.formulas import check_order
    from tachk.recordings.monitors.mined_ranges import named_ranges

    _check_alone(_others(arguments, evaluation, rows, violations))
    if reporting.form not in ("text", "json"):
        raise UsageError(f"--find reports text or json, not {reporting.form}")
    ranges = named_ranges(search.over, "--find")
    if search.step is not None and re.fullmatch(r"\d*\.?\d+", search.step) is None:
        raise UsageError(f"--step {search.step}: expected a positive number")
    check_order(arguments.formula, arguments.trace)
    found = mine(
        arguments.formula,
        (arguments.trace, *arguments.others),
        ranges,
        step=search.step,
        time=arguments.time,
        unit=arguments.unit,
        end=evaluation.ending.value,
        constants=parse_definitions(arguments.definitions),
        select=arguments.names,
    )
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None and reporting.form == "json":
            json.dump(found.to_dict(), out, indent=2)
            out.write("\n")
        elif out is not None:
            out.write(found.to_text())
    return ExitStatus.AS_EXPECTED if found.satisfiable else ExitStatus.NOT_AS_EXPECTED


def _others(
    arguments: TraceArguments, evaluation: EvaluationOptions, rows: RowByRow, violations: ViolationReporting
) -> dict[str, bool]:
    """The options that belong to verdicts, and whether they were given."""
    usual = EvaluationOptions()
    return {
        "--interpolation": evaluation.interpolation is not usual.interpolation,
        "--no-robustness": evaluation.robustness is not usual.robustness,
        "--time-robustness": evaluation.time_robustness,
        "--decimals": arguments.decimals is not None,
        "--run": arguments.run is not None,
        "--port": bool(arguments.ports),
        "--online": rows.online,
        "--follow": rows.follow,
        "--live": rows.live,
        "--fail-fast": rows.fail_fast,
        "--all-violations": violations.all_violations,
        "--signals": violations.signals is not None,
    }


def _check_alone(others: Mapping[str, bool]) -> None:
    for option, given in others.items():
        if given:
            raise UsageError(f"{option} does not go with --find", "--find looks for a value, and gives no verdicts")
