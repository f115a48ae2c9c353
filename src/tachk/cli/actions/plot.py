"""`tachk plot`."""

from __future__ import annotations

from pathlib import Path

from tachk.cli.exit_status import ExitStatus
from tachk.monitoring.formulas import check_order, read_formulas
from tachk.monitoring.offline import MonitorReport, judge, selected
from tachk.runtime.trace import Interpolation
from tachk.runtime.trace_files import open_trace


def run_plot(
    formula: str,
    trace: str,
    output: Path,
    time: str | None,
    unit: str | None,
    names: tuple[str, ...],
    begin: float | None,
    end: float | None,
    interpolation: str,
) -> ExitStatus:
    """Draws a trace with what formulas are worth on it. The verdict has no influence on the exit status."""
    check_order(formula, trace)
    formulas = selected(read_formulas(formula), names)
    between = Interpolation(interpolation)
    record = judge(formulas, open_trace(trace, time, unit), interpolation=between, source=formula)
    MonitorReport(record).plot(output, begin, end)
    print(f"written: {output}")
    return ExitStatus.AS_EXPECTED
