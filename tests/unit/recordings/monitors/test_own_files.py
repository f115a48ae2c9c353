"""What tachk writes it reads: a model's own properties on the files of its runs, as on the runs themselves."""

from dataclasses import replace
from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.cli.actions.judged import Judged
from tachk.cli.actions.monitor import run_monitor
from tachk.cli.actions.row_by_row import RowByRow
from tachk.cli.actions.simulation.formulas import columns_with
from tachk.cli.actions.simulation.models import simulated_model
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import Reporting
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationOptions
from tachk.recordings.monitors.formulas import read_formulas
from tachk.recordings.traces.node_signal import Truth
from tachk.simulation.runs import Runs
from tachk.simulation.tables import run_writer

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
system P, Q;
property soon : G (P(0).A -> F[0, 2] P(0).B);
property short : G (P(1).A -> F[0, 1.5] P(1).B);
property both : F (P(0).B && Q.D && n == 3);
property cells : G (t[0][1] <= 4 && (r.b -> r.a > -3)) && G (n >= -2);
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
    assert run_monitor(Judged(str(model), str(output))) is ExitStatus.NOT_AS_EXPECTED
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
        asked = Judged(str(model), str(output), names=(name,), decimals=9)
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
