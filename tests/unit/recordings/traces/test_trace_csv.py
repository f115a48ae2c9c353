"""CSV: exact times, values, held cells; every mistake has its place; pieces may be cut anywhere."""

from __future__ import annotations

import io
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tachk import _core
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.base.diagnostics.explanation import explanations
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.trace_csv import open_csv, open_csv_stream

TRACE_CODES = explanations("traces")


def read(text: str | bytes, columns: list[str] | None = None, **options: str) -> Trace:
    data = text if isinstance(text, bytes) else text.encode()
    return open_csv_stream(io.BufferedReader(io.BytesIO(data)), "t.csv", **options).read(columns)


def fault(text: str | bytes, columns: list[str] | None = None) -> tuple[str, str]:
    with pytest.raises(InputError) as error:
        read(text, columns)
    (diagnostic,) = error.value.diagnostics
    return diagnostic.code, str(diagnostic.span)


def test_times_are_exact_decimals_from_the_first_row_on() -> None:
    trace = read("time,x\n1700000000.1,1\n1700000000.25,2\n17000000010e-1,3\n")
    assert trace.times.tolist() == [0, 15, 90]
    assert (trace.ticks_per_unit, trace.end, trace.origin) == (100, 90, Fraction("1700000000.1"))
    assert trace.clock(15) == Fraction("1700000000.25")


def test_values_are_numbers_or_truth_values() -> None:
    trace = read("t,a,b,c,d\n0,true,0,1,-1.5\n1,FALSE,1,0.5,+2e3\n")
    assert {name: (values.dtype.kind, values.tolist()) for name, values in trace.columns.items()} == {
        "a": ("u", [1, 0]),
        "b": ("u", [0, 1]),
        "c": ("f", [1.0, 0.5]),
        "d": ("f", [-1.5, 2000.0]),
    }


def test_empty_cells_hold_the_value_before() -> None:
    trace = read("t,a,b\n0,1,2.5\n1,,\n2,0, \n")
    assert trace.columns["a"].tolist() == [1, 1, 0]
    assert trace.columns["b"].tolist() == [2.5, 2.5, 2.5]


def test_comments_blank_lines_line_ends_and_quotes() -> None:
    trace = read('\ufeff# made by hand\r\n\r\n"time [ms]";"a b"\r\n# here\r\n0;"1.5"\r\n\r\n5; 2 ')
    assert trace.unit == "ms"
    assert trace.columns["a b"].tolist() == [1.5, 2.0]
    assert trace.times.tolist() == [0, 5]


def test_only_the_wanted_columns_have_to_be_numbers() -> None:
    trace = read(',time,note,x\n7,0,"a, ""b""",1\n8,1,c,2\n', ["x"])
    assert list(trace.columns) == ["x"]
    assert fault(',time,note,x\n7,0,"a, ""b""",1\n', ["note"]) == ("E0911", "t.csv:2:5")


@pytest.mark.parametrize("word", ["nan", "NaN", "-nan", "NA", "null", '"nan"', " nan "])
def test_what_other_programs_write_for_no_value_means_that_the_value_stays(word: str) -> None:
    assert read(f"t,x\n0,1.5\n1,{word}\n2,2\n").columns["x"].tolist() == [1.5, 1.5, 2.0]


def test_rows_of_one_instant_are_kept_in_order() -> None:
    assert read("t,x\n0,1\n0,2\n0,3\n").times.tolist() == [0, 0, 0]


def test_the_time_column_and_its_unit_can_be_given() -> None:
    text = "a,b\n1,2\n3,4\n"
    with pytest.raises(UsageError, match="no column time, t or timestamp"):
        read(text)
    trace = read(text, time="b", unit="ms")
    assert (list(trace.columns), trace.unit, trace.origin) == (["a"], "ms", 2)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("time,p\n0,1\n2,1\n1,0\n", ("E0913", "t.csv:4:1")),
        ("time,p\n0,1\n# x\n1,ä\n", ("E0911", "t.csv:4:3")),
        ("time,é,p\n0,1,1\n1,1,x1\n", ("E0911", "t.csv:3:5")),
        ("time,p\n0,1e999\n", ("E0911", "t.csv:2:3")),
        ("time,p\n0,true\n1,2\n", ("E0911", "t.csv:3:3")),
        ("time,p\n0,2\n1,true\n", ("E0911", "t.csv:3:3")),
        ('time,p\n0,"1\n', ("E0911", "t.csv:2:3")),
        ("time,p\n0,1\n,1\n", ("E0912", "t.csv:3:1")),
        ("time,p\n0,1\n1\n2,1\n", ("E0914", "t.csv:3:2")),
        ("time,p\n0,1\n1,1,\n", ("E0914", "t.csv:3:5")),
        ("time,p\n123456789012345678901,1\n", ("E0915", "t.csv:2:1")),
        ("time,p\n1e-19,1\n", ("E0915", "t.csv:2:1")),
        ("time,p\n9000000000000000000,1\n", ("E0915", "t.csv:2:1")),
        ("0,1\n1,0\n", ("E0916", "t.csv:1:1")),
    ],
)
def test_every_mistake_has_its_place(text: str, expected: tuple[str, str]) -> None:
    assert fault(text) == expected


@pytest.mark.parametrize("code", [code for code, explanation in TRACE_CODES.items() if explanation.bad])
def test_the_examples_of_the_explanations(code: str) -> None:
    assert fault(TRACE_CODES[code].bad)[0] == code
    assert read(TRACE_CODES[code].good).rows


@pytest.mark.parametrize("text", ["", "\n# nothing\n", "time,p\n", "time,p,p\n0,1,1\n", "time [fortnight],p\n0,1\n"])
def test_what_is_no_trace_is_rejected(text: str) -> None:
    with pytest.raises(UsageError):
        read(text)


def test_a_missing_column_is_named_with_its_likeness() -> None:
    with pytest.raises(UsageError) as error:
        read("time,speed\n0,1\n", ["sped"])
    assert error.value.help == "did you mean 'speed'?"


def test_missing_files() -> None:
    with pytest.raises(UsageError, match="there is no file"):
        open_csv("no/such.csv")


def core(text: bytes, cuts: list[int], decimals: int = 0, texts: tuple[int, ...] = ()) -> tuple[object, ...]:
    reader = _core.CsvReader(
        separator=",",
        point=".",
        cells=3,
        time=0,
        columns=[1, 2],
        texts=texts,
        arrivals=(),
        unread=(),
        dates=False,
        first_line=1,
        decimals=decimals,
        most_decimals=18,
        usual_decimals=9,
        binary=False,
        rounding=False,
        shortening=True,
    )
    edges = [0, *sorted(cut % (len(text) + 1) for cut in cuts), len(text)]
    for begin, end in pairwise(edges):
        reader.feed(text[begin:end])
    reader.finish()
    times, columns, labels = reader.take()
    return times.tolist(), reader.decimals(), [(c.dtype.kind, c.tolist()) for c in columns], labels, reader.fault()


CELLS = st.sampled_from(["0", "1", "true", "-2.5", "1e-3", "", " 7 ", '"3"', "x", "123456789.123456789", "1e400"])
LINES = st.one_of(
    st.tuples(st.decimals(0, 9, places=2), CELLS, CELLS).map(lambda row: f"{row[0]},{row[1]},{row[2]}"),
    st.sampled_from(["# note", "", "1,2", "1,2,3,4"]),
)


@given(st.lists(LINES, max_size=8), st.sampled_from(["\n", "\r\n"]), st.booleans(), st.lists(st.integers(0, 400)))
def test_it_does_not_matter_where_pieces_are_cut(lines: list[str], ending: str, last: bool, cuts: list[int]) -> None:
    text = (ending.join(lines) + (ending if last else "")).encode()
    assert core(text, cuts) == core(text, [])
    assert core(text, cuts, texts=(2,)) == core(text, [], texts=(2,))


@given(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=1, max_size=20), st.data())
def test_numbers_are_read_as_python_reads_them(numbers: list[float], data: st.DataObject) -> None:
    forms = [data.draw(st.sampled_from([repr(x), f"{x:.3f}", f"{x:.17e}", f"{x:+.1f}"])) for x in numbers]
    text = "".join(f"{i},{form},0\n" for i, form in enumerate(forms)).encode()
    (_, values) = core(text, [])[2][0]  # type: ignore[index]
    assert values == [float(form) for form in forms]


@given(st.lists(st.decimals(0, 10**6, places=6), min_size=1, max_size=10).map(sorted))
def test_times_are_exact(times: list[object]) -> None:
    text = "".join(f"{time},0,0\n" for time in times).encode()
    ticks, decimals, _, _, problem = core(text, [])
    assert problem is None
    assert [Fraction(tick, 10**decimals) for tick in ticks] == [Fraction(str(time)) for time in times]  # type: ignore


def test_blocks_give_the_rows_of_the_whole(tmp_path: Path) -> None:
    path = tmp_path / "long.csv"
    path.write_text("t,x,p\n" + "".join(f"{i / 4:.2f},{i % 7},{i % 2}\n" for i in range(200_000)))
    whole = open_csv(path).read()
    blocks = list(open_csv(path).blocks(["x", "p"], 3))
    assert len(blocks) > 1
    assert np.concatenate([block.times for block in blocks]).tolist() == (whole.times * 10).tolist()
    for name in ("x", "p"):
        assert np.concatenate([block.columns[name] for block in blocks]).tolist() == whole.columns[name].tolist()


def test_blocks_reject_times_that_are_finer_than_said(tmp_path: Path) -> None:
    path = tmp_path / "fine.csv"
    path.write_text("t,x\n0.5,1\n0.75,1\n")
    blocks = open_csv(path).blocks(["x"], 1)
    assert next(blocks).times.tolist() == [5]
    with pytest.raises(InputError) as error:
        next(blocks)
    assert error.value.diagnostics[0].code == "E0915"


@pytest.mark.parametrize(
    ("text", "help"),
    [
        ("t;x\n0.5;1,5\n", "numbers have a decimal point: 1.5"),
        ("t;x\n0.5;1\n0,75;1\n", "numbers have a decimal point: 0.75"),
        ('t,x\n0,"1,000"\n', "without separators of thousands: 1000"),
        ("t,x\n0,1\n2024-01-31T12:00:00,1\n", "then all times are dates"),
        ("t,x\nsoon,1\n", "times are numbers such as"),
        ("t,x\n0,yes\n", "true or false"),
        ("t,x\n0,1e999\n", "write inf"),
    ],
)
def test_advice_on_cells(text: str, help: str) -> None:
    with pytest.raises(InputError) as error:
        read(text)
    assert help in (error.value.diagnostics[0].help or "")


def test_a_unit_that_contradicts_the_trace_is_rejected() -> None:
    text = "time [ms],a\n0,1\n"
    with pytest.raises(UsageError, match="are in ms, not in s"):
        read(text, unit="s")
    assert read(text, unit="ms").unit == "ms"


def test_a_header_that_cannot_be_cut() -> None:
    with pytest.raises(UsageError, match="separated by commas, semicolons or tabs"):
        read("time a b\n0 1 2\n")


def test_a_carriage_return_among_the_names_is_rejected(tmp_path: Path) -> None:
    path = tmp_path / "old.csv"
    path.write_bytes(b"time,p\r0,1\r1,0\n")
    with pytest.raises(UsageError, match=r"the names of the columns of .*old\.csv cannot be read"):
        open_csv(path)
