"""What a notebook shows of models, reports and runs."""

from __future__ import annotations

import pickle
import sys
from pathlib import Path
from typing import Any

import pytest

import tachk
from tachk.model.builder import NetworkBuilder

ROOT = Path(__file__).parents[3]
FISCHER = ROOT / "models/classics/fischer.ta"


@pytest.fixture(scope="module")
def report() -> tachk.Report:
    return tachk.load(FISCHER, N=2, WAIT=9).verify(options=tachk.Options().off("symmetry"))


def test_a_model_is_a_picture_with_its_constants() -> None:
    model = tachk.load(FISCHER, N=3)
    assert repr(model) == f"<Model {FISCHER}, N=3>"
    html = model._repr_html_()
    assert "N = 3, " in html
    assert "<svg" in html
    assert repr(model.network) == "<Network of P(1), P(2), P(3)>"


def test_a_model_that_cannot_be_drawn_has_its_name() -> None:
    network = NetworkBuilder()
    a = network.process("P").location("a")
    network.process("Q").location("b", invariant=a.reached)
    assert tachk.Model(network.build(), "<mine>")._repr_html_() == "<p><b>&lt;mine&gt;</b></p>"


def test_a_report_has_its_runs_below_the_table() -> None:
    html = tachk.load(FISCHER, N=2).verify("A[] not P(1).critical", "E<> P(1).critical")._repr_html_()
    assert html.startswith("<table>")
    unexpected, expected = html.split("<details")[1:]
    assert unexpected.startswith(" open>")
    assert "q1 is violated by this run of 3 steps" in unexpected
    assert "idle → request" in unexpected
    assert not expected.startswith(" open")


def test_a_query_that_is_not_checked_is_in_the_table() -> None:
    model = tachk.loads("process P() { init location a; } system P; property s : control: A[] P.a;")
    assert "not checked: game query" in model.verify()._repr_html_()


def test_a_probability_is_in_the_table() -> None:
    model = tachk.loads("process P() { init location a; } system P; property s : Pr[<=10](<> P.a);")
    assert ">0.9245 to 1.0000</td>" in model.verify()._repr_html_()


def test_a_run_is_reported_by_names(report: tachk.Report) -> None:
    run = report.run("mutual_exclusion")
    assert run is not None
    assert repr(run) == "<Run of 6 steps about mutual_exclusion>"
    assert "P(1): idle → request" in str(run)
    assert run.states[0].locations == (("P(1)", "idle"), ("P(2)", "idle"))
    assert dict(run.states[-1].locations) == {"P(1)": "critical", "P(2)": "critical"}
    assert dict(run.states[-1].variables)["id"] == 2
    assert [len(step.event.moves) for step in run.steps if step.event] == [1] * 6
    assert "P(1): idle → request" in run._repr_html_()
    assert repr(pickle.loads(pickle.dumps(run))) == repr(run)


def test_where_there_is_no_run_there_is_none(report: tachk.Report) -> None:
    assert report["deadlock_free"].answer is tachk.Answer.HOLDS
    assert report.run("deadlock_free") is None


def test_values_are_in_the_table_and_in_rows() -> None:
    found = tachk.load(FISCHER, N=2).verify("sup{P(1).request}: P(1).x", "E<> P(1).critical")
    assert "P(1).x ≤ 10" in found._repr_html_().split("<details")[0]
    assert repr(found).endswith("q1: P(1).x ≤ 10, q2: holds>")
    assert repr(found[0]).startswith("<Verdict q1: P(1).x ≤ 10, sup")
    assert [row["values"] for row in found.to_rows()] == ["P(1).x ≤ 10", None]
    (line,) = [line for line in found.to_text().splitlines() if line.startswith("  q1 ")]
    assert "P(1).x ≤ 10" in line and "holds" not in line


PLAIN = """const int C = 1; int n; clock x;
process P() { init location A { invariant x <= 3; to B { guard x > C; } } location B; }
system P;
property reached : E<> P.B;
"""


def test_what_python_prints_is_what_the_program_prints() -> None:
    model = tachk.loads(PLAIN)
    times, deep = model.time(None, "P.B"), model.check()
    estimates = model.estimate("Pr[<=9](<> P.B)", "Pr[<=9](<> P.B) >= 0.5")
    assert str(times) == "best: > 1, worst: 3, waits: 3"
    assert repr(times) == "<Times best: > 1, worst: 3, waits: 3>"
    assert repr(times.worst) == "Extreme(value=3, strict=False)"
    assert len(repr(estimates[0])) < 500
    assert repr(model.time("P.B", "P.B")) == "<Times best: -, worst: -, waits: for ever>"
    assert repr(model.time(None, "P.B", limits=tachk.Limits(depth=0))).endswith("waits: ? (depth limit)>")
    assert repr(model.properties) == "(<Query reached: E<> P.B>,)"
    assert repr(deep) == "<DeepCheck of all states, findings: 2>"
    assert "time-locks " in str(deep) and "W0608: the variable `n` is never used" in str(deep)
    assert repr(estimates) == "<Estimates of <text>: q1: 0.9245 to 1.0000, q2: holds>"
    assert str(estimates) == estimates.to_text()
    assert repr(estimates[0].query) == "<StatisticalQuery q1: Pr[<=9](<> P.B)>"


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Every kind of result that functions and methods give, by its name."""
    model, gate = tachk.loads(PLAIN), tachk.load(ROOT / "models/classics/train_gate.ta", N=2)
    run = tmp_path_factory.mktemp("runs") / "b.run"
    run.write_text("+2 P: A -> B\n", encoding="utf-8")
    report = model.verify()
    drawn = tachk.simulate(gate, runs=3, until=50, record=["Controller.length", "Train(1)", "Controller.Free"])
    dimmer, captures = ROOT / "examples/dimmer", ROOT / "tests/data/captures"
    trace = {"time": [0, 1, 2], "x": [1, 2, 5]}
    return {
        "Report": report,
        "Verdict": report[0],
        "Run": report.run(0),
        "Times": model.time(None, "P.B"),
        "DeepCheck": model.check(),
        "Estimates": model.estimate("Pr[<=9](<> P.B)", "simulate [<=5; 2] {x}"),
        "Synthesis": model.synthesize("E<> P.B", over="C=0..4"),
        "Sweep": model.sweep("E<> P.B", over="C=0..1", processes=1),
        "Simulation": drawn,
        "DrawnRun": drawn[0],
        "Replay": tachk.replay(model, run),
        "MonitorReport": tachk.monitor("G (x < 3)", trace),
        "MiningReport": tachk.mine("G (x < C)", [trace], "C=0..9"),
        "Conformance": tachk.conform(dimmer / "dimmer.ta", dimmer / "too_soon.csv"),
        "Measurement": tachk.measure(captures / "losses_and_delays.pcap"),
    }


SHOWN = {
    "Report": "<Report on <text>: reached: holds>",
    "Verdict": "<Verdict reached: holds, E<> P.B>",
    "Run": "<Run of 1 step about reached>",
    "Times": "<Times best: > 1, worst: 3, waits: 3>",
    "DeepCheck": "<DeepCheck of all states, findings: 2>",
    "Estimates": "<Estimates of <text>: q1: 0.9245 to 1.0000, q2: 2 runs>",
    "Synthesis": "<Synthesis on <text>: q1 holds in 3 of 5 cells>",
    "Sweep": "<Sweep of <text>: 2 cells, q1: holds in 2>",
    "Simulation": "<3 runs>",
    "DrawnRun": "<run 0: 14 transitions until 50, horizon>",
    "Replay": "<Replay of 1 step: all of it is a run>",
    "MonitorReport": "<MonitorReport on the trace: p1: false>",
    "MiningReport": "<MiningReport p1: C > 5>",
    "Conformance": "is no run of",
    "Measurement": "quantities seen>",
}


@pytest.mark.parametrize("name", SHOWN)
def test_every_result_has_a_short_repr_and_a_table_with_the_rest_below(results: dict[str, Any], name: str) -> None:
    found = results[name]
    assert SHOWN[name] in repr(found) and len(repr(found)) < 250
    html = found._repr_html_()
    first = "<p>" if name == "Run" else "<table>"
    assert html.startswith(first)
    if "<details" in html:
        assert html.index("</table>") < html.index("<details")
    for tag in ("table", "tr", "td", "details", "summary", "pre", "code"):
        assert html.count(f"<{tag}>") + html.count(f"<{tag} ") == html.count(f"</{tag}>"), tag


@pytest.mark.parametrize("name", [name for name in SHOWN if name != "Verdict"])
def test_every_result_is_a_data_frame_and_rows(results: dict[str, Any], name: str) -> None:
    pytest.importorskip("pandas")
    rows, frame = results[name].to_rows(), results[name].to_frame()
    assert len(frame) == len(rows) > 0
    assert list(frame.columns) == list(dict.fromkeys(key for row in rows for key in row))
    for column in frame.columns:
        values = [row[column] for row in rows if row.get(column) is not None]
        if values and all(type(value) is int for value in values):
            assert frame[column].dtype in ("int64", "Int64"), column


def test_whole_numbers_stay_whole_where_some_are_missing() -> None:
    pytest.importorskip("pandas")
    frame = tachk.loads(PLAIN).verify("E<> P.B", "Pr[<=9](<> P.B)").to_frame()
    assert str(frame["states_stored"].dtype) == "Int64"
    assert frame["states_stored"].isna().tolist() == [False, True]


def test_without_pandas_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(tachk.UsageError, match=r"tachk\[data\]"):
        tachk.loads(PLAIN).verify().to_frame()


def test_pictures_are_shown_without_a_file(results: dict[str, Any], tmp_path: Path) -> None:
    for name in ("Sweep", "Synthesis", "MonitorReport"):
        assert "<svg" in results[name].plot()._repr_svg_()
    results["Sweep"].plot(tmp_path / "sweep.svg")
    assert (tmp_path / "sweep.svg").stat().st_size > 1000


def test_what_comes_from_a_model_is_escaped() -> None:
    model = tachk.loads(PLAIN, C=1)
    html = model.verify("E<> x < 2 && P.B")[0]._repr_html_()
    assert "x &lt; 2 &amp;&amp; P.B" in html and "x < 2" not in html


def test_an_error_shows_the_lines_of_the_user_in_a_notebook() -> None:
    with pytest.raises(tachk.InputError) as wrong:
        tachk.loads("process P() { init location a { to b; } } system P;")
    shown = wrong.value._render_traceback_()
    assert shown[:2] == ["InputError:", "<text>:1:36: error[E0209]: template `P` has no location `b`"]
    assert "^" in shown[3]
    with pytest.raises(tachk.UsageError) as usage:
        tachk.load("none.ta")
    assert usage.value._render_traceback_() == ["UsageError: there is no file none.ta"]


def test_functions_take_models_and_paths_alike(tmp_path: Path) -> None:
    path = tmp_path / "m.ta"
    path.write_text("property soon : G (P.A -> F[0, 4] P.B);\n".join([PLAIN, ""]), encoding="utf-8")
    model = tachk.load(path)
    trace = {"time": [0, 1, 6, 9], "P": ["A", "A", "B", "B"]}
    run = tmp_path / "b.run"
    run.write_text("+2 P: A -> B\n", encoding="utf-8")
    for one in (model, path, str(path)):
        assert tachk.export(one, "xta").startswith("const int C = 1;")
        assert bool(tachk.replay(one, run))
        assert repr(tachk.monitor(one, trace)) == "<MonitorReport on the trace: soon: false>"
        assert tachk.draw(one).svg.startswith("<svg")
        assert tachk.diff(one, path) == ""
        assert len(tachk.simulate(one, runs=2, until=9)) == 2


def test_a_loaded_model_is_simulated_as_its_file_is(tmp_path: Path) -> None:
    path = tmp_path / "doubled.ta"
    path.write_text(
        "double d = 0.5; int n; process P() { clock x; init location a { invariant x <= 2; "
        "to a { guard x >= 1; assign x = 0, d = d * 2.0, n = n + 1; } } } system P;",
        encoding="utf-8",
    )
    for one in (path, tachk.load(path), tachk.loads(path.read_text(encoding="utf-8"))):
        (run,) = tachk.simulate(one, until=10)
        assert run["d"].dtype == "float64" and run["n"].dtype == "int64"
        assert run["d"][-1] == 0.5 * 2 ** run["n"][-1]


def test_a_model_and_its_values_have_a_token_for_dask() -> None:
    tokenize = pytest.importorskip("dask.base").tokenize
    first, same, other = tachk.loads(PLAIN), tachk.loads(PLAIN), tachk.loads(PLAIN, C=2)
    assert tokenize(first) == tokenize(same) != tokenize(other)
