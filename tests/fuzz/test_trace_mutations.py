"""Damaged traces of every format in this process: each is judged, or refused with a reason."""

from __future__ import annotations

import gzip
import io
import json
from contextlib import suppress
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest

import tachk
from tachk.diagnostics.diagnostic import TachkError
from tests.fuzz.inputs import CSV, VCD

MUTANTS = 150
"""Of each format; campaigns take other seeds and more."""

LINES = (
    '{"t": 0, "x": 1, "s": "a", "v": [1, {"z": true}]}\n{"t": 0.30000000000000004, "x": -1.5e3}\n'
    '{"t": 1, "x": null, "s": "b", "v": [Infinity, {"z": false}]}\n'
)
RUNS = "run,time,P,n\n0,0,A,1\n0,1.25,B,2\n1,0,A,1\n1,2,B,3\n"
SHEET = 'sep=;\ntime;x;s\n0;1,5;a\n0,5;-2,25;"b c"\n0,75;;\n'
STRINGS = VCD.replace(
    "$enddefinitions", "$scope module model $end $var string 1 % P $end $upscope $end\n$enddefinitions"
)

WORDS = [
    word.encode() for word in ("inf", "1e999", "0.30000000000000004", "1e99999999", "2" * 4400, '"', "\n", "é", ",")
]
WORDS += [b"\0" * 8, b"\xff" * 8, b"\xff\xff\xff\x7f", b"\xef\xbb\xbf", b"\x01" + 7 * b"\0"]

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
            return tuple(mcap(compression, chunked) for compression in ("NONE", "ZSTD") for chunked in (True, False))
        case "h5":
            return (hdf5(),)
        case _:
            return (parquet(),)


def mcap(compression: str, chunked: bool) -> bytes:
    writers = pytest.importorskip("mcap.writer")
    out = io.BytesIO()
    writer = writers.Writer(out, compression=writers.CompressionType[compression], use_chunking=chunked)
    writer.start()
    plain = writer.register_channel("/a", "json", writer.register_schema("o", "jsonschema", b"{}"))
    text = b"uint8 ERROR=2\nuint8 level\n"
    status = writer.register_channel("/s", "cdr", writer.register_schema("x/msg/S", "ros2msg", text))
    for number in range(4):
        time = 10**18 + number * 10**9
        writer.add_message(plain, log_time=time, publish_time=5, data=json.dumps({"x": number}).encode())
        writer.add_message(status, log_time=time, publish_time=5, data=bytes([0, 1, 0, 0, number % 3]))
    writer.finish()
    return out.getvalue()


def hdf5() -> bytes:
    h5py = pytest.importorskip("h5py")
    out = io.BytesIO()
    with h5py.File(out, "w") as file:
        file["time"], file["x"] = np.array([0.0, 1, 2]), np.array([1.0, 2, np.inf])
        file["imu/gyro"], file["imu/t"] = np.ones((3, 2)), np.array([0, 1, 3])
        kind = h5py.enum_dtype({"SLOW": 0, "FAST": 2}, basetype="u1")
        file.create_dataset("mode", data=np.array([0, 2, 1], "u1"), dtype=kind)
    return out.getvalue()


def parquet() -> bytes:
    arrow, files = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    out = io.BytesIO()
    files.write_table(arrow.table({"time": [0, 1, 2], "x": [1.0, float("inf"), None], "s": ["a", "b", None]}), out)
    return out.getvalue()


def damaged(data: bytes, random: Random) -> bytes:
    """With a few bytes changed, added or left out, or cut off."""
    found = bytearray(data)
    for _ in range(random.choice([1, 1, 2, 4])):
        at = random.randrange(len(found) + 1)
        match random.randrange(6):
            case 0 if at < len(found):
                found[at] ^= 1 << random.randrange(8)
            case 1:
                found[at:at] = random.choice(WORDS)
            case 2:
                del found[at : at + random.choice([1, 4, 30])]
            case 3:
                found[at : at + random.choice([1, 4, 8])] = random.choice(WORDS)
            case 4:
                del found[at:]
            case _:
                found[at:at] = found[at : at + 20]
    return bytes(found)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("kind", FORMULAS)
def test_damaged_traces(kind: str, tmp_path: Path) -> None:
    random = Random(2026)
    path = tmp_path / f"f.{kind}"
    for _ in range(MUTANTS):
        path.write_bytes(damaged(random.choice(sound(kind)), random))
        options: dict[str, Any] = random.choice([{}, {}, {"decimals": 3}, {"run": 0}])
        with suppress(TachkError):
            tachk.monitor(random.choice(FORMULAS[kind]), path, robustness=False, **options).to_dict()
