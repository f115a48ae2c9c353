"""Event by event: the verdicts of the whole trace, as early as they are decided, with bounded memory."""

from __future__ import annotations

import datetime
import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.time_units import usual_decimals
from tachk.report.monitor.online_report import decided_to_text
from tachk.report.monitor.words import explain_verdict

EVENTS = [(0, 0, 0, 1), (1, 1, 0, 2), (2, 1, 0, 3), (4, 0, 0, 5), (6.5, 0, 0, 2), (9, 0, 1, 1)]


def test_verdicts_come_as_early_as_they_are_decided() -> None:
    monitor = tachk.Monitor(["G (p -> F[0, 3 s] (q && x < 5))", "F (x > 4)", "G x < 6"], unit="s")
    seen = [monitor.update(time, p=p, q=q, x=x).word for time, p, q, x in EVENTS]
    assert seen == ["undetermined"] * 4 + ["false"] * 2
    late, reached, low = monitor.verdicts
    assert (late.decided_at, late.truth) == (Fraction(13, 2), tachk.Truth.FALSE)
    assert (reached.decided_at, reached.truth) == (Fraction(13, 2), tachk.Truth.TRUE)
    assert low.truth is tachk.Truth.UNDETERMINED
    assert not monitor.decided
    assert [v.truth.word for v in monitor.finish(12)] == ["false", "true", "true"]
    assert monitor["p3"].decided_at == 12


def test_a_violation_is_explained_from_the_rows_that_were_kept() -> None:
    monitor = tachk.Monitor("G (p -> F[0, 3] q)", unit="s")
    for time in range(1000):
        monitor.update(time, p=time == 900, q=False)
    (verdict,) = monitor.verdicts
    assert verdict.story is not None
    assert explain_verdict(verdict.story, verdict.story.verdicts[0])[:2] == (
        "trigger: `p` becomes true at 900 s",
        "`q` is never true from 900 s to 903 s, the deadline",
    )
    assert decided_to_text(verdict, "s", False).startswith("904 s: p1 is false\n  trigger: `p` becomes true at 900 s\n")


def test_time_can_pass_without_events() -> None:
    monitor = tachk.Monitor("G (p -> F[0, 3] q)")
    assert monitor.update(0, p=1, q=0) is tachk.Truth.UNDETERMINED
    assert monitor.advance(3) is tachk.Truth.UNDETERMINED
    assert monitor.advance(Fraction(7, 2)) is tachk.Truth.FALSE


def test_values_hold_until_they_are_given_anew() -> None:
    monitor = tachk.Monitor("G (a -> b)")
    with pytest.raises(UsageError, match="'b' has no value yet"):
        monitor.update(0, a=1)
    monitor.update(0, {"a": 0, "b": 0, "other": 5})
    assert monitor.update(1, a=1) is tachk.Truth.UNDETERMINED
    assert monitor.update(2, a=0) is tachk.Truth.FALSE


def test_the_end_can_be_given_a_meaning() -> None:
    for end, truth in (("weak", "true"), ("strong", "false"), ("undetermined", "undetermined")):
        monitor = tachk.Monitor("G (p -> F[0, 3] q)", end=end)
        monitor.update(0, p=1, q=0)
        assert monitor.truth is tachk.Truth.UNDETERMINED
        (verdict,) = monitor.finish(2)
        assert (verdict.truth.word, verdict.measured.word) == (truth, "undetermined")


def test_rejections() -> None:
    monitor = tachk.Monitor("G p", decimals=1)
    with pytest.raises(UsageError, match="no rows"):
        monitor.finish()
    monitor.update(5, p=1)
    with pytest.raises(UsageError, match="lies before"):
        monitor.update(4, p=1)
    with pytest.raises(UsageError, match="finer than"):
        monitor.update(Fraction(51, 9), p=1)


def test_memory_is_bounded() -> None:
    monitor = tachk.Monitor("G (p -> F[0, 50] q)")
    sizes = []
    for block in range(20):
        times = np.arange(block * 1000, (block + 1) * 1000, dtype=np.int64)
        flags = {"p": (times % 7 == 0).astype(np.uint8), "q": (times % 11 == 0).astype(np.uint8)}
        assert monitor.push(times, flags, 0) is tachk.Truth.UNDETERMINED
        sizes.append(monitor.bytes_used)
    assert max(sizes[10:]) < 1.1 * max(sizes[:10])
    assert monitor.rows == 20_000


FORMULAS = ("G (p -> F[0, 3] q)", "G (p -> G[0, 2) x < 4)", "F[1, 5] (q && x > 2)", "G (q -> O[0, 2] p)", "p U q")
ROWS = st.lists(st.tuples(st.integers(0, 3), st.booleans(), st.booleans(), st.integers(0, 5)), min_size=1, max_size=12)


@given(ROWS, st.sampled_from(FORMULAS))
def test_the_end_agrees_with_the_judgement_of_the_whole(rows: list[tuple[int, bool, bool, int]], formula: str) -> None:
    times = np.cumsum([row[0] for row in rows])
    columns = {name: [row[place] for row in rows] for place, name in enumerate("pqx", 1)}
    report = tachk.monitor(formula, {"t": times, **columns})
    monitor = tachk.Monitor(formula)
    for time, (_, p, q, x) in zip(times.tolist(), rows, strict=True):
        monitor.update(time, p=p, q=q, x=x)
    (verdict,) = monitor.finish()
    whole = report[0]
    assert verdict.truth is whole.truth
    if verdict.story is not None and whole.finding is not None:
        found = verdict.story.verdicts[0].finding
        assert found is not None
        assert verdict.story.trace.clock(found.cell // 2) == report.record.trace.clock(whole.finding.cell // 2)


def test_values_that_are_none_or_not_a_number_stay_and_others_are_rejected() -> None:
    monitor = tachk.Monitor("G (x < 5)")
    with pytest.raises(UsageError, match="'x' has no value yet"):
        monitor.update(0, x=float("nan"))
    monitor.update(0, x=1)
    monitor.update(1, {"x": None})  # type: ignore[dict-item]
    assert monitor.update(2, x=float("nan")) is tachk.Truth.UNDETERMINED
    with pytest.raises(UsageError, match="'fast' of column 'x' is not a number"):
        monitor.update(3, {"x": "fast"})  # type: ignore[dict-item]
    assert monitor.update(2.5, x=float("-inf")) is tachk.Truth.UNDETERMINED
    with pytest.raises(UsageError, match="the time nan"):
        monitor.update(float("nan"), x=1)
    assert monitor.finish(4)[0].truth is tachk.Truth.TRUE


def test_a_truth_is_shown_as_a_word() -> None:
    truth = tachk.Monitor("G x").update(0, x=1)
    assert (str(truth), f"{truth}") == ("undetermined", "undetermined")


def test_a_time_too_far_away_to_be_counted_is_rejected() -> None:
    monitor = tachk.Monitor("G p", decimals=9)
    monitor.update(0, p=1)
    with pytest.raises(UsageError, match="too far from the beginning") as refusal:
        monitor.update(10**9, p=1)
    assert refusal.value.help == "allow fewer decimals, say 6"


@pytest.mark.parametrize(("unit", "decimals"), [("", 9), ("s", 9), ("ms", 6), ("100 us", 5), ("ns", 0), ("h", 9)])
def test_times_are_counted_in_nanoseconds_where_nothing_else_is_said(unit: str, decimals: int) -> None:
    assert usual_decimals(unit) == decimals
    if unit:
        assert tachk.Monitor("G p", unit=unit.split()[-1]).decimals == usual_decimals(unit.split()[-1])


CASES = st.lists(st.tuples(st.integers(0, 3), st.booleans(), st.booleans(), st.integers(0, 5)), min_size=1, max_size=14)


@given(CASES, st.sampled_from((*FORMULAS, "G x < 5", "F x > 4", "G (x < 4 || q)", "G rise(x < 3)")), st.data())
def test_events_chunks_and_whole_traces_agree_to_the_bounds(
    rows: list[tuple[int, bool, bool, int]], formula: str, data: st.DataObject
) -> None:
    """However the rows are cut into calls, and also where the verdict was decided long before the end."""
    times = 1_000_000 + np.cumsum([row[0] for row in rows])
    columns: dict[str, np.ndarray] = {name: np.array([row[n] for row in rows]) for n, name in enumerate("pqx", 1)}
    whole = tachk.monitor(formula, {"t": times / 4, **columns})[0]
    monitor = tachk.Monitor(formula, robustness=True)
    at = 0
    while at < len(rows):
        size = data.draw(st.integers(0, 4))
        if size == 0:
            monitor.update(float(times[at]) / 4, {name: values[at] for name, values in columns.items()})
            at += 1
        else:
            chunk = slice(at, at + size)
            monitor.push(times[chunk] * 25, {name: values[chunk] for name, values in columns.items()}, 2)
            at = min(at + size, len(rows))
        if data.draw(st.booleans()):
            ((low, high),) = monitor.robustness
            assert monitor.verdicts[0].robustness == (low, high)
            assert whole.robustness is not None
            assert low <= whole.robustness[0] and whole.robustness[1] <= high
    (verdict,) = monitor.finish()
    assert (verdict.truth, verdict.robustness) == (whole.truth, whole.robustness)
    assert monitor.rows == len(rows)


def test_bounds_are_kept_if_they_are_wanted() -> None:
    monitor = tachk.Monitor(["G (x < 5)", "F (x > 7)"], robustness=True)
    monitor.update(0, x=1)
    monitor.update(1, x=3)
    assert monitor.robustness == ((-math.inf, 4), (-6, math.inf))
    with pytest.raises(UsageError, match="keeps no robustness"):
        _ = tachk.Monitor("G (x < 5)").robustness


def test_bounds_go_on_after_the_decision() -> None:
    monitor = tachk.Monitor("G (x < 5)", robustness=True)
    for time, x in [(0, 1), (1, 6), (2, 10), (3, 1)]:
        monitor.update(time, {"x": x})
    assert monitor.decided
    (verdict,) = monitor.finish()
    assert (verdict.robustness, verdict.decided_at, verdict.violated) == ((-5, -5), 2, (1, 2))


@pytest.mark.parametrize(
    ("unit", "times"),
    [
        ("s", [1_772_323_200.5, 1_772_323_201.25, 1_772_323_204.5]),
        ("s", [Fraction(3_544_646_401, 2), Fraction(7_089_292_805, 4), Fraction(3_544_646_409, 2)]),
        ("ns", [1_772_323_200_500_000_000, 1_772_323_201_250_000_000, 1_772_323_204_500_000_000]),
        ("ms", [1_772_323_200_500, 1_772_323_201_250, 1_772_323_204_500]),
    ],
)
def test_clocks_may_show_the_time_since_1970(unit: str, times: list[float]) -> None:
    monitor = tachk.Monitor("G (p -> F[0, 3 s] q)", unit=unit)
    truths = [monitor.update(time, p=number == 1, q=False).word for number, time in enumerate(times)]
    assert truths == ["undetermined", "undetermined", "false"]
    (verdict,) = monitor.verdicts
    assert verdict.violated is not None and verdict.violated[0] == times[1]
    assert verdict.story is not None and verdict.story.trace.clock(0) == times[0]
    assert monitor.record().begin == times[0]


def test_times_that_differ_by_too_little_are_rejected_and_change_nothing() -> None:
    monitor = tachk.Monitor("G (x < 5)", unit="s")
    monitor.update(0.0, x=1)
    with pytest.raises(UsageError, match=r"row 1, at 1e-11: .* differs from that of the row before") as refusal:
        monitor.update(1e-11, x=9)
    assert refusal.value.help == "allow more decimals, or round the times where they should be equal"
    assert monitor.finish(1)[0].truth is tachk.Truth.TRUE
    monitor = tachk.Monitor("G (x < 5)", unit="s", decimals=12)
    monitor.update(0.0, x=1)
    monitor.update(1e-11, x=9)
    assert monitor.update(2e-11, x=1) is tachk.Truth.FALSE


@pytest.mark.parametrize(("time", "tick"), [(0.1, 1), (0.3, 3), (1_700_000_000.3, 17_000_000_003), (-0.7, -7)])
def test_floating_point_times_are_the_decimal_numbers_that_they_print_as(time: float, tick: int) -> None:
    monitor = tachk.Monitor("G p", decimals=9)
    monitor.update(time, p=1)
    assert monitor.record().begin == Fraction(tick, 10)


def test_rejections_say_row_and_column() -> None:
    monitor = tachk.Monitor(["G (x < 5)", "G (y < 5)"])
    monitor.update(0, x=1, y=1)
    with pytest.raises(UsageError, match="row 1, at 2: the value 'a' of column 'y' is not a number"):
        monitor.update(2, {"x": 1, "y": "a"})  # type: ignore[dict-item]
    with pytest.raises(UsageError, match="row 1, at -1: the time -1 lies before"):
        monitor.update(-1, x=1)
    with pytest.raises(UsageError, match="not a number") as refusal:
        monitor.update(datetime.datetime(2026, 1, 1), x=1)  # type: ignore[arg-type]
    assert "timestamp" in str(refusal.value.help)
    with pytest.raises(UsageError, match="row 3, at 3: the time 3 lies before"):
        monitor.push(np.array([3, 4, 3]), {"x": np.ones(3), "y": np.ones(3)}, 0)
    with pytest.raises(UsageError, match="no column 'y'"):
        monitor.push(np.array([3, 4]), {"x": np.ones(2)}, 0)
    with pytest.raises(UsageError, match="'y' has 3 values for 2 times"):
        monitor.push(np.array([3, 4]), {"x": np.ones(2), "y": np.ones(3)}, 0)
    with pytest.raises(UsageError, match="finer than those of the monitor"):
        monitor.push(np.array([3, 4]), {"x": np.ones(2), "y": np.ones(2)}, 12)
    assert monitor.rows == 1
    monitor.push(np.array([3, 4]), {"x": [float("nan"), 2], "y": [None, True]}, 0)
    assert [v.truth.word for v in monitor.finish(9)] == ["true", "true"]
    with pytest.raises(UsageError, match="the trace is over"):
        monitor.update(10, x=1)


@pytest.mark.parametrize("row", [1, 2, 63, 1024, 1025, 2999])
@pytest.mark.parametrize(("begin", "decimals"), [(0, 9), (5, 9), (-7, 3), (10**12, 6)])
def test_a_fault_in_a_long_chunk_is_found_in_its_row(row: int, begin: int, decimals: int) -> None:
    """Whether times are ticks already, from 0 on, or are counted, and wherever blocks of them end."""
    values = {"x": np.ones(3000)}
    times = begin + np.arange(3000)
    monitor = tachk.Monitor("G x < 5", unit="s")
    backwards = times.copy()
    backwards[row:] -= 2
    with pytest.raises(UsageError, match=f"row {row}, .* lies before the one given last"):
        monitor.push(backwards, values, decimals)
    far = times.copy()
    far[row:] += 2**58 // 10 ** (9 - decimals)
    with pytest.raises(UsageError, match=f"row {row}, .* too far from the beginning"):
        monitor.push(far, values, decimals)
    assert monitor.rows == 0
    values["x"][row] = 5
    monitor.push(times, values, decimals)
    violated = monitor.finish()[0].violated
    assert violated is not None and violated[0] == Fraction(int(times[row]), 10**decimals)


def test_a_violation_in_a_long_chunk_is_explained() -> None:
    monitor = tachk.Monitor("G (p -> F[0, 3] q)", unit="s", robustness=True)
    times = np.arange(5000)
    for first in range(0, 5000, 1000):
        chunk = times[first : first + 1000]
        monitor.push(chunk, {"p": chunk == 2_500, "q": np.zeros(1000)}, 0)
    (verdict,) = monitor.verdicts
    assert verdict.story is not None
    assert explain_verdict(verdict.story, verdict.story.verdicts[0])[0] == "trigger: `p` becomes true at 2500 s"


def test_a_condition_is_0_or_1_in_every_row() -> None:
    monitor = tachk.Monitor("G (ok || x > 3)")
    monitor.update(0, ok=True, x=9)
    with pytest.raises(UsageError, match="row 1, at 1: the value 0\\.5 of column 'ok' is not a truth value"):
        monitor.update(1, ok=0.5)
    with pytest.raises(UsageError, match="row 2, at 2: the value 2\\.0 of column 'ok' is not a truth value"):
        monitor.push(np.array([1, 2]), {"ok": np.array([0.0, 2.0]), "x": np.array([5.0, 5.0])}, 0)
    assert monitor.update(1, ok=None, x=7) is tachk.Truth.UNDETERMINED
    assert monitor.rows == 2
    monitor.push(np.array([2, 3]), {"ok": np.array([0.0, 1.0]), "x": np.array([5.0, 2.0])}, 0)
    assert monitor.finish()[0].truth is tachk.Truth.TRUE


def test_small_integers_that_are_pushed_are_numbers() -> None:
    monitor = tachk.Monitor("G (x < 2)")
    assert monitor.push(np.array([0, 1]), {"x": np.array([3, 1], np.uint8)}, 0) is tachk.Truth.FALSE
