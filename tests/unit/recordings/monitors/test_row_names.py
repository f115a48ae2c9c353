"""`arrived(x)`, that a row gives a value, and `time`, when the last row was: in all forms of a trace, row by row."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import InputError
from tachk.cli.main import app
from tests.support.seeds import seeds

Row = tuple[Fraction, dict[str, float | None]]
"""A time in tenths, and the values that it gives."""

FORMULAS = (
    "G F[0, 0.5] arrived(x)",
    "arrived(y)",
    "arrived(x)",
    "G (arrived(x) -> F(0, 0.3] arrived(y))",
    "F[0.2, 0.2] arrived(x)",
    "G (arrived(y) -> O[0, 0.2] arrived(x))",
    "G (rise(y > 1) -> F[0, 0.4] arrived(x))",
    "G !(arrived(x) && arrived(y))",
    "G (time < 1)",
    "G (time - x < 0.4)",
    "F (time >= 0.5 && arrived(x))",
)


def rows_of(seed: int) -> list[Row]:
    """Some of them with equal times, values that stay, or the value that there was."""
    random = Random(seed)
    time, rows = Fraction(random.choice((0, 3, 50)), 10), []
    for number in range(random.randint(1, 12)):
        given: dict[str, float | None] = {
            name: None if number and random.random() < 0.4 else random.choice((0.0, 0.2, 1.0, 2.5)) for name in "xy"
        }
        rows.append((time, given))
        time += Fraction(random.choice((0, 1, 1, 2, 4)), 10)
    return rows


def with_marks(rows: list[Row]) -> dict[str, list[float]]:
    """The same with a row for each instant, and columns that say what the names mean: `cx` is another number than
    before where x arrives, `bx` is 1 where it does so at the beginning, `now` is the time."""
    found: dict[str, list[float]] = {name: [] for name in ("time", "x", "y", "cx", "cy", "bx", "by", "now")}
    held, counts = {"x": math.nan, "y": math.nan}, {"x": 0, "y": 0}
    for time in sorted({time for time, _ in rows}):
        found["time"].append(float(time))
        found["now"].append(float(time))
        for name in "xy":
            given = [values[name] for at, values in rows if at == time and values[name] is not None]
            held[name] = float(given[-1] or 0) if given else held[name]
            counts[name] += bool(given)
            found[name].append(held[name])
            found[f"c{name}"].append(counts[name])
            found[f"b{name}"].append(1.0)  # each row of the beginning gives every column a value
    return found


def verdicts(report: Any) -> list[str]:
    return [verdict.truth.word for verdict in report]


def forms(rows: list[Row], folder: Path) -> Iterator[tuple[str, list[str]]]:
    """The verdicts on the rows in each form."""
    cells = [["" if value is None else str(value) for value in given.values()] for _, given in rows]
    text = "time,x,y\n" + "".join(f"{float(t)},{','.join(c)}\n" for (t, _), c in zip(rows, cells, strict=True))
    csv, lines = folder / "a.csv", folder / "a.jsonl"
    csv.write_text(text, encoding="utf-8")
    lines.write_text("".join(json.dumps({"time": float(t), **g}) + "\n" for t, g in rows), encoding="utf-8")
    arrays = {"time": [float(t) for t, _ in rows], **{n: [g[n] for _, g in rows] for n in "xy"}}
    yield "lists", verdicts(tachk.monitor(FORMULAS, arrays))
    numbers = {name: np.array(values, dtype=float) for name, values in arrays.items()}
    yield "arrays", verdicts(tachk.monitor(FORMULAS, numbers))
    yield "csv", verdicts(tachk.monitor(FORMULAS, csv))
    yield "json lines", verdicts(tachk.monitor(FORMULAS, lines))
    monitor = tachk.Monitor(FORMULAS)
    for time, given in rows:
        monitor.update(float(time), given)
    yield "updates", verdicts(monitor.finish())
    pushed = tachk.Monitor(FORMULAS)
    ticks = np.array([int(10 * t) for t, _ in rows])
    for part in (slice(0, 2), slice(2, None)):
        if len(ticks[part]):
            pushed.push(ticks[part], {n: numbers[n][part] for n in "xy"}, 1)
    yield "pushes", verdicts(pushed.finish())


@pytest.mark.parametrize("seed", seeds(range(25)))
def test_arrivals_and_times_mean_the_same_in_every_form(seed: int, tmp_path: Path) -> None:
    rows = rows_of(seed)
    plain = [formula.replace("time", "now") for formula in FORMULAS]
    for name in "xy":
        meant = f"(change(c{name}) || rise(true) && b{name} > 0)"
        plain = [formula.replace(f"arrived({name})", meant) for formula in plain]
    expected = verdicts(tachk.monitor(plain, with_marks(rows)))
    for form, found in forms(rows, tmp_path):
        assert found == expected, (form, rows)


@pytest.mark.parametrize("ending", ["csv", "jsonl"])
@pytest.mark.parametrize("seed", seeds(range(6)))
def test_the_command_says_the_same_row_by_row(seed: int, ending: str, tmp_path: Path) -> None:
    dict(forms(rows_of(seed), tmp_path))
    for formula in FORMULAS:
        whole, rows = (
            CliRunner().invoke(app, ["monitor", formula, str(tmp_path / f"a.{ending}"), "--quiet", *more]).exit_code
            for more in ([], ["--online"])
        )
        assert whole == rows, formula


def test_a_topic_arrives_with_any_of_its_columns() -> None:
    trace = {"time": [0, 1, 2, 3], "hb.n": [1, None, None, 1], "hb.m[0]": [0, None, 0, None], "hbx": [1, 1, 1, 1]}
    assert tachk.monitor("G[0, 3] F[0, 2] arrived(hb)", trace, end="weak").truth is tachk.Truth.TRUE
    assert tachk.monitor("F[1, 1] arrived(hb)", trace).truth is tachk.Truth.FALSE
    assert tachk.monitor("F[1, 1] arrived(hbx)", trace).truth is tachk.Truth.TRUE
    assert tachk.monitor("F[2, 2] arrived(hb.m)", trace).truth is tachk.Truth.TRUE


def test_what_arrives_need_hold_no_numbers(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text("time,who,x\n0,,1\n1,ann,2\n2,,3\n3,bob,4\n", encoding="utf-8")
    assert tachk.monitor("G (arrived(who) -> x == 2 || x == 4)", file).truth is tachk.Truth.TRUE
    assert tachk.monitor("F[2, 2] arrived(who)", file).truth is tachk.Truth.FALSE
    assert tachk.monitor('F (arrived(who) && who == "bob")', file).truth is tachk.Truth.TRUE


def test_the_robustness_of_an_arrival_is_infinite() -> None:
    trace = {"time": [0, 1, 2], "x": [1.0, 1.0, None]}
    report = tachk.monitor(["arrived(x)", "F[1, 1] arrived(x)", "F[2, 2] arrived(x)"], trace)
    assert [verdict.robustness for verdict in report] == [(math.inf,) * 2, (math.inf,) * 2, (-math.inf,) * 2]


def test_a_column_called_time_comes_first(tmp_path: Path) -> None:
    trace = {"t": [0, 1, 2], "time": [7.0, 7.0, 7.0]}
    assert tachk.monitor("G (time == 7)", trace, time="t").truth is tachk.Truth.TRUE
    monitor = tachk.Monitor("G (time == 7)")
    for row in range(3):
        monitor.update(row, {"time": 7})
    assert monitor.finish()[0].truth is tachk.Truth.TRUE


def test_the_time_is_that_of_the_clock_in_units_of_the_trace() -> None:
    trace = {"time [ms]": [1000, 1500, 2500], "sent": [990.0, 1480.0, 2100.0]}
    (verdict,) = tachk.monitor("G (time - sent <= 400)", trace)
    assert (verdict.truth, verdict.robustness) == (tachk.Truth.TRUE, (0, 0))
    assert tachk.monitor("G (time - sent < LATE)", trace, constants={"LATE": 400}).truth is tachk.Truth.FALSE
    assert tachk.mine("G (time - sent <= LATE)", [trace], {"LATE": (0, 1000)}).value == 400


def test_the_tightest_heartbeat_is_mined() -> None:
    trace = {"time": [0, 1, 2, 5, 6], "x": [1, 1, 1, 1, 1]}
    assert tachk.mine("G F[0, T] arrived(x)", [trace], {"T": (0, 10)}).value == 3


def test_what_does_not_arrive_is_reported() -> None:
    with pytest.raises(InputError) as refusal:
        tachk.monitor("G F[0, 5] arrived(speed)", {"time": [0, 1], "sped": [1, 2]})
    (found,) = refusal.value.diagnostics
    assert (found.code, found.help) == ("E0901", "did you mean `sped`?")
