"""One requirement, "nothing arrives while the subscriber sleeps for 50 s", interpreted in three ways, on one trace."""

from __future__ import annotations

import csv
from fractions import Fraction
from pathlib import Path

import pytest

import tachk
from tachk.recordings.traces.node_signal import Truth
from tests.support.exact_monitor import verdict
from tests.support.exact_trace import ExactTrace
from tests.support.tricky import read_formula

RECORDING = Path(__file__).parents[2] / "examples/sleeping_subscriber.csv"

READINGS = {
    "NIWS_weak": ("G (asleep -> F[0,50] !arrives)", True),
    "NIWS": ("G (asleep -> !arrives)", False),
    "NIWS_strong": ("G (rise(asleep) -> G[0,50] !arrives)", None),
}
"""At every moment of sleep silence within 50 s: always so. Silence during sleep: broken at 170 s. Silence for 50 s from
falling asleep: so after 100 s, open after 300 s, because the trace ends at 330 s."""


def recorded() -> ExactTrace:
    with RECORDING.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    times = tuple(Fraction(row["time [s]"]) for row in rows)
    return ExactTrace(
        times, {name: tuple(row[name] == "1" for row in rows) for name in ("asleep", "arrives")}, times[-1]
    )


@pytest.mark.parametrize("name", READINGS)
def test_the_readings_differ(name: str) -> None:
    text, expected = READINGS[name]
    assert verdict(read_formula(text), recorded()).truth is expected
    assert tachk.monitor(text, RECORDING).truth is (Truth.UNDETERMINED if expected is None else Truth(expected))


def test_the_window_at_every_moment_of_sleep_is_too_strong() -> None:
    """It reaches beyond waking: a message 10 s after the sleep breaks it."""
    assert verdict(read_formula("G[180,250] (asleep -> G[0,50] !arrives)"), recorded()).truth is False
    assert verdict(read_formula("G[180,250] (asleep -> !arrives)"), recorded()).truth is True
