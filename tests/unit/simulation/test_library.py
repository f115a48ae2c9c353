"""`tachk.simulate`."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.main import app

MODEL = """
time_unit = 10 ms;
int[0, 9] count = 0;
bool odd = false;
process P() {
    clock x;
    init location On { invariant x <= 2; to Off { guard x >= 1; assign x = 0, count = (count + 1) % 10, odd = !odd; } }
    location Off { invariant x <= 1; to On { guard x == 1; assign x = 0; } }
}
system P;
"""


def test_runs_have_columns() -> None:
    model = tachk.loads(MODEL)
    drawn = tachk.simulate(model, runs=3, until="1 s", seed=5, threads=2)
    assert [run.number for run in drawn] == [0, 1, 2]
    run = drawn[1]
    assert run.end == Fraction(100)
    assert run.times[-1] == 1000  # ms
    assert set(run["P"]) == {"On", "Off"}
    assert run["odd"].dtype == bool
    columns = drawn.to_columns()
    assert len(columns["run"]) == len(columns["count"]) == sum(run.trace.rows for run in drawn)
    # The same run alone, by another number of threads.
    (alone,) = tachk.simulate(model, until="1 s", seed=5, first=1)
    assert np.array_equal(alone.times, run.times)
    assert np.array_equal(alone["count"], run["count"])
    assert not np.array_equal(drawn[0].times, run.times)
    assert len(drawn[1:]) == 2


def test_a_clock_that_is_set_to_another_one_goes_on_from_there() -> None:
    model = tachk.loads(
        """process P() {
            clock x, y;
            init location A { invariant x <= 2; to B { guard x >= 2; assign x = 0, y = x + 3; } }
            location B { invariant x <= 1; to C { guard y >= 4 && y <= 4; } }
            location C { invariant x <= 3; to D { guard x >= 3; assign y = x; } }
            location D { invariant y <= 4; to E { guard y >= 4; } }
            location E {}
        }
        system P;"""
    )
    for run in tachk.simulate(model, runs=5, until="9"):
        changes = [0, *(np.flatnonzero(run["P"][1:] != run["P"][:-1]) + 1)]
        assert [(run["P"][at], run.times[at]) for at in changes] == [("A", 0), ("B", 2), ("C", 3), ("D", 5), ("E", 6)]


@pytest.mark.parametrize("wrong", [{"policy": "fast"}, {"runs": 0}, {"until": "1 parsec"}, {"fault": "lost"}])
def test_arguments_without_meaning_are_rejected(wrong: dict[str, object]) -> None:
    with pytest.raises(UsageError):
        tachk.simulate(tachk.loads(MODEL), **wrong)  # type: ignore[arg-type]


def test_all_runs_are_written_while_they_are_evaluated(tmp_path: Path) -> None:
    model, out = tmp_path / "m.ta", tmp_path / "out.csv"
    model.write_text(MODEL)
    line = ["simulate", str(model), "--runs", "5", "--until", "1 s", "--monitor", "G (count < 9)", "-o", str(out)]
    written = []
    for more in ([], ["--all-runs"]):
        assert app.main([*line, "--monitor", "G (count < 10)", *more], standalone_mode=False) == 0
        written.append({row.split(",")[0] for row in out.read_text().splitlines()[1:]})
    assert written == [set(), {"0", "1", "2", "3", "4"}]
