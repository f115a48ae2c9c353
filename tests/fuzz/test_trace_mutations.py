"""Damaged traces of every format in this process: each is judged, or refused with a reason."""

from __future__ import annotations

import gzip
from contextlib import suppress
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import TachkError
from tests.fuzz import recordings
from tests.fuzz.mutations import octets
from tests.fuzz.samples import CSV, LINES, RUNS, SHEET, STRINGS, VCD

MUTANTS = 150
"""Of each format; campaigns take other seeds and more."""

FORMULAS = {
    "csv": ("G (x < 9)", "G (p -> F[0, 5] q)", "F P.B", 's == "a"'),
    "csv.gz": ("G (x < 9)", "G (p -> F[0, 5] q)"),
    "jsonl": ("G (x < 9)", 's == "a"', "G (v[0] > 0)"),
    "vcd": ("G (p -> x < 3)", "F P.B", "G (y > 0)"),
    "mcap": ("G (a.x < 4)", "G (s.level != ERROR)"),
    "h5": ("G (x < 9)", "F mode == FAST", "G (imu.gyro[0] > 0)"),
    "parquet": ("G (x < 9)", 's == "a"'),
}


@cache
def sound(kind: str) -> tuple[bytes, ...]:
    """Sound traces of a format."""
    match kind:
        case "csv":
            return tuple(text.encode() for text in (CSV, RUNS, SHEET))
        case "csv.gz":
            return tuple(map(gzip.compress, sound("csv")))
        case "jsonl":
            return (LINES.encode(),)
        case "vcd":
            return (VCD.encode(), STRINGS.encode())
        case "mcap":
            pytest.importorskip("mcap.writer")
            return tuple(
                recordings.mcap(compression, chunked) for compression in ("NONE", "ZSTD") for chunked in (True, False)
            )
        case "h5":
            pytest.importorskip("h5py")
            return (recordings.hdf5(),)
        case _:
            pytest.importorskip("pyarrow.parquet")
            return (recordings.parquet(),)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("kind", FORMULAS)
def test_damaged_traces(kind: str, tmp_path: Path) -> None:
    random = Random(2026)
    path = tmp_path / f"f.{kind}"
    for _ in range(MUTANTS):
        path.write_bytes(octets(random, random.choice(sound(kind))))
        options: dict[str, Any] = random.choice([{}, {}, {"decimals": 3}, {"run": 0}])
        with suppress(TachkError):
            tachk.monitor(random.choice(FORMULAS[kind]), path, robustness=False, **options).to_dict()
