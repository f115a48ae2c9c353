"""Traces judged on lines between rows, and robustness in time: verdicts, stories, reports, refusals."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema
import pytest

import tachk
from tachk.api.monitoring import MonitorReport
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.report.monitor.plot_rows import line
from tachk.report.monitor.signal_plot import draw_record
from tachk.report.monitor.words import explain_verdict

SCHEMA = Path(__file__).parents[4] / "docs/schema/monitor.schema.json"

TRACE = {
    "t": [0, 1, 4, 4, 10],
    "x": [0, 2, -1, 5, 2],
    "p": [0, 1, 0, 0, 1],
}


def on_lines(*formulas: str, **options: Any) -> MonitorReport:
    return tachk.monitor(formulas, TRACE, unit="s", interpolation="linear", **options)


def story(formula: str) -> tuple[str, ...]:
    record = on_lines(formula).record
    return explain_verdict(record, record.verdicts[0])


def test_a_violation_on_a_line_is_reported_with_what_was_seen_there() -> None:
    """From (1, 2) to (4, 5): of the two rows for one instant the last one counts."""
    assert story("G (rise(x >= 3) -> F[0, 1] x >= 4.5)") == (
        "trigger: `x >= 3` becomes true at 2 s",
        "`x >= 4.5` is never true from 2 s to 3 s, the deadline",
        "seen at 3 s: x = 4",
        "the violation is certain at 3 s",
    )


def test_crossings_are_reported_to_six_decimals() -> None:
    assert story("G (x <= 8 / 3)") == (
        "`x <= 8 / 3` is false at just after 1.666667 s",
        "seen at just after 1.666667 s: x = 2.66667",
        "violated from just after 1.666667 s until 8.666667 s",
    )


def test_what_is_open_at_the_end_stays_open() -> None:
    (verdict,) = on_lines("F[0, 20] x > 7")
    assert (verdict.truth, verdict.presumably) == (tachk.Truth.UNDETERMINED, tachk.Truth.FALSE)
    assert verdict.robustness == (-2, math.inf)


def test_a_trigger_that_never_happens_on_a_line_is_pointed_out() -> None:
    assert [v.vacuous for v in on_lines("G (x > 5 -> p)", "G (x > 4.9 -> x > 0)")] == [True, False]


def test_truth_values_do_not_move() -> None:
    held = tachk.monitor("G[0, 5] (p -> F[0, 3] !p)", TRACE, unit="s")
    assert on_lines("G[0, 5] (p -> F[0, 3] !p)").truth is held.truth


def test_windows_within_windows_leave_open_when_a_violation_is_certain() -> None:
    (verdict,) = on_lines("G (rise(x >= 3) -> F[0, 2] G[0, 1] x > 9)")
    assert verdict.finding is not None
    assert verdict.finding.decided is None
    assert on_lines("G (rise(x >= 3) -> F[0, 2] G[0, 1] x > 9)").to_dict()["results"][0]["finding"]["decided"] is None  # type: ignore[index,call-overload]


def test_several_formulas_with_bounds_of_different_fineness() -> None:
    report = on_lines("F[0, 1 / 3] x >= 0.66", "F[0, 0.001 s] x > 0.1", "G[0, 100000] x < 6")
    assert [v.truth.word for v in report] == ["true", "false", "undetermined"]


def test_products_changes_and_open_triggers_are_rejected_with_their_places() -> None:
    with pytest.raises(InputError) as error:
        on_lines("G x * x < 3", "F (change(x) || rise(x > 1))", "x > 1")
    assert [(d.code, d.span.text) for d in error.value.diagnostics] == [
        ("E0905", "x * x"),
        ("E0906", "x"),
        ("E0907", "x > 1"),
    ]


def test_bounds_that_leave_no_room_for_crossings_are_rejected_at_the_formula() -> None:
    with pytest.raises(InputError) as error:
        on_lines("F[0, 2e14] x > 5")
    assert [(d.code, d.span.start) for d in error.value.diagnostics] == [("E0903", 0)]


def test_arguments_without_meaning() -> None:
    with pytest.raises(UsageError, match="expected constant or linear"):
        tachk.monitor("x > 1", TRACE, interpolation="cubic")
    with pytest.raises(UsageError, match="values stay constant"):
        on_lines("x > 1", time_robustness=True)


def test_robustness_in_time_in_every_report() -> None:
    formulas = ("G[2, 9] (p -> F[0, 4] !p)", "F[5, 6] p", "F[12, 13] p")
    report = tachk.monitor(formulas, TRACE, unit="s", time_robustness=True)
    bounds = [(v.time_robustness.ahead, v.time_robustness.behind) for v in report if v.time_robustness is not None]
    assert bounds == [((1, 4), (2, 2)), ((-4, -4), (-1, -1)), ((-math.inf, math.inf), (-math.inf, math.inf))]
    assert "ahead [s]" in report.to_text()
    rows = report.to_rows()
    assert [rows[1][key] for key in ("ahead_low", "ahead_high", "behind_low", "behind_high")] == [-4, -4, -1, -1]
    data = report.to_dict()
    jsonschema.validate(json.loads(json.dumps(data)), json.loads(SCHEMA.read_text()))
    assert data["results"][2]["time_robustness"] == {"ahead": ["-inf", "inf"], "behind": ["-inf", "inf"]}  # type: ignore[index,call-overload]
    assert tachk.monitor("p", TRACE)[0].time_robustness is None


def test_the_machine_form_follows_its_schema() -> None:
    data = on_lines("G (rise(x >= 3) -> F[0, 1] x >= 4.5)", "G x <= 8 / 3", "F[0, 20] x > 7").to_dict()
    jsonschema.validate(json.loads(json.dumps(data)), json.loads(SCHEMA.read_text()))
    assert data["interpolation"] == "linear"
    assert "straight lines between rows</caption>" in on_lines("F x > p")._repr_html_()
    assert "straight lines between rows: x" in on_lines("F x > p").to_text()


def test_lines_are_drawn_as_lines(tmp_path: Path) -> None:
    report = on_lines("G (rise(x >= 3) -> F[0, 1] x >= 4.5)", "F p")
    trace = report.record.trace
    scale = trace.ticks_per_unit
    times, values = line(trace, "x", 0, trace.end)
    assert (times / scale).tolist() == [0, 1, 4, 10, 10]
    assert values.tolist() == [0, 2, 5, 2, 2]
    drawn = {curve.get_gid(): curve.get_drawstyle() for axis in draw_record(report.record).axes for curve in axis.lines}
    assert drawn["signal-x"] == "default"
    assert drawn["signal-p"] == "steps-post"
    report.plot(tmp_path / "a.svg", begin=2, end=3)
    assert "signal-x" in {element.get("id") for element in ElementTree.parse(tmp_path / "a.svg").iter()}
