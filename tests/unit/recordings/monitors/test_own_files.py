"""What tachk writes it reads: a model's own properties on the files of its runs, as on the runs themselves."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.cli.commands.monitor import run_monitor
from tachk.cli.exit_status import ExitStatus
from tachk.cli.main import app
from tachk.cli.reporting import Reporting
from tachk.cli.row_by_row import RowByRow
from tachk.cli.simulated_model import simulated_model
from tachk.cli.trace_arguments import TraceArguments
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationOptions
from tachk.recordings.monitors.formulas import read_formulas
from tachk.recordings.traces.node_signal import Truth
from tachk.simulation.formulas import columns_with
from tachk.simulation.runs import Runs
from tachk.simulation.tables import run_writer

pytestmark = pytest.mark.drawn

MODEL = """\
time_unit = UNIT;
int[-3, 5] n = 0; bool flag; int[-3, 5] t[2][2]; double level = 0.5;
typedef struct { int[-9, 9] a; bool b; } pair; pair r;
signal low = level < 2;
process P(const int[0,1] id) {
    clock x;
    init location A { invariant x <= 2; to B { guard x >= 1; assign x = 0, n = n >= 5 ? -3 : n + 1, t[0][id] = n; } }
    location B { invariant x <= 2; to A { assign x = 0, flag = !flag, level = level * 1.25, r.a = n, r.b = flag; } }
}
process Q() { init location C { exponential_rate 1; to D { } } location D { exponential_rate 2; to C { } } }
process R() { init location Only; }
system P, Q, R;
property soon : G (P(0).A -> F[0, 2] P(0).B);
property short : G (P(1).A -> F[0, 1.5] P(1).B);
property both : F (P(0).B && Q.D && n == 3);
property cells : G (t[0][1] <= 4 && (r.b -> r.a > -3)) && G (n >= -2);
property only : G (R.Only && n >= -3);
property high : G (low || flag || level > 2.1);
"""


@pytest.fixture(params=["1 s", "1 ms"])
def model(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    path = tmp_path / "m.ta"
    path.write_text(MODEL.replace("UNIT", request.param))
    return path


def runs_of(model: Path, count: int, output: Path) -> list[dict[str, Truth]]:
    """Writes runs, and the verdicts on them as `simulate --monitor` has them."""
    network = simulated_model(str(model)).network
    formulas = read_formulas(str(model))
    drawing = SimulationOptions(7, 20 * TICKS_PER_UNIT)
    written = Runs(network, columns_with(network, (), ()))
    with run_writer(output) as write:
        for run in written.draw(drawing, range(count), RecordedChanges(observed=True)):
            write(run.number, written.trace(run))
    drawn = Runs(network, columns_with(network, (), formulas))
    runs = drawn.draw(drawing, range(count), RecordedChanges(observed=True))
    traces = [replace(drawn.trace(run), known_before=None) for run in runs]  # a file does not tell that its run goes on
    return [truths(tachk.monitor(list(formulas), trace)) for trace in traces]


def truths(report: tachk.MonitorReport) -> dict[str, Truth]:
    return {verdict.name: verdict.truth for verdict in report}


@pytest.mark.parametrize("ending", ["csv", "jsonl", "vcd", "parquet"])
def test_the_properties_of_a_model_on_its_runs(model: Path, ending: str) -> None:
    if ending == "parquet":
        pytest.importorskip("pyarrow")
    output = model.with_name(f"{{run}}.{ending}")
    expected = runs_of(model, 6, output)
    assert {truth for found in expected for truth in found.values()} >= {Truth.FALSE, Truth.TRUE}
    files = [model.with_name(f"{number}.{ending}") for number in range(6)]
    assert [truths(tachk.monitor(model, file)) for file in files] == expected


@pytest.mark.parametrize("ending", ["csv", "jsonl", "parquet"])
def test_several_runs_in_one_file(model: Path, ending: str, capsys: pytest.CaptureFixture[str]) -> None:
    if ending == "parquet":
        pytest.importorskip("pyarrow")
    output = model.with_name(f"runs.{ending}")
    expected = runs_of(model, 4, output)
    assert [truths(tachk.monitor(model, output, run=number)) for number in range(4)] == expected
    with pytest.raises(UsageError, match="holds several runs: 0, 1, 2, 3"):
        tachk.monitor(model, output)
    assert run_monitor(TraceArguments(str(model), str(output))) is ExitStatus.NOT_AS_EXPECTED
    told = capsys.readouterr().out
    counts = {truth: sum(found["short"] is truth for found in expected) for truth in Truth}
    words = (
        f"true on {counts[Truth.TRUE]}, false on {counts[Truth.FALSE]}, undetermined on {counts[Truth.UNDETERMINED]}"
    )
    assert f"short: {words}" in told


@pytest.mark.parametrize("ending", ["csv", "jsonl"])
def test_row_by_row(model: Path, ending: str) -> None:
    output = model.with_name(f"one.{ending}")
    expected = runs_of(model, 1, output)[0]
    for name, truth in expected.items():
        asked = TraceArguments(str(model), str(output), names=(name,), decimals=9)
        status = run_monitor(asked, rows=RowByRow(online=True), reporting=Reporting(quiet=True))
        assert (status is ExitStatus.NOT_AS_EXPECTED) is (truth is Truth.FALSE)


def test_locations_in_data_frames() -> None:
    trace = {"time": [0, 1, 2], "P": ["A", "B", "A"], "n": [0, 1, 2]}
    report = tachk.monitor("G (P.A -> n != 1)", trace)
    assert (report.truth, report[0].formula) == (Truth.TRUE, "G (P.A -> n != 1)")
    assert tachk.monitor("F P.C", trace).truth is Truth.FALSE


def test_several_runs_that_are_damaged(tmp_path: Path) -> None:
    path = tmp_path / "runs.csv"
    path.write_text("run,time,x\n# a, note, here\n0,0,1\n0,2,5\n1,0,1\n1,3")
    trace = tachk.monitor("G (x < 9)", path, run=1).record.trace
    assert (trace.rows, len(trace.warnings)) == (1, 1)
    for text in ("run,time,x\n", "run,time,x\n0,0,1\n1,soon,1\n", "run,time,x\n0,0,1\n1,nan,1\n", "run,time,x\n0\n1\n"):
        path.write_text(text)
        with pytest.raises((UsageError, InputError)):
            tachk.monitor("G (x < 9)", path)


LOCATED = ("G (P.B -> F[0, 3] P.A)", "G (P.A || P.B)", 'G (P.B -> P != "A")', "F (P.C && O[0, 2] P.B)", "G Q.Only")
CALLS: tuple[tuple[float, dict[str, str | None]], ...] = (
    (0, {"P": "A", "Q": "Only"}),
    (1, {"P": "B"}),
    (2, {"P": None}),
    (3, {"P": "C", "Q": None}),
    (3, {"P": "A"}),
    (8, {"P": "B"}),
    (12, {}),
)


def test_locations_in_rows_that_are_given_one_by_one() -> None:
    columns = {name: [given.get(name) for _, given in CALLS] for name in "PQ"}
    whole = tachk.monitor(list(LOCATED), {"time": [time for time, _ in CALLS], **columns})
    expected = [verdict.truth for verdict in whole]
    assert set(expected) == {Truth.TRUE, Truth.FALSE}
    monitor, pushed = (tachk.Monitor(list(LOCATED), robustness=True) for _ in range(2))
    for time, given in CALLS:
        monitor.update(time, given)
    for part in (slice(0, 1), slice(1, 1), slice(1, 4), slice(4, None)):
        cells = {name: np.array(cells[part], dtype=object) for name, cells in columns.items()}
        pushed.push(np.array([int(time) for time, _ in CALLS[part]], dtype=np.int64), cells, 0)
    for each in (monitor, pushed):
        found = each.finish()
        assert [verdict.truth for verdict in found] == expected
        assert [verdict.robustness for verdict in found] == [verdict.robustness for verdict in whole]


def test_a_column_called_like_a_location_comes_first_in_rows() -> None:
    monitor = tachk.Monitor("G P.A")
    for time, text in enumerate("AB"):
        assert monitor.update(time, {"P": text, "P.A": True}) is Truth.UNDETERMINED
    assert monitor.finish()[0].truth is Truth.TRUE
    with pytest.raises(UsageError, match=r"column 'P\.A' has no value yet"):
        tachk.Monitor("G P.A").update(0, {"P": 1})


def test_locations_in_json_lines_that_come(tmp_path: Path) -> None:
    file = tmp_path / "a.jsonl"
    file.write_text('{"time": 0, "n": 1}\n{"time": 1, "P": "A"}\n{"time": 2, "P": "B"}\n{"time": 3, "n": 2}\n')
    call = ["monitor", "G (P.B -> n == 1)", str(file), "--quiet"]
    assert [CliRunner().invoke(app, [*call, *more]).exit_code for more in ((), ("--online",))] == [10, 10]
    call[1] = "G (P.A -> n == 1)"
    assert [CliRunner().invoke(app, [*call, *more]).exit_code for more in ((), ("--online",))] == [0, 0]
