"""The same log as CSV, JSON lines, arrays, files joined, whole and row by row: one answer."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta, timezone
from fractions import Fraction
from pathlib import Path

import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

import tachk
from tachk.base.diagnostics.diagnostic import InputError
from tachk.cli.main import app
from tachk.recordings.monitors.online import Monitor
from tachk.recordings.traces.logs.dates import date_text, seconds_of
from tachk.recordings.traces.trace_csv import ByteStream, CsvRecording, open_csv, open_csv_stream

FORMULAS = [
    'G (mode == "ready" -> F[0, 2 s] n >= 1)',
    "F[0, 4 s] (mode != other && on)",
    'G (rise(other == "a, b") -> n < 2)',
    "G[0, 3 s] (n > -2 || on) && F (n < 1.5)",
    "G (mode == other -> O[0, 2 s] on)",
]
TEXTS = ("ready", "idle", "a, b", '"c"', "nan", "7", "x y", "ä")

Row = tuple[Fraction, str | None, str | None, float | None, bool | None]


@st.composite
def logs(draw: st.DrawFn) -> list[Row]:
    time = Fraction(draw(st.integers(-3_000_000_000, 4_000_000_000)), draw(st.sampled_from([1, 2, 1000])))
    rows: list[Row] = []
    texts, numbers = st.sampled_from(TEXTS), st.sampled_from([-3.25, -1.0, 0.5, 2.0, 1e3])
    for number in range(draw(st.integers(1, 8))):
        stays = st.none() if number else st.nothing()
        row = (draw(texts | stays), draw(texts | stays), draw(numbers | stays), draw(st.booleans() | stays))
        rows.append((time, *row))
        time += Fraction(draw(st.integers(0, 3000)), 1000)
    return rows


def date(time: Fraction, hours: int) -> str:
    """In a time zone, with three decimals."""
    instant = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(milliseconds=int(time * 1000))
    return instant.astimezone(timezone(timedelta(hours=hours))).isoformat(timespec="milliseconds")


def as_csv(rows: list[Row], names: tuple[str, ...], places: tuple[int, ...], hours: int | None, missing: str) -> str:
    out = io.StringIO()
    writer = csv.writer(out)
    writer.writerow(["time", *names] if hours is not None else ["time [s]", *names])
    for row in rows:
        cells = [row[place] for place in places]
        shown = [
            ("" if isinstance(rows[0][place], str) else missing) if each is None else each
            for place, each in zip(places, cells, strict=True)
        ]
        time = row[0]
        writer.writerow([date(time, hours) if hours is not None else f"{float(time):.3f}", *map(str, shown)])
    return out.getvalue()


def online(text: str, cuts: int) -> list[tuple[str, object]]:
    recording = open_csv_stream(Slow(text.encode(), cuts), "-")
    monitor = Monitor(FORMULAS, unit=recording.unit, decimals=3, robustness=True)
    recording = CsvRecording(
        recording.name, recording.opened, recording.header, recording.separator, recording.line,
        dates=recording.dates, texts=monitor.text_columns,
    )  # fmt: skip
    for rows in recording.blocks(monitor.columns, 3):
        monitor.push(rows.times, rows.columns, rows.decimals)
    return [(verdict.truth.word, verdict.robustness) for verdict in monitor.finish()]


class Slow:
    """A stream that gives a few bytes at a time."""

    def __init__(self, text: bytes, size: int) -> None:
        self._stream = io.BytesIO(text)
        self._size = size

    def readline(self, size: int = -1, /) -> bytes:
        return self._stream.readline(size)

    def read1(self, size: int = -1, /) -> bytes:
        return self._stream.read(self._size)

    def close(self) -> None:
        pass


def whole(trace: object) -> list[tuple[str, object]]:
    report = tachk.monitor(FORMULAS, trace, unit="s")  # type: ignore[arg-type]
    return [(verdict.truth.word, verdict.robustness) for verdict in report]


@settings(max_examples=40, deadline=None, derandomize=True)
@given(logs(), st.none() | st.integers(-11, 12), st.sampled_from(["", "nan", "NA", " null "]), st.integers(1, 40))
def test_a_log_has_one_meaning_in_every_form(
    tmp_path_factory: pytest.TempPathFactory, rows: list[Row], hours: int | None, missing: str, cuts: int
) -> None:
    folder = tmp_path_factory.mktemp("log")
    names = ("mode", "other", "n", "on")
    text = as_csv(rows, names, (1, 2, 3, 4), hours, missing)
    table, lines, left, right = (folder / name for name in ("log.csv", "log.jsonl", "left.csv", "right.csv"))
    table.write_text(text, encoding="utf-8")
    objects = ({"time": float(time), **dict(zip(names, values, strict=True))} for time, *values in rows)
    lines.write_text("".join(json.dumps(each) + "\n" for each in objects), encoding="utf-8")
    left.write_text(as_csv(rows, ("n", "mode"), (3, 1), hours, missing), encoding="utf-8")
    right.write_text(as_csv(rows, ("other", "on"), (2, 4), hours, missing), encoding="utf-8")
    arrays = {"time": [row[0] for row in rows], **{name: [row[i] for row in rows] for i, name in enumerate(names, 1)}}
    expected = whole(arrays)
    assert whole(table) == expected
    assert whole(lines) == expected
    assert whole([left, right]) == expected
    assert online(text, cuts) == expected


@settings(max_examples=150, deadline=None, derandomize=True)
@given(
    st.datetimes(datetime(1, 1, 2), datetime(9999, 12, 30)),
    st.sampled_from(["T", " ", "t"]),
    st.sampled_from(["hours", "minutes", "seconds", "milliseconds", "microseconds"]),
    st.sampled_from(["", "Z", "+00:00", "-03:30", "+1400", "-11"]),
)
def test_dates_are_read_as_the_standard_library_reads_them(
    instant: datetime, between: str, precision: str, zone: str
) -> None:
    text = instant.isoformat(sep=between, timespec=precision) + zone  # type: ignore[arg-type]
    trace = open_csv_stream(io.BytesIO(f'x,time\n1,"{text}"\n'.encode()), "-").read(["x"])
    assert (trace.origin, trace.unit) == (seconds_of(text), "s")


WRONG_DATES = [
    "2026-02-29", "2026-13-01", "2026-00-10", "2026-04-31", "2026-04-01T24:00", "2026-04-01T12:60", "2026-04-01T",
    "2026-04-01T12:00:60", "2026-04-01T12:00:00+25:00", "2026-04-01T12:00:00.", "2026-04-01T1:00", "2026-04-01X", "3",
]  # fmt: skip


@pytest.mark.parametrize("text", WRONG_DATES)
def test_what_is_no_date_is_rejected(text: str) -> None:
    recording = open_csv_stream(io.BytesIO(f"time,x\n2000-02-29,1\n{text},1\n".encode()), "-")
    with pytest.raises(InputError) as error:
        recording.read(["x"])
    (found,) = error.value.diagnostics
    assert (found.code, found.span.start, found.span.source.first_line) == ("E0911", 0, 3)
    assert found.help is not None and ("2026-03-01T12:00:00.25Z" in found.help or text == "3")


def test_dates_count_in_seconds_and_may_be_fine(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("# a log\ntime,x\n# begins\n\n2026-03-01T12:00:00.123456789Z,1\n2026-03-01T12:00:00.2Z,0\n")
    trace = open_csv(path).read(["x"])
    assert (trace.ticks_per_unit, trace.end) == (10**9, 76_543_211)
    with pytest.raises(tachk.base.diagnostics.diagnostic.UsageError, match="are in s, not in ms"):
        open_csv(path, unit="ms")


def test_a_stream_of_many_texts_keeps_few(tmp_path: Path) -> None:
    def lines() -> Iterator[bytes]:
        yield b"time,text\n"
        yield from (b"%d,word%d\n" % (number, number) for number in range(1000))

    stream: ByteStream = Slow(b"".join(lines()), 100)
    recording = open_csv_stream(stream, "-", unit="s")
    recording = CsvRecording("-", recording.opened, recording.header, ",", 2, texts=frozenset(["text"]))
    words = [word for rows in recording.blocks(["text"], 0) for word in rows.columns["text"]]
    assert words == [f"word{number}" for number in range(1000)]


@given(st.integers(-62_135_596_800 * 10**9, 253_402_300_799 * 10**9))
def test_dates_are_reported_as_they_are_read(nanoseconds: int) -> None:
    seconds = Fraction(nanoseconds, 10**9)
    assert seconds_of(date_text(seconds)) == seconds


def test_deadline_behind_the_last_date() -> None:
    assert date_text(Fraction(253_402_300_800)) == "253402300800 s since 1970"


@pytest.mark.parametrize("form", ["csv", "jsonl", "rows", "frame", "joined"])
def test_reports_of_logs_with_dates_report_dates(form: str, tmp_path: Path) -> None:
    dates = ["2026-03-01T12:00:00Z", "2026-03-01T13:00:00.25+01:00"]
    path = tmp_path / ("log.jsonl" if form == "jsonl" else "log.csv")
    lines = [json.dumps({"time": date, "n": n}) if form == "jsonl" else f"{date},{n}" for n, date in enumerate(dates)]
    path.write_text("\n".join(([] if form == "jsonl" else ["time,n"]) + lines) + "\n", encoding="utf-8")
    match form:
        case "frame":
            pandas = pytest.importorskip("pandas")
            frame = pandas.DataFrame({"n": [0, 1]}, index=pandas.to_datetime(dates, format="ISO8601", utc=True))
            text = tachk.monitor("G n == 0", frame.rename_axis("time"))._repr_html_()
        case "rows":
            result = CliRunner().invoke(app, ["monitor", "--online", "G n == 0", str(path)])
            text = result.output
        case "joined":
            other = tmp_path / "other.csv"
            other.write_text(f"time,m\n{dates[0]},1\n", encoding="utf-8")
            text = CliRunner().invoke(app, ["monitor", "G n == 0 && m == 1", str(path), str(other)]).output
        case _:
            text = CliRunner().invoke(app, ["monitor", "G n == 0", str(path)]).output
    assert "2026-03-01T12:00:00.25Z" in text
    assert "1772" not in text
