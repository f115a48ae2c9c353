"""Traces in memory: exact times, held values, refusals."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tachk.diagnostics.diagnostic import UsageError
from tachk.runtime.trace_arrays import exact_ticks, open_table
from tachk.runtime.trace_files import open_trace


def test_lists_arrays_and_missing_values() -> None:
    trace = open_table(
        {
            "t": [0.1, 0.2, 0.30000000000000004],
            "p": [True, None, False],
            "x": np.array([1.5, np.nan, 2]),
            "n": [0, 1, 1],
        }
    ).read()
    assert trace.times.tolist() == [0, 10**8, 2 * 10**8]  # 0.1 + 0.2 is no short decimal: rounded to 9 decimals
    assert trace.origin == Fraction(1, 10)
    assert trace.columns["p"].tolist() == [1, 1, 0]
    assert trace.columns["x"].tolist() == [1.5, 1.5, 2.0]
    assert {name: values.dtype.kind for name, values in trace.columns.items()} == {"p": "u", "x": "f", "n": "u"}


@given(st.lists(st.decimals(0, 10**5, places=4), min_size=1, max_size=30))
def test_floating_point_times_are_the_decimals_they_print_as(times: list[Decimal]) -> None:
    ticks, scale = exact_ticks(np.array([float(time) for time in times]), "t")
    assert [Fraction(int(tick), scale) for tick in ticks] == [Fraction(time) for time in times]


def test_data_frames_with_a_time_column_or_an_index_of_instants() -> None:
    frame = pd.DataFrame({"time [ms]": [0, 5], "x": [1.5, 2.5], "note": ["a", "b"]})
    recording = open_trace(frame)
    assert recording.unit == "ms"
    assert recording.columns == ("x", "note")
    assert recording.read(["x"]).times.tolist() == [0, 5]
    stamped = pd.DataFrame({"p": [True, False]}, index=pd.to_datetime(["2026-01-01 00:00:00", "2026-01-01 00:00:01"]))
    trace = open_trace(stamped).read()
    assert trace.unit == "s"
    assert trace.end == trace.ticks_per_unit


def test_instants_with_a_time_zone() -> None:
    frame = pd.DataFrame({"p": [1, 0]}, index=pd.date_range("2026-03-29", periods=2, freq="D", tz="Europe/Berlin"))
    trace = open_trace(frame).read()
    assert trace.clock(trace.end) - trace.origin == 23 * 3600  # the clocks were put forward


def test_fractions_are_exact() -> None:
    trace = open_table({"t": [Fraction(1, 3), Fraction(1, 2)], "p": [1, 0]}).read()
    assert (trace.times.tolist(), trace.ticks_per_unit, trace.origin) == ([0, 1], 6, Fraction(1, 3))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (3, "a int is no trace"),
        ({"p": [1]}, "no column time, t or timestamp"),
        ({"t": [], "p": []}, "no rows"),
        ({"t": [1, 0], "p": [1, 1]}, "the time of row 1 lies before"),
        ({"t": [0, 1], "p": [1]}, "1 values for 2 times"),
        ({"t": [0, float("nan")], "p": [1, 1]}, "a time is missing"),
        ({"t": ["a"], "p": [1]}, "the times are no numbers"),
        ({"t": [0], "p": ["x"]}, "neither numbers nor truth values"),
        ({"t": [0], "p": [None]}, "no value in the first row"),
        ({"t": [0], "p": [float("inf")]}, "infinite value in row 0"),
        ({"t": [0], "p": [[1]]}, "no one-dimensional array"),
    ],
)
def test_refusals(data: Any, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        open_trace(data).read()
