"""Value change dumps: scopes, timescales, vectors, reals; unknown values and malformed files have their place."""

from __future__ import annotations

from pathlib import Path

import pytest

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.trace_files import open_trace

HEAD = """$date today $end
$timescale 10 ns $end
$scope module top $end
$var wire 1 ! clk $end
$var reg 4 " cnt [3:0] $end
$var integer 32 # level $end
$scope module sub $end
$var real 64 $ temp $end
$upscope $end
$upscope $end
$enddefinitions $end
"""
BODY = """#0
$dumpvars
0!
bx "
b11111111111111111111111111111110 #
r1.5 $
$end
#5
1!
b0011 "
#10
0!
r-2.25 $
#10
b0100 "
#20
"""


def write(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "wave.vcd"
    path.write_text(text)
    return path


def read(tmp_path: Path, text: str, columns: list[str] | None = None) -> Trace:
    return open_trace(write(tmp_path, text)).read(columns)


def test_values_over_time(tmp_path: Path) -> None:
    trace = read(tmp_path, HEAD + BODY, ["top.clk", "top.level", "top.sub.temp"])
    assert (trace.unit, trace.ticks_per_unit, trace.end) == ("ns", 1, 200)
    assert trace.times.tolist() == [0, 50, 100, 200]
    assert trace.columns["top.clk"].tolist() == [0, 1, 0, 0]
    assert trace.columns["top.level"].tolist() == [-2.0] * 4
    assert trace.columns["top.sub.temp"].tolist() == [1.5, 1.5, -2.25, -2.25]
    assert {name: values.dtype.kind for name, values in trace.columns.items()} == {
        "top.clk": "u",
        "top.level": "f",
        "top.sub.temp": "f",
    }


def test_all_variables_are_listed(tmp_path: Path) -> None:
    recording = open_trace(write(tmp_path, HEAD + BODY))
    assert recording.columns == ("top.clk", "top.cnt", "top.level", "top.sub.temp")


def test_the_trace_begins_when_everything_that_is_read_is_known(tmp_path: Path) -> None:
    trace = read(tmp_path, HEAD + BODY, ["top.clk", "top.cnt"])
    assert trace.clock(0) == 50
    assert trace.times.tolist() == [0, 50, 150]
    assert trace.columns["top.cnt"].tolist() == [3.0, 4.0, 4.0]


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_comments_and_dates_in_any_language(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "wave.vcd"
    path.write_bytes((f"$comment M\u00fcller $end\n{HEAD}{BODY}").replace("today", "5. M\u00e4rz").encode(encoding))
    assert open_trace(path).read(["top.clk"]).columns["top.clk"].tolist() == [0, 1, 0, 0]


@pytest.mark.parametrize(("scale", "unit", "ticks"), [("1 us", "us", 1), ("100 ps", "ns", 1000), ("1 fs", "ns", 10**6)])
def test_timescales(tmp_path: Path, scale: str, unit: str, ticks: int) -> None:
    trace = read(tmp_path, HEAD.replace("10 ns", scale) + BODY, ["top.clk"])
    assert (trace.unit, trace.ticks_per_unit) == (unit, ticks)


@pytest.mark.parametrize(
    ("text", "column", "place"),
    [
        (HEAD + BODY.replace("b0011", "bx").replace("b0100", "bx"), "top.cnt", "26:"),  # it is never known
        (HEAD + BODY.replace("b0100", "bx"), "top.cnt", "26:"),  # it was known, and is no longer
        (HEAD + BODY.replace('b0011 "\n', "").replace('bx "\n', "").replace('b0100 "\n', ""), "top.cnt", "24:"),
        (HEAD + BODY.replace("#20", "#7"), "top.clk", "27:"),
        (HEAD + BODY.replace("#20", "#9223372036854775808"), "top.clk", "27:"),
        (HEAD + BODY.replace("#20", f"#{2**60}"), "top.clk", "27:"),  # 10 ns each
        (HEAD + BODY.replace("1!", "1"), "top.clk", "21:"),  # an identifier is missing
        (HEAD.replace("$enddefinitions $end\n", ""), "top.clk", "1:"),
    ],
)
def test_mistakes_have_their_place(tmp_path: Path, text: str, column: str, place: str) -> None:
    with pytest.raises(InputError) as error:
        read(tmp_path, text, [column])
    (diagnostic,) = error.value.diagnostics
    assert diagnostic.code == "E0917"
    assert str(diagnostic.span).startswith(f"{tmp_path / 'wave.vcd'}:{place}")


def test_rejections(tmp_path: Path) -> None:
    path = write(tmp_path, HEAD + BODY)
    with pytest.raises(UsageError, match=r"no column 'top\.clock'"):
        open_trace(path).read(["top.clock"])
    with pytest.raises(UsageError, match="counts its time in ns"):
        open_trace(path, unit="s")
    with pytest.raises(UsageError, match="no time column to choose"):
        open_trace(path, time="top.clk")
    with pytest.raises(UsageError, match="has no times"):
        read(tmp_path, HEAD)


@pytest.mark.parametrize(("kind", "value"), [("wire", "b10"), ("integer", "b11111111111111111111111111111110")])
def test_a_value_of_more_bits_than_its_variable_is_rejected(tmp_path: Path, kind: str, value: str) -> None:
    text = f"$timescale 1 ns $end\n$var {kind} 1 ! p $end\n$enddefinitions $end\n#0\n{value} !\n#5\n"
    with pytest.raises(InputError) as found:
        read(tmp_path, text, ["p"])
    (error,) = found.value.diagnostics
    assert (error.code, error.span.source.first_line) == ("E0917", 5)
    assert "for 'p', which has 1" in error.message


def test_a_variable_without_bits_has_no_values(tmp_path: Path) -> None:
    text = "$timescale 1 ns $end\n$var integer 0 ! p $end\n$enddefinitions $end\n#0\nb1 !\n#5\n"
    with pytest.raises(InputError) as found:
        read(tmp_path, text, ["p"])
    assert found.value.diagnostics[0].code == "E0917"


def test_a_real_number_for_one_bit_stays_what_it_is(tmp_path: Path) -> None:
    text = "$timescale 1 ns $end\n$var wire 1 ! p $end\n$enddefinitions $end\n#0\nr2.5 !\n#5\n"
    assert read(tmp_path, text, ["p"]).columns["p"].tolist() == [2.5, 2.5]
