"""`tachk plot`."""

from __future__ import annotations

from pathlib import Path

from tachk.cli.actions.judged import Judged
from tachk.cli.exit_status import ExitStatus
from tachk.monitoring.offline import Judging, MonitorReport, judge


def run_plot(judged: Judged, judging: Judging, output: Path, begin: float | None, end: float | None) -> ExitStatus:
    """Draws a trace with what formulas are worth on it. The verdict has no influence on the exit status."""
    record = judge(judged.formulas(), judged.recording(), judging, judged.formula)
    MonitorReport(record).plot(output, begin, end)
    print(f"written: {output}")
    return ExitStatus.AS_EXPECTED
