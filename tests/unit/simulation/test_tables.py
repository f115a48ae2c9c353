"""Files of runs, read again."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.main import app
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationOptions
from tachk.formats.loading.load import load_model
from tachk.formats.network_json.network import network_from_json, network_to_json
from tachk.recordings.traces.logs.set_of_runs import SeveralRuns
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.trace_files import open_trace
from tachk.simulation.columns import all_columns, chosen_columns, columns_for
from tachk.simulation.runs import Runs
from tachk.simulation.tables import decimal_time, parquet_of_runs, run_writer

MODEL = """
time_unit = 10 ms;
int[0, 9] count = 0;
process P() {
    clock x;
    init location On {
        invariant x <= 2;
        to way { guard x >= 1; assign x = 0; }
    }
    location Off { exponential_rate 1 : 3; to On { assign x = 0, count = (count + 1) % 10; } }
    branchpoint way { to On { probability 3; } to Off { probability 1; } }
}
signal odd = count % 2 == 1;
system P;
"""


def _trace(number: int = 0) -> Trace:
    network = tachk.loads(MODEL).network
    runs = Runs(network, all_columns(network))
    (run,) = runs.draw(
        SimulationOptions(5, 200 * TICKS_PER_UNIT), range(number, number + 1), RecordedChanges(observed=True)
    )
    return runs.trace(run)


@pytest.mark.parametrize("ending", ["csv", "jsonl", "parquet", "vcd"])
def test_a_run_is_read_as_it_was_written(ending: str, tmp_path: Path) -> None:
    trace = _trace()
    with run_writer(tmp_path / f"run-{{run}}.{ending}") as write:
        write(7, trace)
    names = {name: f"model.{name}" if ending == "vcd" else name for name in ("odd", "count")}
    read = open_trace(str(tmp_path / f"run-7.{ending}")).read(set(names.values()))
    for tick in range(0, trace.end, trace.end // 50):
        for name, shown in names.items():
            row = int(trace.times.searchsorted(tick, side="right")) - 1
            seconds = tick / trace.ticks_per_unit
            there = int(read.times.searchsorted(seconds * read.ticks_per_unit * _units(read, trace), side="right")) - 1
            assert trace.columns[name][row] == read.columns[shown][there], (name, tick)


def _units(read: Trace, written: Trace) -> float:
    """How many units of the one are a unit of the other."""
    assert written.unit == "ms"
    return {"": 1, "ms": 1, "us": 10**3, "ns": 10**6, "s": 1e-3}[read.unit]


def test_times_are_exact_and_in_the_unit_of_the_model() -> None:
    trace = _trace()
    assert trace.unit == "ms"
    assert trace.end == 2000 * TICKS_PER_UNIT
    assert trace.times[0] == 0
    assert trace.times[-1] == trace.end
    assert (trace.times[1:-1] % 10 == 0).all()
    assert decimal_time(1_500_000_001, 10**9) == "1.500000001"
    assert decimal_time(20 * 10**9, 10**9) == "20"


def test_one_table_holds_all_runs(tmp_path: Path) -> None:
    with run_writer(tmp_path / "runs.jsonl") as write:
        write(0, _trace(0))
        write(1, _trace(1))
    rows = [json.loads(line) for line in (tmp_path / "runs.jsonl").read_text(encoding="utf-8").splitlines()]
    assert {row["run"] for row in rows} == {0, 1}
    assert rows[0] == {"run": 0, "time [ms]": 0, "odd": False, "P": "On", "count": 0}


DRAWN = """
time_unit = 1 s;
double v = 0;
int n = 0;
process P() { init location A { exponential_rate 1; to A { assign v = v + random(2), n = (n + 1) % 9; } } location B; }
signal odd = n % 2 == 1;
system P;
"""


def test_parquet_has_one_schema_and_groups_of_many_rows(tmp_path: Path) -> None:
    from pyarrow import parquet

    model, path = tmp_path / "a.ta", tmp_path / "runs.parquet"
    model.write_text(DRAWN)
    # The first of these runs has no transition, so that its numbers are whole.
    command = ["simulate", str(model), "--runs", "2000", "--seed", "5", "--until", "0.3"]
    assert app.main([*command, "-o", str(path)], standalone_mode=False) == 0
    table = parquet.read_table(path)
    types = {field.name: str(field.type) for field in table.schema}
    expected = {"time": "duration[ns]", "odd": "bool", "P": "string", "n": "int64", "v": "double", "run": "int64"}
    assert types == expected
    assert (table.column("v")[0].as_py(), table.column("P")[0].as_py()) == (0.0, "A")
    assert set(table.column("run").to_pylist()) == set(range(2000))
    assert parquet.ParquetFile(path).num_row_groups == 1


def test_the_runs_of_a_parquet_file_are_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from pyarrow import parquet

    model, path = tmp_path / "a.ta", tmp_path / "runs.parquet"
    model.write_text(DRAWN)
    command = ["simulate", str(model), "--runs", "50", "--until", "3", "-o"]
    for file in (path, path.with_suffix(".csv")):
        assert app.main([*command, str(file)], standalone_mode=False) == 0
    read = parquet.read_table
    asked: list[list[str]] = []

    def counted(name: str, columns: list[str]) -> object:
        asked.append(columns)
        return read(name, columns=columns)

    monkeypatch.setattr(parquet, "read_table", counted)
    values = []
    for file in (path, path.with_suffix(".csv")):
        several = open_trace(file)
        assert isinstance(several, SeveralRuns)
        values.append({number: run.read(["n"]).columns["n"].tolist() for number, run in several.runs.items()})
    assert values[0] == values[1]
    assert len(values[0]) == 50
    assert asked == [["time", "run"], ["n"]]


def test_parquet_holds_few_rows_back(tmp_path: Path) -> None:
    from pyarrow import parquet

    times = np.arange(1000)
    trace = Trace("a", times, {"n": times.astype(np.float64)}, 999)
    rows = 0
    with run_writer(tmp_path / "runs.parquet") as write:
        for number in range(310):
            write(number, trace)
            rows += trace.rows
        (part,) = tmp_path.iterdir()
        assert part.stat().st_size > 100_000
    file = parquet.ParquetFile(tmp_path / "runs.parquet")
    assert (file.metadata.num_rows, file.num_row_groups) == (rows, 4)


@pytest.mark.parametrize(("unit", "nanoseconds"), [("s", 10**9), ("h", 3600 * 10**9)])
def test_durations_of_parquet_do_not_overflow(unit: str, nanoseconds: int, tmp_path: Path) -> None:
    from pyarrow import parquet

    with run_writer(tmp_path / "a.parquet") as write:
        write(0, Trace("a", np.array([0, 10**15 + 1]), {}, 10**15 + 1, 10**9, unit))
    assert parquet.read_table(tmp_path / "a.parquet").column("time")[1].value == (10**15 + 1) * nanoseconds // 10**9
    with pytest.raises(UsageError, match="292 years"), run_writer(tmp_path / "b.parquet") as write:
        write(0, Trace("a", np.array([0, 2**62]), {}, 2**62, 1, "d"))


@pytest.mark.parametrize("unit", ["ms", "us", "ns"])
def test_times_finer_than_nanoseconds_are_kept_in_parquet(unit: str, tmp_path: Path) -> None:
    path = tmp_path / "a.parquet"
    with run_writer(path) as write:
        write(
            0,
            Trace("a", np.array([0, 2 * 10**9 + 1, 10**15 + 1]), {"n": np.array([0.0, 1, 2])}, 10**15 + 1, 10**9, unit),
        )
    trace = open_trace(path).read(["n"])
    assert (trace.times.tolist(), trace.ticks_per_unit, trace.unit) == ([0, 2 * 10**9 + 1, 10**15 + 1], 10**9, unit)
    formula = f"G[0, 2 {unit}] (n == 0)"
    assert tachk.monitor(formula, path).truth is Truth.TRUE  # rounded to nanoseconds, `n` would be 1 too early


def test_numbers_of_a_dump_have_all_their_digits(tmp_path: Path) -> None:
    path = tmp_path / "a.vcd"
    values = {
        "third": np.array([0.1 + 0.2, 1 / 3]),
        "large": np.array([3.0, 1e300]),
        "whole": np.array([-(2.0**31) + 1, 2.0**31]),
    }
    with run_writer(path) as write:
        write(0, Trace("a", np.array([0, 1]), values, 1, 1, "s"))
    trace = open_trace(path).read(list(values))
    assert {name: trace.columns[name].tolist() for name in values} == {n: v.tolist() for n, v in values.items()}


def test_what_cannot_be_written_is_rejected(tmp_path: Path) -> None:
    with pytest.raises(UsageError), run_writer(tmp_path / "runs.txt"):
        pass
    with run_writer(tmp_path / "runs.vcd") as write:
        write(0, _trace(0))
        with pytest.raises(UsageError):
            write(1, _trace(1))


def test_rates_and_weights_survive_other_forms_of_the_model() -> None:
    network = tachk.loads(MODEL).network
    written = network_to_json(network)
    assert written["processes"][0]["edges"][0]["branch"]["weight"]
    assert network_to_json(network_from_json(written)) == written
    in_xml = tachk.loads(tachk.export(tachk.loads(MODEL), "xml")).network
    assert network_to_json(in_xml)["processes"] == written["processes"]


@pytest.mark.parametrize(
    ("name", "help"), [("P.Onn", "did you mean `P.On`?"), ("zzz", "there are: odd, P, count, P.On")]
)
def test_a_wrong_column_is_reported_with_those_that_there_are(name: str, help: str) -> None:
    with pytest.raises(UsageError) as told:
        chosen_columns(tachk.loads(MODEL).network, [name])
    assert told.value.help == help


ROWS = """
{unit}
bool b; int[-3, 5] n; {double}
broadcast chan c;
process P() {{
    clock x;
    init location A {{ invariant x <= 3; exponential_rate 2; to B {{ sync c!; assign b = !b, n = n % 5 + 1; }} }}
    location B {{ exponential_rate 1; to A {{ assign x = 0{more}; }} to C {{ assign n = -2; }} }}
    committed location C {{ to A {{ assign x = 0, n = 4; }} to D {{ probability 1; }} }}
    location D {{ invariant x <= 0; }}
}}
process Q() {{ init location A {{ to B {{ sync c?; }} }} urgent location B {{ to A; }} }}
signal s = n > 2;
system P, Q;
"""


@pytest.mark.parametrize("unit", ["", "time_unit = 1 s;", "time_unit = 10 ms;", "time_unit = 1 ns;"])
@pytest.mark.parametrize("double", [False, True])
@pytest.mark.parametrize("record", [[], ["n", "P.B"], ["P"]])
def test_runs_taken_together_have_the_rows_of_each(unit: str, double: bool, record: list[str], tmp_path: Path) -> None:
    from pyarrow import parquet

    path = tmp_path / "m.ta"
    more, variable = (", d = random(2)", "double d = 0;") if double else ("", "")
    path.write_text(ROWS.format(unit=unit, double=variable, more=more), encoding="utf-8")
    network = load_model(str(path), {}, keeps_doubles=True).network
    runs = Runs(network, columns_for(network, record, ()))
    drawing = SimulationOptions(4, 9 * TICKS_PER_UNIT)
    with run_writer(tmp_path / "each.parquet") as each, parquet_of_runs(tmp_path / "together.parquet") as together:
        for run in runs.draw(drawing, range(200), RecordedChanges(observed=True)):
            each(run.number, runs.trace(run))
            together(run, runs)
    expected, found = (parquet.read_table(tmp_path / f"{name}.parquet") for name in ("each", "together"))
    assert expected.num_rows > 400
    assert found.schema == expected.schema
    assert found.equals(expected)
