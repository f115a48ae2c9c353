"""Pictures of judged traces: files that can be read, with the groups that belong there, the same for the same input."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.image import imread

import tachk
from tachk.api.monitoring import MonitorReport
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.node_signal import NodeSignal, Truth
from tachk.recordings.traces.trace import Trace
from tachk.report.monitor.plot_rows import SignalBand, bands_of, formula_rows, steps, thresholds
from tachk.report.monitor.signal_plot import draw_record

TRACE = {
    "t": [0, 1, 2, 4, 6, 9, 12, 15, 20],
    "p": [0, 1, 1, 0, 0, 0, 1, 0, 0],
    "q": [0, 0, 0, 0, 0, 1, 0, 0, 0],
    "x": [1, 2, 3, 5, 2, 1, 0, 7, 1],
}


@pytest.fixture
def report() -> MonitorReport:
    return tachk.monitor(["G (p -> F[0,3] (q && x < 5))", "G (rise(p) -> F[0,10] q)"], TRACE, unit="s")


def identifiers(path: Path) -> set[str]:
    return {element.get("id", "") for element in ElementTree.parse(path).iter()}


def test_an_svg_has_a_group_for_everything(report: MonitorReport, tmp_path: Path) -> None:
    report.plot(tmp_path / "a.svg")
    found = identifiers(tmp_path / "a.svg")
    assert {"signal-p", "signal-q", "signal-x", "formula-p1", "formula-p2", "trigger-p1", "deadline-p1"} <= found
    root = len(report[0].program.nodes) - 1
    assert {f"band-p1-{root}-true", f"band-p1-{root}-false"} <= found
    assert f"band-p2-{len(report[1].program.nodes) - 1}-undetermined" in found
    text = (tmp_path / "a.svg").read_text()
    assert "p1: false" in text
    assert "p2: undetermined, presumably false" in text


def test_the_same_input_gives_the_same_svg(report: MonitorReport, tmp_path: Path) -> None:
    report.plot(tmp_path / "a.svg")
    report.plot(tmp_path / "b.svg")
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def test_a_notebook_shows_what_a_file_would_hold(report: MonitorReport, tmp_path: Path) -> None:
    shown = report.plot()
    report.plot(tmp_path / "a.svg")
    assert shown._repr_svg_() == (tmp_path / "a.svg").read_text(encoding="utf-8")


def test_a_png_is_a_picture(report: MonitorReport, tmp_path: Path) -> None:
    report.plot(tmp_path / "a.png")
    height, width = imread(tmp_path / "a.png").shape[:2]
    assert width == 1350
    assert height > 500


def test_a_part_of_the_trace_can_be_drawn(report: MonitorReport, tmp_path: Path) -> None:
    report.plot(tmp_path / "a.svg", begin=5, end=9)
    assert not {"trigger-p1", "deadline-p1"} & identifiers(tmp_path / "a.svg")
    with pytest.raises(UsageError, match="the trace has nothing"):
        report.plot(tmp_path / "a.svg", begin=9, end=5)
    with pytest.raises(UsageError, match="pictures are written as"):
        report.plot(tmp_path / "a.gif")


def test_true_false_and_undetermined_differ_in_black_and_white(report: MonitorReport) -> None:
    figure = draw_record(report.record)
    looks = {}
    for axis in figure.axes:
        for collection in axis.collections:
            name = str(collection.get_gid() or "")
            if name.startswith("band-"):
                red, green, blue, _ = collection.get_facecolor()[0]
                looks[name.split("-")[3]] = (collection.get_hatch(), 0.3 * red + 0.59 * green + 0.11 * blue)
    assert len({hatch for hatch, _ in looks.values()}) == 3
    assert looks["false"][1] - looks["true"][1] > 0.4


def test_rows_leave_out_what_signals_show(report: MonitorReport) -> None:
    assert formula_rows(report[0]).texts == (
        "G (p -> F[0, 3] (q && x < 5))",
        "p -> F[0, 3] (q && x < 5)",
        "F[0, 3] (q && x < 5)",
        "q && x < 5",
        "x < 5",
    )
    assert thresholds(report.record.verdicts, "x") == [5]
    assert thresholds(report.record.verdicts, "q") == []


def test_bands_are_clipped_and_never_vanish() -> None:
    signal = NodeSignal(np.array([0, 4, 5, 21]), np.array([0, 1, 0, 2], dtype=np.uint8), 41)
    assert bands_of(signal, Truth.TRUE, 0, 20, 0.5) == [SignalBand(2, 2.5, True)]
    assert bands_of(signal, Truth.FALSE, 1, 20, 0.5) == [SignalBand(1, 10)]
    assert bands_of(signal, Truth.UNDETERMINED, 0, 15, 0.5) == [SignalBand(10, 15)]
    at_the_end = NodeSignal(np.array([0, 40]), np.array([1, 0], dtype=np.uint8), 41)
    assert bands_of(at_the_end, Truth.FALSE, 0, 20, 0.5) == [SignalBand(19.5, 20, True)]


def test_long_traces_are_drawn_by_their_extremes() -> None:
    count = 100_000
    values = np.zeros(count)
    values[77_777] = 9
    trace = Trace("t", np.arange(count), {"x": values}, count)
    times, shown = steps(trace, "x", 0, count)
    assert len(times) < 5000
    assert shown.max() == 9
    assert (np.diff(times) >= 0).all()


@pytest.mark.parametrize(("value", "level"), [(1e308, 5), (-1e301, 5)])
def test_numbers_that_no_axis_holds_are_rejected(value: float, level: float, tmp_path: Path) -> None:
    report = tachk.monitor(f"G (x < {level})", {"t": [0, 1, 2], "x": [0, value, 0]}, unit="s")
    with pytest.raises(UsageError, match="`x` cannot be drawn"):
        report.plot(tmp_path / "a.svg")


def test_large_numbers_are_drawn(tmp_path: Path) -> None:
    tachk.monitor("G (x < 5)", {"t": [0, 1, 2], "x": [0, 1e300, -1e300]}, unit="s").plot(tmp_path / "a.svg")
    assert "signal-x" in identifiers(tmp_path / "a.svg")


def test_values_with_names_are_drawn_by_their_names(tmp_path: Path) -> None:
    rows = (
        "time [ms],Controller\n0,Idle\n334.610902351,Sending\n360,Idle\n665.789774905,Sending\n786,Failed\n815,Failed\n"
    )
    (tmp_path / "t.csv").write_text(rows)
    formula = 'G (rise(Controller == "Sending") -> F[0, 110 ms] Controller == "Idle")'
    report = tachk.monitor(formula, tmp_path / "t.csv")
    figure = draw_record(report.record)
    signal, table = figure.axes
    assert [label.get_text() for label in signal.get_yticklabels()] == ["Idle", "Sending", "Failed"]
    assert signal.lines[0].get_ydata().tolist() == [0, 1, 0, 1, 2, 2, 2]
    assert [label.get_text() for label in table.get_yticklabels()][-2:] == [
        'Controller == "Idle"',
        'Controller == "Sending"',
    ]
    marks = {text.get_text(): text.get_window_extent() for text in signal.texts}
    assert set(marks) == {"trigger 665.8 ms", "deadline 775.8 ms"}
    first, second = marks.values()
    assert not first.overlaps(second)
    assert all(box.x0 >= 0 and box.x1 <= figure.bbox.x1 for box in marks.values())
