"""Text files that end within a number or a word: nothing half written is taken for a value without a word."""

from fractions import Fraction
from pathlib import Path

import pytest

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.trace_files import open_trace

# the code of x begins that of y, and values, codes and times have several characters
DUMP = """$timescale 1 ms $end
$scope module m $end
$var real 64 ! x $end
$var wire 1 !a y $end
$var wire 8 bc z $end
$upscope $end
$enddefinitions $end
#0
$dumpvars
r1.5 !
0!a
b101 bc
$end
#5
1!a
r12.34 !
#110
b1101 bc
0!a
#1200
r-7.25 !
"""

LINES = '{"time": 0, "x": 1.5}\n{"time": 5, "x": 12.34}\n{"time": 110, "x": -7.25}\n'

TABLE = "time,x,y\n0,1.5,2\n5,12.34,-3.25\n110,-7.25,41\n"


def values_at(trace: Trace, column: str) -> dict[Fraction, list[float]]:
    """The values that rows give a column, with those before a row, at the times of the clock."""
    found: dict[Fraction, list[float]] = {}
    before: list[float] = []
    for tick, value in zip(trace.times.tolist(), trace.columns[column].tolist(), strict=True):
        found.setdefault(trace.clock(tick), list(before)).append(value)
        before = [value]
    return found


@pytest.mark.parametrize("name", ["log.vcd", "log.csv", "log.jsonl"])
def test_cut_everywhere(tmp_path: Path, name: str) -> None:
    text = {"log.vcd": DUMP, "log.csv": TABLE, "log.jsonl": LINES}[name]
    path = tmp_path / name
    path.write_text(text)
    whole = open_trace(path).read()
    read = 0
    for size in range(len(text)):
        path.write_text(text[:size])
        try:
            trace = open_trace(path).read()
        except (InputError, UsageError):
            continue  # nothing is there yet
        read += 1
        assert trace.clock(trace.end) <= whole.clock(whole.end)
        told = any("half written" in each for each in (*trace.notes, *trace.warnings))
        if told and not trace.warnings:
            continue
        for column in trace.columns:
            known = values_at(whole, column)
            for time, values in values_at(trace, column).items():
                held = {value for earlier in known if earlier <= time for value in known[earlier]}
                assert set(values) <= held, (size, column)
                assert values[-1] in known.get(time, values), (size, column)
    assert read > len(text) // 5


@pytest.mark.parametrize(
    ("end", "rows", "half"),
    [
        ("#5\n1!", 1, True),  # of x and not of y, had it been whole
        ("#5\n1!a", 2, False),
        ("#5\nr12.3", 1, True),
        ("#5\nr12.3 ", 1, True),
        ("#5 r12.3 !a", 2, False),
        ("#5\nr12.3 !", 1, True),
        ("#5\n1!a\n#", 2, True),
        ("#5\n1!a\n#1", 2, True),
    ],
)
def test_the_last_word_of_a_dump(tmp_path: Path, end: str, rows: int, half: bool) -> None:
    path = tmp_path / "log.vcd"
    path.write_text(DUMP[: DUMP.index("#5")] + end)
    trace = open_trace(path).read(["m.y"] if "r12" not in end or not half else ["m.x"])
    assert any("cut off: the end of line" in each for each in trace.warnings) == half
    assert trace.columns[next(iter(trace.columns))].tolist()[0] in (0, 1.5)
    changed = len(set(trace.columns[next(iter(trace.columns))].tolist()))
    assert changed == rows


def test_a_last_time_without_a_line_break(tmp_path: Path) -> None:
    path = tmp_path / "log.vcd"
    path.write_text(DUMP[: DUMP.index("#1200")] + "#120")
    trace = open_trace(path).read()
    assert trace.end == 120
    assert trace.warnings == ()
    assert trace.notes == ("the last line has no line break: if the file is cut off, its time may be half written",)


def test_a_last_cell_without_a_line_break(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text(TABLE[:-2])
    told = ("the last line has no line break: if the file is cut off, its y may be half written",)
    assert open_trace(path).read().notes == told
    assert open_trace(path).read(["x"]).notes == ()
    path.write_text(TABLE)
    assert open_trace(path).read().notes == ()


@pytest.mark.parametrize("length", [0, 1, 7, 8])
def test_messages_that_end_within_what_begins_a_file(length: int, tmp_path: Path) -> None:
    pytest.importorskip("mcap")
    path = tmp_path / "log.mcap"
    path.write_bytes(b"\x89MCAP0\r\n"[:length])
    with pytest.raises(UsageError, match="is cut off before its first message"):
        open_trace(path).read(["a.x"])
