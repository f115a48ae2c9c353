"""Compressed files: whole, of several parts, cut off, damaged."""

from __future__ import annotations

import gzip
from collections.abc import Callable
from pathlib import Path

import pytest

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.compressed import open_bytes, torn
from tachk.recordings.traces.trace_files import open_trace

zstandard = pytest.importorskip("zstandard")

ROWS = "".join(f"{number},{number * number % 997}\n" for number in range(20_000))
TABLE = f"time,x\n{ROWS}".encode()
COMPRESSORS: dict[str, Callable[[bytes], bytes]] = {"gz": gzip.compress, "zst": zstandard.compress}


@pytest.mark.parametrize("kind", COMPRESSORS)
def test_everything_in_front_of_the_cut_is_read(kind: str, tmp_path: Path) -> None:
    data = COMPRESSORS[kind](TABLE)
    path = tmp_path / f"log.csv.{kind}"
    path.write_bytes(data[: len(data) * 3 // 4])
    with open_bytes(path) as stream:
        found = stream.read()
        assert torn(stream)
    assert TABLE.startswith(found)
    assert len(found) > len(TABLE) // 2
    trace = open_trace(path).read(["x"])
    assert len(trace.columns["x"]) == found.count(b"\n") - 1
    assert any("is cut off" in warning for warning in trace.warnings)


@pytest.mark.parametrize("kind", COMPRESSORS)
def test_parts_one_behind_the_other(kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"log.csv.{kind}"
    path.write_bytes(COMPRESSORS[kind](TABLE) + COMPRESSORS[kind](b"20000,5\n"))
    with open_bytes(path) as stream:
        assert stream.read() == TABLE + b"20000,5\n"
        assert torn(stream) is None


def test_zeros_may_fill_a_file_of_gzip(tmp_path: Path) -> None:
    path = tmp_path / "log.csv.gz"
    path.write_bytes(gzip.compress(b"time,x\n0,1\n") + bytes(512))
    with open_bytes(path) as stream:
        assert stream.read() == b"time,x\n0,1\n"
        assert torn(stream) is None


@pytest.mark.parametrize("kind", COMPRESSORS)
@pytest.mark.parametrize("suffix", ["csv", "jsonl", "vcd", "mcap"])
def test_what_cannot_be_decompressed(kind: str, suffix: str, tmp_path: Path) -> None:
    """It was called empty."""
    path = tmp_path / f"log.{suffix}.{kind}"
    for data in (b"no such thing at all", COMPRESSORS[kind](TABLE)[:6]):
        path.write_bytes(data)
        with pytest.raises(UsageError, match="cannot be decompressed"):
            open_trace(path)
