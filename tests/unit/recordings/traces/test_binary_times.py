"""Times that were binary numbers: read as the decimals that are meant, by every reader alike, and told."""

import json
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.cli.commands.monitor import run_monitor
from tachk.cli.reporting import Reporting
from tachk.cli.row_by_row import RowByRow
from tachk.cli.trace_arguments import TraceArguments
from tachk.recordings.traces.conventions import EvaluationOptions
from tachk.recordings.traces.logs.joined import with_decimals
from tachk.recordings.traces.trace_files import open_trace

TENTHS = [0.0]
for _ in range(999):
    TENTHS.append(TENTHS[-1] + 0.1)


def written(path: Path, times: list[str]) -> Path:
    if path.suffix == ".csv":
        path.write_text("time,x\n" + "".join(f"{time},{row % 7}\n" for row, time in enumerate(times)))
    else:
        path.write_text("".join(f'{{"time": {time}, "x": {row % 7}}}\n' for row, time in enumerate(times)))
    return path


def clocks(path: Path, decimals: int | None = None) -> list[Fraction]:
    trace = with_decimals(open_trace(path), decimals).read()
    return [trace.clock(int(tick)) for tick in trace.times]


@pytest.mark.parametrize("ending", ["csv", "jsonl"])
@pytest.mark.parametrize("form", ["{!r}", "{:.17g}", "{:.20f}"])
def test_steps_of_a_tenth(tmp_path: Path, ending: str, form: str) -> None:
    path = written(tmp_path / f"a.{ending}", [form.format(time) for time in TENTHS])
    assert clocks(path) == [Fraction(row, 10) for row in range(1000)]
    assert open_trace(path).read().notes == ("times are rounded to 9 decimals",)
    report = tachk.monitor("G (x <= 6)", path)
    assert report.truth is tachk.Truth.TRUE
    assert report.to_dict()["notes"] == ["times are rounded to 9 decimals"]


@pytest.mark.parametrize("ending", ["csv", "jsonl"])
def test_multiples_and_what_is_said_row_by_row(tmp_path: Path, ending: str, capsys: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path / f"a.{ending}", [repr(row * 0.005) for row in range(200)])
    formula = "G (x == 0 -> F[0.03, 0.03] x == 6)"
    for rows in (RowByRow(), RowByRow(online=True)):
        run_monitor(TraceArguments(formula, str(path)), rows=rows, reporting=Reporting(form="json"))
        told = json.loads(capsys.readouterr().out)
        assert told["results"][0]["verdict"] == "undetermined"
        assert (told["end"], told["notes"]) == ("0.995", ["times are rounded to 9 decimals"])


@pytest.mark.parametrize("ending", ["csv", "jsonl"])
def test_exact_times_stay_exact(tmp_path: Path, ending: str) -> None:
    for times in (["0", "1.234567890123", "1.2345678901235"], ["1764000000.123456789", "1764000001"], ["1e-12", "1"]):
        path = written(tmp_path / f"a.{ending}", times)
        assert clocks(path) == [Fraction(time) for time in times]
        assert open_trace(path).read().notes == ()


@pytest.mark.parametrize("ending", ["csv", "jsonl"])
def test_neighbours_stay_apart(tmp_path: Path, ending: str) -> None:
    times = ["0.30000000000000004", "0.30000000010000003", "0.5"]
    found = clocks(written(tmp_path / f"a.{ending}", times))
    assert found[0] < found[1] < found[2]
    assert abs(found[1] - Fraction(times[1])) < Fraction(1, 10**12)


@pytest.mark.parametrize("ending", ["csv", "jsonl"])
def test_decimals_round_whole_traces_too(tmp_path: Path, ending: str) -> None:
    path = written(tmp_path / f"a.{ending}", ["0.0004", "0.1001", "0.1004", "2"])
    with pytest.raises((InputError, UsageError)):
        clocks(path, 3)
    path = written(tmp_path / f"b.{ending}", ["0.0004", "0.1004", "0.1015", "2"])
    assert clocks(path, 3) == [0, Fraction(1, 10), Fraction(102, 1000), 2]
    report = tachk.monitor("G (x < 9)", path, decimals=3)
    assert report.record.trace.notes == ("times are rounded to 3 decimals",)


def test_decimals_round_times_of_arrays() -> None:
    trace = {"time": np.array([0.0004, 0.1004, 2.0]), "x": [1, 2, 3]}
    read = with_decimals(open_trace(trace), 3).read()
    assert [read.clock(int(tick)) for tick in read.times] == [0, Fraction(1, 10), 2]
    with pytest.raises(UsageError, match="rows 1 and 2 differ, but with 0 decimals"):
        with_decimals(open_trace({"time": [0.0, 1.1, 1.2], "x": [1, 2, 3]}), 0).read()


def test_times_of_32_bits_are_the_decimals_that_they_print_as() -> None:
    times = np.arange(0, 1, 0.1, dtype=np.float32)
    trace = open_trace({"time": times, "x": list(range(10))}).read()
    assert trace.clock(int(trace.times[1])) == Fraction(1, 10)


def test_row_by_row_a_finer_exact_time_is_rejected(tmp_path: Path) -> None:
    path = written(tmp_path / "a.csv", ["0", "0.0000000001"])
    with pytest.raises(InputError):
        run_monitor(
            TraceArguments("G (x < 9)", str(path)),
            EvaluationOptions(),
            RowByRow(online=True),
            reporting=Reporting(quiet=True),
        )


@pytest.mark.parametrize("name", ["a.csv", "a.jsonl"])
def test_help_against_times_that_no_rounding_makes_countable(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    rows = ["time,x", "0,1", f"{2**63},2"] if name == "a.csv" else ['{"t": 0, "x": 1}', f'{{"t": {2**63}, "x": 2}}']
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    with pytest.raises((InputError, UsageError), match="leave out the rows with such a time"):
        open_trace(path).read(["x"])


def test_which_of_two_times_that_round_to_the_same_lies_before_is_exact(tmp_path: Path) -> None:
    for first, second, code in (("117302", "", "E0913"), ("", "117302", "E0915"), ("2173", "1173", "E0913")):
        times = ["1000000000.002000093460", f"1000000001.352000{first}", f"1000000001.352000{second}"]
        with pytest.raises(InputError) as found:
            clocks(written(tmp_path / "a.csv", times), 6)
        assert found.value.diagnostics[0].code == code
