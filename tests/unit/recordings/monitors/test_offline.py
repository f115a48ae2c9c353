"""Verdicts on whole traces with their explanation: trigger, deadline, blame, what is presumed, what never happened."""

from __future__ import annotations

import json
import math
import pickle
from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema
import numpy as np
import pandas as pd
import pytest

import tachk
from tachk.api.monitoring import MonitorReport
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.recordings.monitors.record import cell_text
from tachk.recordings.traces.core_monitor import truth_signals
from tachk.recordings.traces.monitor_program import MonitorProgram
from tachk.recordings.traces.node_signal import NodeSignal
from tachk.recordings.traces.trace import FloatTimes, Trace
from tachk.recordings.traces.trace_arrays import open_table
from tachk.recordings.traces.verdict_explanation import Finding
from tachk.report.monitor.junit import monitor_to_junit
from tachk.report.monitor.words import explain_verdict

SCHEMA = Path(__file__).parents[4] / "docs/schema/monitor.schema.json"

TRACE = {
    "t": [0, 1, 2, 4, 6.5, 9, 12, 15, 20],
    "p": [0, 1, 1, 0, 0, 0, 1, 0, 0],
    "q": [0, 0, 0, 0, 0, 1, 0, 0, 0],
    "x": [1, 2, 3, 5, 2, 1, 0, 7, 1],
}


def judged(*formulas: str, **options: Any) -> MonitorReport:
    return tachk.monitor(formulas, TRACE, unit="s", **options)


def story(formula: str) -> tuple[str, ...]:
    record = judged(formula).record
    return explain_verdict(record, record.verdicts[0])


def places(report: MonitorReport) -> tuple[str | None, ...]:
    finding = report[0].finding
    assert isinstance(finding, Finding)
    cells = (finding.cell, finding.deadline, finding.decided)
    return tuple(None if cell is None else cell_text(report.record.trace, cell) for cell in cells)


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("G (p -> F[0,3] q)", ("1 s", "4 s", "4 s")),
        ("G (p -> F[0,3) q)", ("1 s", "just after 3.9 s", "just after 3.9 s")),
        ("G (p -> G[0,8] !q)", ("1 s", "9 s", "9 s")),
        ("G (p -> G[0,8) !q)", ("just after 1 s", "just after 9 s", "9 s")),
        ("G (x < 5)", ("4 s", None, "4 s")),
        ("G (p -> q)", ("1 s", None, "1 s")),
        ("F[0,8] q", ("0 s", "8 s", "8 s")),
        ("F (x > 10)", ("0 s", None, "20 s")),
        ("G (p -> (x < 5 U[0,10] q))", ("1 s", "11 s", "4 s")),
        ("G (p -> (x < 6 U[0,5] q))", ("1 s", "6 s", "6 s")),
        ("G (q -> O[0,5] p)", ("9 s", None, "9 s")),
        ("G (q -> O[0,6] p)", ("10 s", None, "10 s")),
        ("G (q -> H[0,2] x < 2)", ("9 s", None, "9 s")),
        ("G (rise(p) -> q) && G (x < 9)", ("1 s", None, "1 s")),
        ("!F q", ("0 s", None, "9 s")),
    ],
)
def test_the_first_violation(formula: str, expected: tuple[str | None, ...]) -> None:
    report = judged(formula)
    assert report[0].truth is tachk.Truth.FALSE
    assert places(report) == expected


def test_the_story_of_a_missed_deadline() -> None:
    assert story("G (p -> F[0,3] (q && x < 5))") == (
        "trigger: `p` becomes true at 1 s",
        "`q && x < 5` is never true from 1 s to 4 s, the deadline",
        "seen at 4 s: q = false, x = 5",
        "the violation is certain at 4 s",
        "violated from 1 s until 4 s",
    )


def test_the_story_names_the_broken_part_of_a_conjunction_only() -> None:
    assert story("G (rise(p) -> G[0,5] (x < 5 && !q))") == (
        "trigger: `p` becomes true at 1 s",
        "`x < 5 && !q` should be true at every instant from 1 s to 6 s",
        "`x < 5` is false at 4 s",
        "seen at 4 s: x = 5",
        "the violation is certain at 4 s",
    )


def test_the_story_of_an_open_verdict() -> None:
    assert story("G (p -> F[0,9] q)") == (
        "trigger: `p` becomes true at 12 s",
        "`q` has not been true yet; it is awaited from 12 s to 21 s, the deadline",
        "the trace ends at 20 s, too early to decide",
        "if nothing changes any more it will be false",
    )


def test_blame_lies_with_the_innermost_subformulas() -> None:
    (verdict,) = judged("G (x < 5 || G[0, 10] x > 0)")
    assert verdict.finding is not None
    blamed = [
        (reason.text, cell_text(judged("G x > 0").record.trace, reason.cell)) for reason in verdict.finding.blamed
    ]
    assert blamed == [("x < 5", "4 s"), ("x > 0", "12 s")]


@pytest.mark.parametrize(
    ("formula", "truth", "presumably"),
    [
        ("G (p -> F[0,9] q)", "undetermined", "false"),
        ("G (x == 7 -> G[0,9] !p)", "undetermined", "true"),
        ("F[0,30] x > 10", "undetermined", "false"),
        ("G x < 9", "true", None),
        ("F x > 10", "false", None),
    ],
)
def test_what_the_end_leaves_open_is_undetermined(formula: str, truth: str, presumably: str | None) -> None:
    (verdict,) = judged(formula)
    assert verdict.truth.word == truth
    assert (None if verdict.presumably is None else verdict.presumably.word) == presumably


@pytest.mark.parametrize("interpolation", ["constant", "linear"])
@pytest.mark.parametrize(
    ("formula", "presumably"),
    [
        ("G (p -> G[0,50 s] !q)", "true"),
        ("G F[1 s,2 s] !q", "true"),
        ("G G[1 s,2 s] !q", "true"),
        ("G (p -> F[9 s, 20 s] q)", "false"),
    ],
)
def test_what_is_presumed_where_every_instant_up_to_the_end_is_open(
    formula: str, presumably: str, interpolation: str
) -> None:
    trace = {"time": [0, 390, 400], "p": [False, True, True], "q": [False] * 3}
    (verdict,) = tachk.monitor(formula, trace, unit="s", interpolation=interpolation)
    assert verdict.truth is tachk.Truth.UNDETERMINED
    assert verdict.presumably is not None and verdict.presumably.word == presumably


def test_a_window_that_has_not_begun_is_reported_so() -> None:
    report = tachk.monitor("G F[1 s,2 s] !q", {"time": [0, 400], "q": [False] * 2}, unit="s")
    assert "`!q` has not been true in time yet" in report.to_text()


BOTH = {"time": [0, 10, 50], "x": [0, 5, 5], "y": [0, 5, 5]}


@pytest.mark.parametrize(
    ("formula", "columns", "ahead", "behind"),
    [
        ("G[1,20] (x >= y)", BOTH, (0, 0), (0, 0)),  # y may come before x
        ("G[1,20] (x >= y)", BOTH | {"time": [0, 30, 50]}, (10, 10), (1, 1)),
        ("G[1,20] (x + 6 > y)", BOTH, (30, math.inf), (1, 1)),  # whatever comes first
        ("G[12,20] (x != y)", BOTH | {"y": [7, 6, 6]}, (30, math.inf), (12, 12)),
        ("G[12,20] (x < y)", BOTH | {"y": [1, 6, 6]}, (30, math.inf), (2, 2)),  # 5 and 1 would not do
        ("F[12,20] change(x - y)", BOTH, (-math.inf, -30), (-2, -2)),
        ("F[5,15] change(x - y)", BOTH, (0, 0), (0, 0)),
        ("G[12,20] !(abs(x - y) > 2)", BOTH, (30, math.inf), (2, 2)),
    ],
)
def test_in_time_the_columns_of_one_comparison_may_be_shifted_apart(
    formula: str, columns: dict[str, list[int]], ahead: tuple[float, float], behind: tuple[float, float]
) -> None:
    (verdict,) = tachk.monitor(formula, columns, time_robustness=True)
    assert verdict.time_robustness is not None
    assert (verdict.time_robustness.ahead, verdict.time_robustness.behind) == (ahead, behind)


def test_the_end_can_be_given_a_meaning() -> None:
    formulas = ("G (p -> F[0,9] q)", "G x < 9", "G x < 3")
    assert [v.truth.word for v in judged(*formulas, end="weak")] == ["true", "true", "false"]
    assert [v.truth.word for v in judged(*formulas, end="strong")] == ["false", "true", "false"]
    assert [v.measured.word for v in judged(*formulas, end="strong")] == ["undetermined", "true", "false"]
    with pytest.raises(UsageError, match="expected undetermined, weak or strong"):
        judged("G p", end="maybe")


@pytest.mark.parametrize(
    ("formula", "vacuous"),
    [
        ("G (x > 10 -> q)", True),
        ("G (x > 10 -> F[0,50] q) && G (x < -5 -> q)", True),
        ("G (x > 10 -> F[0,5] q) && G (q -> q)", False),
        ("G (q -> q)", False),
        ("G x < 10", False),
    ],
)
def test_formulas_whose_trigger_never_happens_are_pointed_out(formula: str, vacuous: bool) -> None:
    (verdict,) = judged(formula)
    assert (verdict.truth, verdict.vacuous) == (tachk.Truth.TRUE, vacuous)


def test_robustness() -> None:
    values, flags, open_ = judged("G x < 10", "G (p -> F[0,3] q)", "F[0,30] x > 10")
    assert values.robustness == (3, 3)
    assert flags.robustness == (-math.inf, -math.inf)
    assert open_.robustness == (-3, math.inf)
    assert judged("G x < 10", robustness=False)[0].robustness is None


def test_bounds_finer_than_the_trace_refine_its_ticks() -> None:
    report = judged("G (rise(p) -> F[0, 2999 ms] x >= 3)", "G (rise(p) -> F[0, 9 / 3] x >= 3)", "F[0, 1 / 3] x > 1")
    assert report.record.trace.ticks_per_unit == 3000
    assert [v.truth.word for v in report] == ["false", "true", "false"]


def test_times_are_reported_as_the_clock_of_the_recording_shows_them() -> None:
    shifted = {**TRACE, "t": [1700000000 + t for t in TRACE["t"]]}
    report = tachk.monitor("G (p -> F[0, 3 s] q)", shifted, unit="s")
    assert places(report) == ("1700000001 s", "1700000004 s", "1700000004 s")
    assert report.to_dict()["begin"] == "1700000000"


def test_all_mistakes_of_all_formulas_are_reported() -> None:
    with pytest.raises(InputError) as error:
        judged("G (a -> F[0, 3] q)", "G b", "F[0, 3 s] x < y")
    assert [found.code for found in error.value.diagnostics] == ["E0901"] * 3
    with pytest.raises(UsageError, match="there is no formula 'z'"):
        judged("G p", select=["z"])


def test_a_verdict_is_no_boolean() -> None:
    with pytest.raises(TypeError, match="three values"):
        bool(judged("G p")[0].truth)


def test_rows_and_names() -> None:
    report = judged("G (p -> F[0,3] q)", "G x < 9")
    assert report["p2"].truth is tachk.Truth.TRUE
    with pytest.raises(KeyError):
        report["p3"]
    assert report.truth is tachk.Truth.FALSE
    frame = pd.DataFrame(report.to_rows())
    assert frame[["name", "verdict", "at", "deadline", "blamed"]].iloc[0].tolist() == [
        "p1",
        "false",
        1.0,
        4.0,
        "F[0, 3] q",
    ]


def test_the_machine_form_follows_its_schema() -> None:
    schema = json.loads(SCHEMA.read_text())
    formulas = (
        "G (p -> F[0,3] q)",
        "G (p -> F[0,9] q)",
        "G x < 9",
        "F x > 10",
        "Whenever p becomes true, within 3 s, q must be true.",
    )
    data = judged(*formulas).to_dict()
    jsonschema.validate(json.loads(json.dumps(data)), schema)
    first = data["results"][0]  # type: ignore[index]
    assert first["finding"]["from"] == "1"  # type: ignore[index,call-overload]


def test_text_html_and_junit_escape_and_count() -> None:
    report = judged("G (p -> F[0,3] x < 1 && q)", "G (p -> F[0,9] q)", "G (x > 10 -> q)")
    text = report.to_text()
    assert "1 true, 1 false, 1 undetermined" in text
    assert "true (nothing triggered)" in text
    assert "undetermined, presumably false" in text
    assert "x &lt; 1" in report._repr_html_()
    suite = ElementTree.fromstring(monitor_to_junit(report.record)).find("testsuite")
    assert suite is not None
    assert {name: suite.get(name) for name in ("tests", "failures", "errors")} == {
        "tests": "3",
        "failures": "1",
        "errors": "1",
    }


def test_exact_instants_between_ticks() -> None:
    data = {"t": [Fraction(0), Fraction(1, 3), Fraction(1)], "p": [0, 1, 0]}
    report = tachk.monitor("G !p", data)
    assert report.to_dict()["results"][0]["finding"]["from"] == "1/3"  # type: ignore[index,call-overload]


@pytest.mark.parametrize("interpolation", ["constant", "linear"])
def test_reports_can_be_sent_to_other_processes(interpolation: str) -> None:
    trace = {"time": [0, 1, 3], "x": [0, 7.5, 3], "y": [1, 2, 5]}
    report = tachk.monitor("G (x > 5 -> F[0,1] y > 4)", trace, interpolation=interpolation)
    copy = pickle.loads(pickle.dumps(report))
    assert copy.to_text() == report.to_text()
    assert copy.to_dict() == report.to_dict()
    assert copy[0].explainer.signal(0).stretches() == report[0].explainer.signal(0).stretches()


@pytest.mark.parametrize("formula", ["G (x > 5 -> F[0,1] y > 4)", "G F[0,2] y > 4"])
def test_a_trace_is_read_for_explanations_when_they_are_requested(
    formula: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int] = []

    def counted_signals(program: MonitorProgram, trace: Trace, nodes: Sequence[int]) -> Sequence[NodeSignal]:
        asked.append(len(nodes))
        return truth_signals(program, trace, nodes)

    monkeypatch.setattr("tachk.recordings.monitors.trace_semantics.truth_signals", counted_signals)
    verdict = tachk.monitor(formula, {"time": [0, 1, 3], "x": [0, 7.5, 3], "y": [1, 5, 2]})[0]
    assert not asked
    found = verdict.finding
    assert (found is None) == (verdict.measured is tachk.Truth.TRUE)
    readings = len(asked)
    assert verdict.finding is found
    assert len(asked) == readings


@pytest.mark.parametrize(
    "formula", ["G (x > 5 -> F[0,1] y > 4)", "x < 9 && G (x > 5 -> F[0,1] y > 4)", "G F[0,1] y > 4"]
)
def test_a_changed_trace_does_not_explain_its_old_verdict(formula: str) -> None:
    trace = {"time": np.array([0.0, 1, 3]), "x": np.array([0, 7.5, 3]), "y": np.array([1, 2, 4.5])}
    verdict = tachk.monitor(formula, trace)[0]
    assert verdict.truth is tachk.Truth.FALSE
    trace["y"][:] = 5
    with pytest.raises(UsageError, match="changed since it was evaluated"):
        verdict.finding  # noqa: B018


def test_changed_times_do_not_explain_an_old_verdict() -> None:
    trace = {"time": np.array([0.0, 1, 3]), "x": np.array([0, 7.5, 3])}
    verdict = tachk.monitor("G x < 5", trace)[0]
    trace["time"][1] = 9
    with pytest.raises(UsageError, match="changed since it was evaluated"):
        verdict.finding  # noqa: B018


ROWS = 3000


def plain_rows() -> dict[str, np.ndarray]:
    """Quarters of a second; x is 1 in row 9 alone, y moves, p holds truth values."""
    rows = np.arange(ROWS)
    return {
        "time": 5 + rows / 4,
        "x": np.where(rows == 9, 1.0, 0.5),
        "y": (rows % 7) / 2,
        "p": np.where(rows % 3 == 0, 1.0, 0.0),
    }


CHANGES: dict[str, tuple[str, Callable[[float], float]]] = {
    "nothing": ("x", lambda value: value),
    "missing": ("x", lambda value: math.nan),
    "infinite": ("y", lambda value: math.inf),
    "missing truth": ("p", lambda value: math.nan),
    "no truth": ("p", lambda value: 0.5),
    "no time": ("time", lambda value: math.nan),
    "infinite time": ("time", lambda value: -math.inf),
    "backwards": ("time", lambda value: value - 0.5),
    "same time": ("time", lambda value: value - 0.25),
    "finer time": ("time", lambda value: value + 0.0625),
    "no decimal": ("time", lambda value: math.nextafter(value, math.inf)),
    "large time": ("time", lambda value: 1e300),
}


@pytest.mark.parametrize("row", [0, 1, 1024, 2900, ROWS - 1])
@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize(
    "formulas",
    [
        "G (x < 1 || F[0, 3] y > 2)",
        ["G x < 0.75", "G (p -> F[0, 0.125] y > 1)"],
        "G F[0, 2] (p && y > 2)",
    ],
)
def test_rows_that_are_inspected_while_they_are_evaluated(row: int, change: str, formulas: str | list[str]) -> None:
    """What is reported is what it is if all rows are read first, also where a formula is decided before the fault."""
    arrays = plain_rows()
    name, changed = CHANGES[change]
    arrays[name][row] = changed(float(arrays[name][row]))
    told: list[object] = []
    columns = [name for name in "xyp" if name in str(formulas)]
    for first in (False, True):
        try:
            report = tachk.monitor(formulas, open_table(arrays).read(columns) if first else arrays)
        except UsageError as error:
            told.append((str(error), error.help))
        except InputError as error:
            told.append(str(error))
        else:
            report = pickle.loads(pickle.dumps(report))
            told.append((report.to_dict(), report.record.trace.times.tolist()))
    assert told[0] == told[1]
    if change == "nothing":
        trace = tachk.monitor(formulas, arrays).record.trace
        assert isinstance(trace.instants, FloatTimes) and trace.instants.checked


@pytest.mark.parametrize("row", [1, 500, 1023, 1024, ROWS - 2])
@pytest.mark.parametrize(
    ("formula", "truth"),
    [
        ("G x < 0.75", "true"),
        ("F x > 0.75", "false"),
        ("G (x > 0.75 -> F[0, 1] y > 9)", "true"),
        ("G !rise(x > 0.75)", "true"),
    ],
)
def test_of_rows_at_one_instant_the_last_counts_while_they_are_evaluated(row: int, formula: str, truth: str) -> None:
    arrays = plain_rows()
    arrays["x"][9], arrays["x"][row] = 0.5, 1.0
    arrays["time"][row + 1 :] -= 0.25
    assert tachk.monitor(formula, arrays)[0].truth.name == truth.upper()


@pytest.mark.parametrize(
    ("formula", "truth"),
    [("G (x <= 7)", "true"), ("G (x < 7)", "false"), ("F (x >= 7)", "true"), ("F (x > 7)", "false")],
)
def test_a_robustness_of_0_leaves_the_truth_open(formula: str, truth: str) -> None:
    verdict = judged(formula)[0]
    assert verdict.robustness is not None
    assert (verdict.truth.name, verdict.robustness[0]) == (truth.upper(), 0)


@pytest.mark.parametrize("given", [3, ["G (x > 1)", 7]])
def test_what_is_no_formula_is_rejected(given: Any) -> None:
    with pytest.raises(UsageError, match=r"a formula cannot be a int|`formula` is 3, but it must be a text"):
        tachk.monitor(given, {"time": [0], "x": [1]})


def refused(formula: str, values: list[float], **given: str) -> str:
    with pytest.raises(InputError) as refusal:
        tachk.monitor(formula, {"time": range(len(values)), "ok": values, "x": [1] * len(values)}, **given)
    (found,) = refusal.value.diagnostics
    assert (found.code, found.span.text) == ("E0902", "ok")
    return found.message


@pytest.mark.parametrize("values", [[1, 0.5, -1], [2, 2, 2], [0, 1, 3], [0, 1, math.inf]])
@pytest.mark.parametrize("formula", ["G ok", "F !ok", "G (x < 5 -> ok)", "G (ok && x > 0)", "rise(ok)"])
def test_only_a_column_of_0_and_1_is_a_condition(values: list[float], formula: str) -> None:
    assert refused(formula, values).startswith("`ok` is not a condition: it is ")
    assert tachk.monitor("G (ok > 0 || ok <= 0)", {"time": range(3), "ok": values}).truth is tachk.Truth.TRUE
    assert tachk.monitor("F change(ok)", {"time": range(3), "ok": values}).truth is not tachk.Truth.UNDETERMINED


def test_the_first_value_that_is_no_truth_value_is_named() -> None:
    assert refused("G (x > 3 -> ok)", [1, 0.5, -1], unit="ms") == ("`ok` is not a condition: it is 0.5 at 1 ms")


@pytest.mark.parametrize("formula", ["G (x + 1)", "G abs(x)", "F (-x)", "G 2.5"])
def test_a_number_is_no_condition(formula: str) -> None:
    with pytest.raises(InputError) as refusal:
        tachk.monitor(formula, {"time": [0, 1], "x": [1, 1]})
    assert refusal.value.diagnostics[0].message.endswith("is a number, not a condition")


INFINITE = {"time": [0, 1, 2], "x": [1, -math.inf, 3], "y": [math.inf, math.inf, -math.inf]}


@pytest.mark.parametrize("online", [False, True])
@pytest.mark.parametrize(
    ("formula", "truth", "robustness"),
    [
        ("G (x < 5)", "true", 2),
        ("G (x > -5)", "false", -math.inf),
        ("F (x < -5)", "true", math.inf),
        ("G[0, 1] (y > x)", "true", math.inf),
        # Both sides are plus infinity.
        ("y < y", "false", -math.inf),
        ("y <= y", "true", math.inf),
        ("y == y", "true", math.inf),
        ("y != y", "false", -math.inf),
        # The difference has no value, so no comparison but != is true.
        ("y - y < 3", "false", -math.inf),
        ("y - y >= 3", "false", -math.inf),
        ("y - y != 3", "true", math.inf),
        ("G (abs(y) > 5)", "true", math.inf),
        ("F (min(x, y) < 0)", "true", math.inf),
        ("F[1, 1] change(x)", "true", math.inf),
    ],
)
def test_infinite_values_are_values(formula: str, truth: str, robustness: float, online: bool) -> None:
    if online:
        monitor = tachk.Monitor(formula, robustness=True)
        for time, x, y in zip(*INFINITE.values(), strict=True):
            monitor.update(time, x=x, y=y)
        (verdict,) = monitor.finish()
        pushed = tachk.Monitor(formula, robustness=True)
        pushed.push(np.arange(3), {"x": np.array(INFINITE["x"]), "y": np.array(INFINITE["y"])}, 0)
        assert pushed.finish()[0].robustness == verdict.robustness
        assert (verdict.truth.word, verdict.robustness) == (truth, (robustness, robustness))
        return
    report = tachk.monitor(formula, INFINITE)
    assert (report[0].truth.word, report[0].robustness) == (truth, (robustness, robustness))
    assert "nan" not in report.to_text().lower()


def test_no_line_leads_to_an_infinite_value() -> None:
    with pytest.raises(UsageError, match="'x' has an infinite value, to which no straight line leads"):
        tachk.monitor("G (x < 5)", INFINITE, interpolation="linear")


def test_infinite_values_are_drawn(tmp_path: Path) -> None:
    report = tachk.monitor("G (x > -5 || y > x)", INFINITE)
    report.plot(tmp_path / "a.svg", robustness=True)
    tachk.monitor("G (y > 5)", {"time": [0, 1], "y": [math.inf, math.inf]}).plot(tmp_path / "b.svg")


def test_a_text_that_no_row_has_is_reported(tmp_path: Path) -> None:
    trace = {"time": [0, 1, 2], "mode": ["idle", "busy", "idle"], "x": [1, 2, 3]}
    report = tachk.monitor(['G (mode != "idel")', 'F (mode == "busy")', 'G !("idel" == mode)'], trace)
    (warning,) = report.record.trace.warnings
    assert warning == 'the trace: no row of `mode` has the text "idel"; it has "busy", "idle"' or warning.endswith(
        'it has "idle", "busy"'
    )
    many = {"time": range(20), "mode": [f"m{n}" for n in range(20)]}
    (warning,) = tachk.monitor('G (mode != "x")', many).record.trace.warnings
    assert warning.endswith('"m7" and 12 others')
