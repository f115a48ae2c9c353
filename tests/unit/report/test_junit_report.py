from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

from tachk.report.junit_report import runs_to_junit
from tachk.report.record import RunRecord


def test_counts_and_kinds(record: RunRecord) -> None:
    suite = ElementTree.fromstring(runs_to_junit([record])).find("testsuite")
    assert suite is not None
    counts = {key: suite.get(key) for key in ("tests", "failures", "errors", "skipped")}
    assert counts == {"tests": "5", "failures": "1", "errors": "2", "skipped": "1"}
    kinds = {case.get("name"): [child.tag for child in case] for case in suite}
    assert kinds == {"always_off": ["failure"], "can_light": [], "far": ["error"], "bad": ["error"], "q5": ["skipped"]}


def test_failure_reports_the_run(record: RunRecord) -> None:
    failure = ElementTree.fromstring(runs_to_junit([record])).find(".//failure")
    assert failure is not None
    assert failure.get("message") == "fails, expected holds"
    assert "User: idle → done" in (failure.text or "")


def test_characters_that_xml_cannot_hold_are_replaced(record: RunRecord) -> None:
    odd = replace(record, model="a\x00<&\ud800.ta", verdicts=(), not_checked=())
    suite = ElementTree.fromstring(runs_to_junit([odd])).find("testsuite")
    assert suite is not None
    assert suite.get("name") == "a�<&�.ta"
