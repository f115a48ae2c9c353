"""JSON lines are the same trace whether the core or the general reader reads them; the core gives up on faults."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.recordings.traces.logs.joined import with_decimals
from tachk.recordings.traces.logs.trace_jsonl import read_as_events, read_as_table
from tachk.recordings.traces.trace import TraceSource
from tests.support.seeds import seeds

NUMBERS: tuple[Callable[[Random], Any], ...] = (
    lambda r: r.randint(-5, 5),
    lambda r: r.random(),
    lambda r: round(100 * r.random(), r.randint(0, 5)),
    lambda r: 10 ** r.randint(0, 40),
    lambda r: -0.0,
    lambda r: 1e300 * r.random(),
    lambda _: 5e-324,
    lambda _: float("inf"),
    lambda _: float("nan"),
    lambda _: None,
)
VALUES: dict[str, Callable[[Random], Any]] = {
    "a": lambda r: r.choice(NUMBERS)(r),
    "b": lambda r: r.choice([True, False, None]),
    "c": lambda r: r.choice(["x", "y\n", "é", '"q\\', "7", "true", "\N{GRINNING FACE}", ""]),
    "d": lambda r: {"x": r.random(), "v [m/s]": [r.randint(0, 3) for _ in range(r.randint(0, 3))], "e": {}},
    "f [km/h]": lambda r: r.randint(0, 1),
    "g": lambda r: r.choice(["1", "2.5", "nan"]),
    "h": lambda r: r.choice([0, 1, 1, 1, True]),
}
FRACTIONS = ["", ".25", ".123456789", ".1234567891"]
TIMES: dict[str, Callable[[Random, int, int], str]] = {
    "whole": lambda _, row, count: str(count),
    "decimal": lambda r, row, count: f"{count / 100:.{r.randint(2, 4)}f}",
    "nanoseconds": lambda _, row, count: f"{1764000000 + row}.{row:09d}",
    "eighths": lambda _, row, count: repr(count / 8),
    "dates": lambda r, row, _: f'"2026-03-01T12:{row:02d}:00{r.choice(FRACTIONS)}{r.choice(["Z", "", "+01:00"])}"',
    "added": lambda _, row, count: repr(sum([0.1] * row)),
    "clock": lambda _, row, count: repr(1764000000 + sum([0.1] * row)),
    "digits": lambda _, row, count: f"{1764000000 + sum([0.1] * row):.17g}",
}
DAMAGES = [*'{}[]",:0123.eE+-ntf\\u\n\r \t\x00é', "\ufeff", "\\ud800", "\\u00e9"]


def lines(r: Random) -> bytes:
    key = r.choice(["time", "t", "time [ms]", "Timestamp"])
    columns = r.sample(list(VALUES), r.randint(1, 5))
    time, escaped, count = r.choice(list(TIMES.values())), r.random() < 0.5, r.randint(-50, 50)
    written = []
    for row in range(r.randint(1, 12)):
        count += r.randint(0, 30)
        items = [
            f"{json.dumps(name)}:{' ' * r.randint(0, 1)}{json.dumps(VALUES[name](r), ensure_ascii=escaped)}"
            for name in columns
            if r.random() < 0.7
        ]
        items.insert(r.randint(0, len(items)), f'"{key}": {time(r, row, count)}')
        written.append("{" + ", ".join(items) + "}")
    data = ("\n".join(written) + "\n" * r.randint(0, 2)).encode()
    data = data.replace(b"\n", b"\r\n") if r.random() < 0.2 else data
    return b"\xef\xbb\xbf" + data if r.random() < 0.1 else data


def damaged(r: Random, data: bytes) -> bytes:
    for _ in range(r.randint(0, 2) * r.randint(0, 1)):
        place = r.randrange(len(data) + 1)
        put = r.choice(DAMAGES).encode() if r.random() < 0.8 else bytes([r.randrange(256)])
        data = r.choice([data[:place] + data[place + 1 :], data[:place] + put + data[place:], data[:place]])
    return data


def outcome(make: Callable[[], Any]) -> Any:
    try:
        return make()
    except InputError as error:
        return [(each.code, each.message, each.span, each.help) for each in error.diagnostics]
    except UsageError as error:
        return str(error), error.help


def content(recording: TraceSource, columns: Sequence[str] | None, decimals: int | None) -> Any:
    trace = with_decimals(recording, decimals).read(columns)
    bits = {name: (values.dtype, values.tobytes()) for name, values in trace.columns.items()}
    counted = (trace.times.tolist(), trace.end, trace.ticks_per_unit, trace.unit, trace.origin)
    words = (trace.texts, trace.labels, trace.dated, trace.calendar, trace.notes, trace.warnings)
    return trace.name, bits, counted, words


@pytest.mark.parametrize("seed", seeds(range(40)))
def test_the_core_reads_what_the_general_reader_reads(seed: int, tmp_path: Path) -> None:
    path = tmp_path / "log.jsonl"
    for number in range(25):
        r = Random(f"{seed} {number}")
        path.write_bytes(damaged(r, lines(r)))
        table = outcome(lambda: read_as_table(path, None, None))
        if table is None:
            continue
        general = outcome(lambda: read_as_events(path, None, None))
        if not hasattr(table, "columns"):
            assert table == general
            continue
        assert (table.columns, table.unit) == (general.columns, general.unit)
        some = r.sample(table.columns, min(2, len(table.columns)))
        for columns in (None, [], some, [f"arrived({name})" for name in some]):
            for decimals in (None, r.randint(0, 5)):
                expected = outcome(lambda: content(general, columns, decimals))  # noqa: B023
                assert outcome(lambda: content(table, columns, decimals)) == expected, (columns, decimals)  # noqa: B023


def test_usual_files_are_read_by_the_core(tmp_path: Path) -> None:
    path = tmp_path / "log.jsonl"
    path.write_text('{"time": 0.25, "on": true, "pose": {"x": [1, 2.5]}}\n\n{"time": 1, "mode": "a\\u00e9"}', "utf-8")
    table = read_as_table(path, None, None)
    assert table is not None
    assert table.columns == ("on", "pose.x[0]", "pose.x[1]", "mode")
    trace = table.read(["on", "pose.x[1]"])
    assert (trace.times.tolist(), trace.ticks_per_unit, trace.origin) == ([0, 3], 4, Fraction(1, 4))
    assert np.array_equal(trace.columns["pose.x[1]"], [2.5, 2.5])
