"""Verdicts on a trace as JUnit XML, the form in which build servers take test results."""

from __future__ import annotations

from xml.etree import ElementTree

from tachk.report.junit_report import clean
from tachk.report.monitor.record import MonitorRecord
from tachk.report.monitor.text import answer_text
from tachk.report.monitor.words import explain_verdict
from tachk.runtime.node_signal import Truth


def monitor_to_junit(record: MonitorRecord) -> str:
    """One suite for the trace, one case for each formula: false is a failure, undetermined an error."""
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
            element.text = clean("\n".join((verdict.formula, *explain_verdict(record, verdict))))
    ElementTree.indent(suites)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(suites, encoding="unicode") + "\n"
