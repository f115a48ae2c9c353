"""Formulas of a file that name themselves, and names that a column and a formula have."""

from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError
from tachk.recordings.monitors.formulas import read_formulas
from tachk.recordings.monitors.offline import evaluate_formulas
from tachk.recordings.traces.trace_files import open_trace

ROWS = {"t": [0, 1], "x": [1, 2]}


def formulas(folder: Path, text: str) -> Path:
    path = folder / "f.stl"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        ("a: b && x < 3\nb: a || x > 1\n", ["`b` names itself: b -> a -> b", "`a` names itself: a -> b -> a"]),
        ("a: b\nb: c && x < 2\nc: F b\n", ["b -> c -> b", "c -> b -> c", "b -> c -> b"]),
        ("a: G (a -> x < 3)\n", ["`a` names itself: a -> a"]),
    ],
)
def test_a_circle_is_named(text: str, messages: list[str], tmp_path: Path) -> None:
    with pytest.raises(InputError) as raised:
        tachk.monitor(formulas(tmp_path, text), ROWS)
    told = [each.message for each in raised.value.diagnostics]
    assert len(told) == len(messages)
    assert all(message in each for message, each in zip(messages, told, strict=True))


def test_a_column_breaks_a_circle(tmp_path: Path) -> None:
    path = formulas(tmp_path, "a: b && x < 3\nb: a || x > 1\n")
    report = tachk.monitor(path, {**ROWS, "a": [1, 0]})
    assert report.truth is tachk.Truth.TRUE
    own = formulas(tmp_path, "x: x < 3\n")
    assert tachk.monitor(own, ROWS).truth is tachk.Truth.TRUE


def test_a_column_in_the_place_of_a_formula_is_reported(tmp_path: Path) -> None:
    path = formulas(tmp_path, "a: x < 3\nc: G a\n")
    record = evaluate_formulas(read_formulas(path), open_trace({**ROWS, "a": [1, 0]}))
    assert record.trace.warnings == ("`a` in the formula `c` is the column, not the formula of this name",)
    assert tachk.monitor(path, ROWS).truth is tachk.Truth.TRUE
