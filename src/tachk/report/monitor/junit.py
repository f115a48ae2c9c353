"""Verdicts on a trace as JUnit XML, the form in which build servers take test results."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, TextIO
from xml.etree import ElementTree

from tachk.recordings.monitors.record import MonitorRecord, MonitorVerdict
from tachk.recordings.traces.node_signal import Truth
from tachk.report.junit_report import clean
from tachk.report.monitor.text import answer_text
from tachk.report.monitor.words import count_violations, explain_finding, explain_verdict

if TYPE_CHECKING:
    from rich.console import Console


def write_junit(record: MonitorRecord, out: TextIO, console: Callable[[TextIO], Console], all_violations: bool) -> None:
    """A row of `tachk.report.monitor.formats`."""
    out.write(monitor_to_junit(record, all_violations))


def monitor_to_junit(record: MonitorRecord, all_violations: bool = False) -> str:
    """One suite for the trace, one case for each formula: false is a failure, undetermined an error.

    Args:
        all_violations: describe each one, not only the first.
    """
    truths = [verdict.truth for verdict in record.verdicts]
    suites = ElementTree.Element("testsuites")
    suite = ElementTree.SubElement(
        suites,
        "testsuite",
        name=clean(record.trace.name),
        tests=str(len(truths)),
        failures=str(truths.count(Truth.FALSE)),
        errors=str(truths.count(Truth.UNDETERMINED)),
        skipped="0",
        time="0.000",
    )
    for verdict in record.verdicts:
        case = ElementTree.SubElement(
            suite, "testcase", classname=clean(record.trace.name), name=clean(verdict.name), time="0.000"
        )
        if verdict.truth is not Truth.TRUE:
            kind = "failure" if verdict.truth is Truth.FALSE else "error"
            element = ElementTree.SubElement(case, kind, message=clean(answer_text(verdict)), type=kind)
            element.text = clean("\n".join((verdict.formula, *_story(record, verdict, all_violations))))
    ElementTree.indent(suites)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(suites, encoding="unicode") + "\n"


def _story(record: MonitorRecord, verdict: MonitorVerdict, all_violations: bool) -> Iterator[str]:
    violations = verdict.violations
    if all_violations and len(violations):
        for finding in violations:
            yield from explain_finding(record, verdict, finding)
    else:
        yield from explain_verdict(record, verdict)
    line = count_violations(violations)
    if line:
        yield line
