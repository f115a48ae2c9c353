"""All violations of formulas on whole traces, and how they are told."""

from __future__ import annotations

import io
import json
import math
from pathlib import Path
from random import Random
from typing import Any
from xml.etree import ElementTree

import jsonschema
import numpy as np
import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.monitors.formulas import NamedFormula
from tachk.recordings.monitors.offline import verdict_on
from tachk.recordings.monitors.record import MonitorRecord
from tachk.recordings.monitors.trace_semantics import HeldValues
from tachk.recordings.traces.conventions import EvaluationOptions
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.violations import TriggerCounts
from tachk.report.monitor.formula_signals import signal_of, write_signals
from tachk.report.monitor.junit import monitor_to_junit
from tachk.syntax import formula as syntax
from tests.support.exact_monitor import satisfaction
from tests.support.formulas import FormulaShape, MonitoringCase, random_monitoring_case
from tests.support.monitor_input import always, monitor_input, truth_of
from tests.support.seeds import seeds

SCHEMA = Path(__file__).parents[4] / "docs/schema/monitor.schema.json"

TRACE = {
    "t": [10, 11, 12, 13, 14, 16, 18, 20, 21, 25],
    "p": [0, 1, 0, 1, 0, 0, 1, 0, 0, 1],
    "q": [0, 0, 0, 0, 1, 0, 0, 0, 0, 0],
    "x": [1, 5, 6, 1, 1, 7, 1, 1, 1, 1],
}


def stretches(formula: str, **options: Any) -> list[tuple[float, float]]:
    report = tachk.monitor(formula, TRACE, unit="s", **options)
    return [(row["from"], row["until"]) for row in report.violation_rows()]  # type: ignore[misc]


@pytest.mark.parametrize(
    ("formula", "expected", "counts"),
    [
        ("G (x < 5)", [(11, 13), (16, 18)], None),
        ("G[0, 2] (x < 5)", [(11, 12)], None),
        ("G (rise(p) -> F[0, 2 s] q)", [(11, 11), (18, 18)], TriggerCounts(4, 2, 1)),
        ("G (p -> F[0, 2 s] q)", [(11, 12), (18, 20)], TriggerCounts(4, 2, 1)),
        ("G (x < 7) && G (p -> x < 5)", [(11, 12), (16, 18)], TriggerCounts(4, 1, 0)),
        ("F[0, 2] (x > 6)", [(10, 10)], None),
        ("G (rise(p) -> x < 9)", [], TriggerCounts(4, 0, 0)),
    ],
)
def test_every_violation_and_every_trigger_counts(
    formula: str, expected: list[tuple[float, float]], counts: TriggerCounts | None
) -> None:
    assert stretches(formula) == expected
    assert tachk.monitor(formula, TRACE, unit="s")[0].violations.triggers == counts


def test_a_trigger_that_has_asked_in_vain_is_not_pending_as_well() -> None:
    trace = {"t": [0, 10], "p": [1, 1], "q": [0, 0]}  # before 8 in vain, from 8 on still open
    report = tachk.monitor("G (p -> F[0, 2 s] q)", trace, unit="s")
    assert report[0].violations.triggers == TriggerCounts(1, 1, 0)


def test_each_violation_reports_its_trigger_and_its_deadline() -> None:
    report = tachk.monitor("G (p -> F[0, 2 s] q)", TRACE, unit="s")
    rows = report.violation_rows()
    assert [(row["triggered_from"], row["deadline"], row["blamed"]) for row in rows] == [
        (11, 13, "F[0, 2] q"),
        (18, 20, "F[0, 2] q"),
    ]
    violations = report[0].violations
    assert [finding.cell for finding in violations] == [violations[0].cell, violations[-1].cell]
    assert violations[:1][0].formula == "p -> F[0, 2] q"


def test_json_counts_violations_and_lists_them_when_requested() -> None:
    formulas = ["G (p -> F[0, 2 s] q)", "G (x < 5)", "G (x < 100)", "G (p -> F[0, 30 s] (x > 50))"]
    schema = json.loads(SCHEMA.read_text())
    report = tachk.monitor(formulas, TRACE, unit="s")
    for listed in (False, True):
        document: Any = report.to_dict(all_violations=listed)
        jsonschema.validate(document, schema)
        found = [each["violations"] for each in document["results"]]
        assert [each["count"] for each in found] == [2, 2, 0, 0]
        assert found[0]["triggers"] == {"total": 4, "violated": 2, "pending": 1}
        assert found[3]["triggers"] == {"total": 4, "violated": 0, "pending": 4}
        assert (found[1]["listed"] is not None) is listed
    assert [(each["from"], each["until"]) for each in found[1]["listed"]] == [("11", "13"), ("16", "18")]
    assert found[1]["listed"][0]["blamed"] == [{"formula": "x < 5", "value": "false", "at": "11", "seen": {"x": "5"}}]


def test_text_counts_violations_and_lists_them_when_requested() -> None:
    report = tachk.monitor(["G (p -> F[0, 2 s] q)", "G (x < 5)", "G (x < 7)"], TRACE, unit="s")
    text = report.to_text()
    assert "2 of 4 triggers are violated, 1 pending" in text
    assert "2 violations in all" in text
    assert "1 violation" not in text
    assert "16 s" in report.to_text(all_violations=True).partition("p2 is false")[2]


def test_junit_reports_the_story_of_each_violation_when_requested() -> None:
    record = tachk.monitor("G (rise(p) -> F[0, 2 s] q)", TRACE, unit="s").record
    for listed, number in ((False, 1), (True, 2)):
        suite = ElementTree.fromstring(monitor_to_junit(record, all_violations=listed).partition("\n")[2])
        failure = suite.find(".//failure")
        assert failure is not None
        assert failure.text is not None
        assert failure.text.count("becomes true at") == number
        assert "2 of 4 triggers are violated, 1 pending" in failure.text


def test_lines_have_their_violations_where_they_cross() -> None:
    trace = {"t": [0, 4, 8, 12], "x": [0.0, 8.0, 0.0, 8.0]}
    rows = tachk.monitor("G (x <= 4)", trace, interpolation="linear").violation_rows()
    assert [(row["from"], row["until"]) for row in rows] == [(pytest.approx(2), 6), (pytest.approx(10), 12)]


def test_many_violations_are_counted_without_being_explained() -> None:
    rows = 200_000
    trace = {"t": list(range(rows)), "x": [float(n % 2) for n in range(rows)]}
    violations = tachk.monitor("G (x < 0.5)", trace)[0].violations
    assert len(violations) == rows // 2
    assert math.isclose(violations[-1].cell, 2 * (rows - 1))


def taken(monitor: tachk.Monitor) -> list[tuple[str, float, float | None]]:
    return [
        (each.name, float(each.since), None if each.until is None else float(each.until))
        for each in monitor.take_violations()
    ]


def test_violations_are_reported_row_by_row_when_they_begin_and_when_they_end() -> None:
    monitor = tachk.Monitor(["G (x < 5)", "F[0, 2] (x < 0)"], all_violations=True)
    assert monitor.update(10, x=1) is tachk.Truth.UNDETERMINED
    monitor.update(11, x=6)
    assert taken(monitor) == []
    monitor.update(12, x=7)
    assert taken(monitor) == [("p1", 11, None)]
    monitor.update(13, x=1)
    assert taken(monitor) == [("p2", 10, None)]
    monitor.advance(14)
    assert taken(monitor) == [("p1", 11, 13)]
    monitor.update(15, x=8)
    monitor.finish(20)
    assert taken(monitor) == [("p1", 15, None), ("p1", 15, 20), ("p2", 10, 10)]


def test_violations_of_arrays_are_those_of_the_whole_trace() -> None:
    formulas = ["G (x < 7) && G[2, 9] (p -> F[0, 2] q)", "G (rise(p) -> F[0, 2] q)"]
    monitor = tachk.Monitor(formulas, all_violations=True, decimals=0)
    columns = {name: TRACE[name] for name in "pqx"}
    monitor.push(np.array(TRACE["t"], np.int64), columns, 0)
    monitor.finish()
    ended = [(name, since, until) for name, since, until in taken(monitor) if until is not None]
    rows = tachk.monitor(formulas, TRACE).violation_rows()
    assert sorted(ended) == sorted((row["name"], row["from"], row["until"]) for row in rows)
    assert len(ended) == 4


def test_a_monitor_of_first_violations_has_no_others() -> None:
    with pytest.raises(UsageError, match="first violation only"):
        tachk.Monitor("G p").take_violations()


def test_signals_are_those_of_the_definition_at_every_cell() -> None:
    for seed in seeds(range(12)):
        case = random_monitoring_case(Random(seed), FormulaShape(depth=2, rows=8))
        given = monitor_input(MonitoringCase(always(case.formula), case.trace))
        verdict = verdict_on(
            NamedFormula("f", "", case.formula), given.program, given.trace, EvaluationOptions(), HeldValues()
        )
        signal = signal_of(MonitorRecord(given.trace, "", (verdict,)), verdict)
        asked = case.formula
        while isinstance(asked, syntax.Always):
            asked = asked.operand
        exact = satisfaction(asked, case.trace)
        cells = np.arange(2 * given.trace.end + 1)
        there = signal.on(cells)
        assert there.low is not None
        assert there.high is not None
        for cell in cells.tolist():
            value = exact.value(given.instant(cell))
            found = Truth(int(there.truth[cell])), float(there.low[cell]), float(there.high[cell])
            assert found == (truth_of(value), float(value.low), float(value.high)), (seed, cell)


def test_signals_are_arrays_and_a_table(tmp_path: Path) -> None:
    report = tachk.monitor("G (x < 5)", TRACE, unit="s")
    signal = report.signal("p1")
    assert signal.formula == "x < 5"
    assert signal.times.tolist() == [10, 11, 12, 13, 16, 18]
    assert signal.after.tolist() == [False] * 6
    assert [Truth(value) for value in signal.truth.tolist()] == [1, 0, 0, 1, 0, 1]
    assert signal.low is not None
    assert signal.low.tolist() == [4, 0, -1, 4, -2, 4]
    assert set(signal.to_dict()) == {"time", "after", "truth", "low", "high"}
    out = io.StringIO()
    write_signals(report.record, out)
    assert out.getvalue().splitlines()[:3] == [
        "time [s],after,p1,p1.low,p1.high",
        "10,false,true,4.0,4.0",
        "11,false,false,0.0,0.0",
    ]
