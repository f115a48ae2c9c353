"""Parquet: the same trace as from CSV; instants, decimal numbers, nulls; a clear message without pyarrow."""

from __future__ import annotations

import builtins
import datetime
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.trace_files import open_trace

pa = pytest.importorskip("pyarrow")
pq = pytest.importorskip("pyarrow.parquet")


def write(path: Path, **columns: Any) -> Path:
    pq.write_table(pa.table(columns), path)
    return path


def test_numbers_truth_values_and_nulls(tmp_path: Path) -> None:
    path = write(
        tmp_path / "a.parquet",
        **{"time [ms]": [0.5, 1.0, 2.0], "x": [1.5, None, 2.0], "p": [True, False, None], "note": ["a", "b", "c"]},
    )
    recording = open_trace(path)
    assert (recording.unit, recording.columns) == ("ms", ("x", "p", "note"))
    trace = recording.read(["x", "p"])
    assert (trace.times.tolist(), trace.ticks_per_unit) == ([0, 5, 15], 10)
    assert trace.columns["x"].tolist() == [1.5, 1.5, 2.0]
    assert trace.columns["p"].tolist() == [1, 0, 0]


def test_instants_and_decimal_numbers(tmp_path: Path) -> None:
    begin = datetime.datetime(2026, 1, 1)
    stamps = [begin, begin + datetime.timedelta(milliseconds=1500)]
    trace = open_trace(write(tmp_path / "b.pq", timestamp=stamps, p=[1, 0])).read()
    assert trace.unit == "s"
    assert trace.clock(trace.end) - trace.origin == Decimal("1.5")
    exact = open_trace(write(tmp_path / "c.pq", t=[Decimal("0.1"), Decimal("0.3")], p=[1, 0])).read()
    assert (exact.times.tolist(), exact.ticks_per_unit) == ([0, 2], 10)


def test_what_is_no_parquet_file(tmp_path: Path) -> None:
    (tmp_path / "d.parquet").write_text("time,p\n0,1\n")
    with pytest.raises(UsageError, match="not a readable Parquet file"):
        open_trace(tmp_path / "d.parquet")
    with pytest.raises(UsageError, match="there is no file"):
        open_trace(tmp_path / "e.parquet")


def test_a_damaged_file(tmp_path: Path) -> None:
    """Every single byte damaged in turn: the file is read, or refused in a sentence."""
    path = write(tmp_path / "f.parquet", t=[0, 1, 2], p=[1, 0, 1])
    whole = path.read_bytes()
    refused = 0
    for place in range(0, len(whole), 3):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 0x15]) + whole[place + 1 :])
        try:
            open_trace(path).read(["p"])
        except UsageError:
            refused += 1
    assert refused > 20


def test_without_pyarrow_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    original = builtins.__import__

    def refuse(name: str, *arguments: Any, **more: Any) -> Any:
        if name.startswith("pyarrow"):
            raise ModuleNotFoundError(name, name=name)
        return original(name, *arguments, **more)

    monkeypatch.setattr(builtins, "__import__", refuse)
    with pytest.raises(UsageError) as error:
        open_trace("a.parquet")
    assert error.value.help == 'pip install "tachk[parquet]"'


def test_a_text_that_is_not_utf8_is_named(tmp_path: Path) -> None:
    offsets, text = pa.py_buffer(b"\0\0\0\0\2\0\0\0"), pa.py_buffer(b"a\xff")
    path = write(
        tmp_path / "a.parquet",
        time=pa.array([0.0]),
        word=pa.Array.from_buffers(pa.string(), 1, [None, offsets, text]),
    )
    with pytest.raises(UsageError, match=r"column 'word' cannot be read: .*Invalid UTF8"):
        open_trace(path).read(["word"])
