"""One log in every format: empty cells, truth values, texts, infinite values and units are read by one rule."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from functools import partial
from math import inf, isnan, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.cli.main import app
from tachk.recordings.traces.trace_files import open_trace

Column = tuple[str, list[Any]]
"""The name of a column, with its unit, and its values; None: the cell is empty."""


def cell(value: Any) -> str:
    if value is None:
        return ""
    return str(value).lower() if isinstance(value, bool) else f'"{value}"' if isinstance(value, str) else str(value)


def as_csv(folder: Path, name: str, values: Sequence[Any]) -> Path:
    path = folder / "a.csv"
    rows = "".join(f"{number},{cell(value)}\n" for number, value in enumerate(values))
    path.write_text(f"time [s],{name}\n{rows}", encoding="utf-8")
    return path


def as_jsonl(folder: Path, name: str, values: Sequence[Any]) -> Path:
    path = folder / "a.jsonl"
    lines = [json.dumps({"time [s]": number, name: value}) for number, value in enumerate(values)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def as_lists(_: Path, name: str, values: Sequence[Any]) -> dict[str, list[Any]]:
    return {"time [s]": list(range(len(values))), name: list(values)}


def as_frame(folder: Path, name: str, values: Sequence[Any]) -> Any:
    return pytest.importorskip("pandas").DataFrame(as_lists(folder, name, values))


def as_parquet(folder: Path, name: str, values: Sequence[Any]) -> Path:
    arrow, parquet = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.parquet")
    path = folder / "a.parquet"
    parquet.write_table(arrow.table(as_lists(folder, name, values)), path)
    return path


def as_mcap(folder: Path, name: str, values: Sequence[Any]) -> Path:
    writers = pytest.importorskip("mcap.writer")
    path = folder / "a.mcap"
    with path.open("wb") as stream:
        writer = writers.Writer(stream)
        writer.start()
        channel = writer.register_channel("x", "json", writer.register_schema("x", "jsonschema", b"{}"))
        for number, value in enumerate(values):
            data = json.dumps({name.removeprefix("x."): value}).encode()
            writer.add_message(channel, log_time=number * 10**9, publish_time=0, data=data)
        writer.finish()
    return path


def as_array(values: Sequence[Any]) -> Any:
    """Arrays have no empty cells but NaN, among numbers."""
    if {type(value) for value in values} - {type(None)} <= {int, float}:
        return np.array([nan if value is None else value for value in values])
    if None in values:
        pytest.skip("arrays of texts and truth values have no empty cells")
    return np.array(values)


def as_hdf5(folder: Path, name: str, values: Sequence[Any]) -> Path:
    h5py = pytest.importorskip("h5py")
    path = folder / "a.h5"
    array = as_array(values)
    with h5py.File(path, "w") as file:
        group = file.create_group("x")
        group["time [s]"] = np.arange(len(values))
        texts = {"dtype": h5py.string_dtype()} if array.dtype.kind == "U" else {}
        group.create_dataset(name.removeprefix("x."), data=array.astype(object) if texts else array, **texts)
    return path


def as_mdf(folder: Path, name: str, values: Sequence[Any]) -> Path:
    asammdf = pytest.importorskip("asammdf")
    path = folder / "a.mf4"
    array, texts = as_array(values), {}
    if array.dtype.kind == "U":
        array, texts = np.array([value.encode() for value in values]), {"encoding": "utf-8"}
    with asammdf.MDF() as file:
        file.append(
            [
                asammdf.Signal(
                    array.astype("u1") if array.dtype.kind == "b" else array, np.arange(4.0), name=name, **texts
                )
            ]
        )
        file.save(path, overwrite=True)
    return path


def as_vcd(folder: Path, name: str, values: Sequence[Any]) -> Path:
    path = folder / "a.vcd"
    kinds = {type(value) for value in values} - {type(None)}
    if " " in name or any(value is None or (isinstance(value, float) and isnan(value)) for value in values[1:]):
        pytest.skip(
            "names have no units there, and a change to x or nan is refused: it does not say that a value stays"
        )
    kind = "string 1" if kinds == {str} else "wire 1" if kinds == {bool} else "real 64"

    def form(value: Any) -> str:
        if value is None:
            return "x!"
        return (
            f"s{value} !".replace(" b", "\\x20b").replace("b  ", "b\\x20 ")
            if kinds == {str}
            else f"{value:d}!"
            if kinds == {bool}
            else f"r{value} !"
        )

    lines = [f"#{number}\n{form(value)}" for number, value in enumerate(values)]
    scopes = f"$scope module x $end $var {kind} ! {name.removeprefix('x.')} $end $upscope $end"
    path.write_text(f"$timescale 1 s $end {scopes} $enddefinitions $end\n" + "\n".join(lines) + "\n")
    return path


FORMATS = {
    "CSV": as_csv,
    "JSON lines": as_jsonl,
    "lists": as_lists,
    "data frame": as_frame,
    "Parquet": as_parquet,
    "MCAP": as_mcap,
    "HDF5": as_hdf5,
    "MDF": as_mdf,
    "VCD": as_vcd,
}
"""The functions that write one column. Its name is `x.v`, as a topic, a group and a scope have names."""

CASES: list[tuple[str, list[Any], dict[str, str]]] = [
    ("x.v [km]", [1.5, 2.5, 3.5, 0.25], {"G (x.v < 4)": "true", "F[1, 1] x.v == 2.5": "true"}),
    ("x.v", [1.5, None, 3.5, None], {"F[1, 1] x.v == 1.5": "true", "F[3, 3] x.v == 3.5": "true"}),
    ("x.v", [1.5, nan, 3.5, nan], {"F[1, 1] x.v == 1.5": "true", "F[3, 3] x.v == 3.5": "true"}),
    ("x.v", [None, 2.5, 3.5, 4.5], {"G (x.v > 2)": "true", "F[2, 2] x.v == 4.5": "true"}),
    ("x.v", [1.5, inf, -inf, 2.0], {"F x.v > 1e300": "true", "F[2, 2] x.v < -1e300": "true"}),
    ("x.v", [0, 1, 1, 0], {"F[1, 1] x.v": "true", "G x.v": "false", "F (x.v > 0.5)": "true"}),
    ("x.v", [0.0, 1.0, 1.0, 0.0], {"F[1, 1] x.v": "true", "G x.v": "false"}),
    ("x.v", [True, False, True, True], {"G x.v": "false", "F[1, 1] !x.v": "true", "F (x.v > 0)": "true"}),
    ("x.v", [True, None, False, None], {"F[1, 1] x.v": "true", "F[3, 3] x.v": "false"}),
    (
        "x.v",
        ["true", "False", "TRUE", "true"],
        {"G x.v": "false", "F[1, 1] !x.v": "true", "F[2, 2] x.v": "true", 'F[2, 2] x.v == "TRUE"': "true"},
    ),
    ("x.v", ["true", "", "false", "NA"], {"F[1, 1] x.v": "true", "F[3, 3] x.v": "false", 'F x.v == "NA"': "true"}),
    ("x.v", ["7", "8", "1.5", "inf"], {"F x.v > 7": "true", 'F x.v == "1.5"': "true", "F x.v == 1.5": "true"}),
    ("x.v", ["", "8", "nan", "2e1"], {"G (x.v >= 8)": "true", "F[1, 1] x.v == 8": "true", "F change(x.v)": "true"}),
    (
        "x.v",
        ["a", "true", "7", ""],
        {'F[3, 3] x.v == ""': "true", 'F[2, 2] x.v == "7"': "true", "F change(x.v)": "true"},
    ),
    ("x.v", ["nan", "a", "null", "b"], {'F[2, 2] x.v == "null"': "true", 'G (x.v != "")': "true"}),
    ("x.v", ["a", None, "b", None], {'F[1, 1] x.v == "a"': "true", 'F[3, 3] x.v == "b"': "true"}),
    ("x.v", ["a", " b", "b ", "b"], {'F[1, 1] x.v == " b"': "true", 'F[2, 2] x.v == "b "': "true"}),
    ("x.v", ["a", "b", "a", "b"], {"F x.v": "refused", "F (x.v > 1)": "refused", 'G (x.v == "a")': "false"}),
    ("x.v", [1.5, 2.5, 3.5, 0.25], {"F x.v": "refused"}),
    ("x.v", [None, None, None, None], {"F (x.v > 1)": "refused"}),
]


def truth(formula: str, log: Any) -> str:
    try:
        return tachk.monitor(formula, log).truth.word
    except (InputError, UsageError):
        return "refused"


@pytest.mark.parametrize(("name", "values", "expected"), CASES, ids=range(len(CASES)))
@pytest.mark.parametrize("form", FORMATS)
def test_cells_mean_the_same_in_every_format(
    tmp_path: Path, form: str, name: str, values: list[Any], expected: dict[str, str]
) -> None:
    log = FORMATS[form](tmp_path, name, values)
    assert {formula: truth(formula, log) for formula in expected} == expected


@pytest.mark.parametrize(("name", "values", "expected"), CASES, ids=range(len(CASES)))
@pytest.mark.parametrize("form", ["CSV", "JSON lines"])
def test_cells_mean_the_same_row_by_row(
    tmp_path: Path, form: str, name: str, values: list[Any], expected: dict[str, str]
) -> None:
    log = FORMATS[form](tmp_path, name, values)
    for formula, whole in expected.items():
        wordy = isinstance(values[0], str) and ("change" in formula or values[0] == "")
        if wordy or whole == "refused":  # what is not known before the rows come
            continue
        found = CliRunner().invoke(app, ["monitor", formula, str(log), "--online", "--quiet"]).exit_code
        assert found == {"true": 0, "false": 10}[whole], formula


@pytest.mark.parametrize("values", [[True, 2, 3, False], [2, True, 3, False]])
@pytest.mark.parametrize("form", ["CSV", "JSON lines", "lists", "data frame", "MCAP"])
def test_truth_values_beside_numbers_are_rejected(tmp_path: Path, form: str, values: list[Any]) -> None:
    with pytest.raises((InputError, UsageError), match="truth values"):
        tachk.monitor("F (x.v > 1)", FORMATS[form](tmp_path, "x.v", values))


@pytest.mark.parametrize("values", [[1, "b", 2, "c"], ["b", 1, "c", 2]])
@pytest.mark.parametrize("form", ["JSON lines", "lists", "data frame", "MCAP"])
def test_texts_beside_numbers_are_rejected(tmp_path: Path, form: str, values: list[Any]) -> None:
    with pytest.raises(UsageError, match=r"texts?, and|and the text 'b'"):
        tachk.monitor('F (x.v == "b")', FORMATS[form](tmp_path, "x.v", values))


def test_two_names_that_differ_in_their_units(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    two = {"v [m]": [1, 2], "v [ft]": [3, 6]}
    logs: list[Any] = [{"time": [0, 1], **two}, tmp_path / "a.csv", tmp_path / "a.jsonl", tmp_path / "a.h5"]
    with logs[1].open("w", newline="") as stream:
        csv.writer(stream).writerows([["time", *two], [0, 1, 3], [1, 2, 6]])
    logs[2].write_text('{"time": 0, "v [m]": 1, "v [ft]": 3}\n')
    with h5py.File(logs[3], "w") as file:
        file["time"] = [0, 1]
        for name, values in two.items():
            file[name] = values
    for log in logs:
        with pytest.raises((UsageError, InputError), match=r"two (columns|values) 'v'"):
            open_trace(log)
    mcap = as_mcap(tmp_path, "v [m]", [1, 2])
    assert open_trace(mcap).columns == ("x.v",)
    with pytest.raises(UsageError, match="two fields 'v'"):
        open_trace(as_mcap_of(tmp_path, [{"v [m]": 1, "v [ft]": 3}])).read(["x.v"])


def as_mcap_of(folder: Path, messages: Sequence[object]) -> Path:
    writers = pytest.importorskip("mcap.writer")
    path = folder / "b.mcap"
    with path.open("wb") as stream:
        writer = writers.Writer(stream)
        writer.start()
        channel = writer.register_channel("x", "json", writer.register_schema("x", "jsonschema", b"{}"))
        for number, message in enumerate(messages):
            writer.add_message(channel, number, json.dumps(message).encode(), number)
        writer.finish()
    return path


def test_units_within_names(tmp_path: Path) -> None:
    """Of objects and lists, too; what ends in a bracket without a blank is a name."""
    message = {"pose [m]": {"x": 1, "y [mm]": 2}, "speeds (m/s)": [3, 4], "a[m]": 5}
    path = tmp_path / "a.jsonl"
    path.write_text(json.dumps({"time": 0, **message}) + "\n")
    columns = ("pose.x", "pose.y", "speeds[0]", "speeds[1]", "a[m]")
    assert open_trace(path).columns == columns
    mcap = open_trace(as_mcap_of(tmp_path, [message, message]))
    assert mcap.columns == tuple(f"x.{name}" for name in columns)
    trace = mcap.read([f"x.{name}" for name in columns[:4]])
    assert [float(values[0]) for values in trace.columns.values()] == [1, 2, 3, 4]


def test_columns_that_equal_each_other_are_of_one_kind(tmp_path: Path) -> None:
    """Where one of them holds texts, the other does, even if all of its texts read as numbers."""
    logs: list[Any] = [{"time": [0, 1], "a": ["x", "7"], "b": ["7", "7"], "c": ["7.0", "7"]}]
    logs += [tmp_path / "a.csv", tmp_path / "a.jsonl"]
    with logs[1].open("w", newline="") as stream:
        csv.writer(stream).writerows([logs[0], *zip(*logs[0].values(), strict=True)])
    rows = [dict(zip(logs[0], row, strict=True)) for row in zip(*logs[0].values(), strict=True)]
    logs[2].write_text("".join(json.dumps(row) + "\n" for row in rows))
    for log in logs:
        own = partial(truth, log=log)
        assert (own("F[1, 1] a == b"), own("G (a == b)"), own("G (b == c)")) == ("true", "false", "true")
        assert own("G (b == c) && F a == b") == "false"
