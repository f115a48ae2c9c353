"""Traces in memory: exact times, held values, refusals."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.trace_arrays import exact_ticks, open_table
from tachk.recordings.traces.trace_files import open_trace


def test_lists_arrays_and_missing_values() -> None:
    trace = open_table(
        {
            "t": [0.1, 0.2, 0.30000000000000004],
            "p": [True, None, False],
            "x": np.array([1.5, np.nan, 2]),
            "n": [0, 1, 1],
        }
    ).read()
    assert trace.times.tolist() == [0, 10**8, 2 * 10**8]  # 0.1 + 0.2 is not a short decimal: rounded to 9 decimals
    assert trace.origin == Fraction(1, 10)
    assert trace.columns["p"].tolist() == [1, 1, 0]
    assert trace.columns["x"].tolist() == [1.5, 1.5, 2.0]
    assert {name: values.dtype.kind for name, values in trace.columns.items()} == {"p": "u", "x": "f", "n": "u"}


@given(st.lists(st.decimals(0, 10**5, places=4), min_size=1, max_size=30))
def test_floating_point_times_are_the_decimals_they_print_as(times: list[Decimal]) -> None:
    counted = exact_ticks(np.array(sorted(float(time) for time in times)), "t")
    exact = [Fraction(int(tick) + counted.first, counted.ticks_per_unit) for tick in counted.ticks]
    assert exact == sorted(Fraction(time) for time in times)


def _short_but_for_errors(time: float) -> bool:
    whole, _, decimals = f"{Decimal(repr(time)):f}".partition(".")
    digits = (whole + decimals).lstrip("0")
    return len(decimals) > 9 and (
        len(digits) > 15 or (len(digits) >= 13 and any(digits[-6 - n : -n] in ("999999", "000000") for n in (1, 2, 3)))
    )


@given(st.lists(st.tuples(st.integers(0, 10**13), st.integers(0, 15), st.integers(-1, 1)), min_size=1, max_size=3))
@example([(1_249_999_999_001, 10, 0)])
def test_neighbours_of_decimals_are_no_decimals(numbers: list[tuple[int, int, int]]) -> None:
    """A time is whole in some decimals if the quotient prints as it; a neighbour in floating point is not.

    Where a time of more than nine decimals is a short number but for the last of thirteen or more digits, all are
    rounded, as docs/monitoring.md says.
    """
    times = []
    for digits, decimals, steps in numbers:
        time = digits / 10.0**decimals
        times.append(float(np.nextafter(time, steps * np.inf)) if steps else time)
    times = sorted(abs(time) for time in times)
    fewest = next(
        (
            decimals
            for decimals in range(16)
            if times[-1] * 10.0**decimals < 2**51
            and all(round(t * 10.0**decimals) / 10.0**decimals == t for t in times)
        ),
        None,
    )
    try:
        counted = exact_ticks(np.array(times), "t")
    except UsageError:
        assert fewest is None
        return
    if fewest is None:
        assert counted.ticks_per_unit >= 1
    elif fewest > 9 and any(_short_but_for_errors(time) for time in times):
        assert counted.rounded is not None
    else:
        assert (counted.ticks_per_unit, counted.rounded) == (10**fewest, None)


@pytest.mark.parametrize("rows", [3, 1500, 5000])
def test_more_decimals_may_be_needed_late(rows: int) -> None:
    times = np.arange(rows, dtype=np.float64)
    times[-1] += 0.125
    counted = exact_ticks(times, "t")
    assert counted.ticks_per_unit == 1000
    assert counted.ticks.tolist() == [*range(0, 1000 * (rows - 1), 1000), 1000 * (rows - 1) + 125]
    times[rows // 2] = times[rows // 2 + 1] + 0.5
    with pytest.raises(UsageError, match=f"the time of row {rows // 2 + 1} lies before"):
        exact_ticks(times, "t")


def test_different_times_stay_different() -> None:
    steps = np.arange(1000) * 1.0000000001e-11
    values = np.where((steps > 3e-9) & (steps < 3.3e-9), 9.0, 1.0)
    trace = open_trace({"time [s]": steps, "x": values}).read()
    assert len(set(trace.times.tolist())) == 1000
    assert float(trace.clock(int(trace.times[1]))) == pytest.approx(1e-11, rel=1e-3)
    (verdict,) = tachk.monitor("G (x < 5)", {"time [s]": steps, "x": values})
    assert (verdict.truth, verdict.robustness) == (tachk.Truth.FALSE, (-4, -4))
    noisy = exact_ticks(np.array([0.0, 0.1 + 0.2, 0.7]), "t")
    assert (noisy.ticks.tolist(), noisy.ticks_per_unit) == ([0, 3 * 10**8, 7 * 10**8], 10**9)
    with pytest.raises(UsageError, match=r"rows 1 and 2 differ by 1\.11e-16") as refusal:
        exact_ticks(np.array([-1000.0, 0.5, 0.5 + 2**-53 * 1, 1000.0]), "t")
    assert "numpy.round" in str(refusal.value.help)


@pytest.mark.parametrize("times", [[0, 2**62, -(2**63), 1], [5, 2**63 - 1, 6], [2**63 - 1, 2**63 - 1]])
def test_whole_times_that_are_too_large_or_fall_are_rejected(times: list[int]) -> None:
    with pytest.raises(UsageError, match=r"lies before|too large"):
        exact_ticks(np.array(times, dtype=np.int64), "t")


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
        (3, "a value of type int is not a trace"),
        ({"p": [1]}, "no column time, t or timestamp"),
        ({"t": [], "p": []}, "no rows"),
        ({"t": [1, 0], "p": [1, 1]}, "the time of row 1 lies before"),
        ({"t": [0, 1], "p": [1]}, "1 values for 2 times"),
        ({"t": [0, float("nan")], "p": [1, 1]}, "the time of row 1 is missing"),
        ({"t": ["a"], "p": [1]}, "the times are not numbers"),
        ({"t": [0], "p": [None]}, "never has a value"),
        ({"t": [0], "p": [[1]]}, "not a one-dimensional array"),
    ],
)
def test_rejections(data: Any, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        open_trace(data).read()


@pytest.mark.parametrize("row", [1, 1023, 1024, 1025, 2048, 2999])
def test_a_time_before_the_one_above_is_rejected_wherever_it_stands(row: int) -> None:
    times = np.arange(3000) / 4
    times[row] = times[row - 1] - 0.25
    with pytest.raises(UsageError, match="lies before"):
        exact_ticks(times, "t")
