"""The same rows as CSV, JSON lines, data frame and Parquet have the same times, verdicts and robustness, however the
text was printed from the doubles."""

import random
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import tachk
from tachk.recordings.traces.trace_files import open_trace
from tests.support.seeds import seeds

pytestmark = pytest.mark.drawn

BASES = (0.0, 0.25, -3.0, 1e3, 2.3e6, 9.9e6, 1e9, 1764000000.0, 1764000000.1, 1764000000.1234567, 1764000000099.9)
FORMS = ("%r", "%.17g", "%.18e", "%.9f", "%.12f", "%.25f")


def clocks_of(draw: random.Random) -> list[float]:
    base, step, count = draw.choice(BASES), draw.choice((0.1, 0.005, 0.001, 1 / 3, 0.25)), draw.randrange(2, 30)
    kind = draw.choice(("multiples", "sums", "random"))
    if kind == "multiples":
        return [base + row * step for row in range(count)]
    if kind == "sums":
        times = [base]
        while len(times) < count:
            times.append(times[-1] + step)
        return times
    return sorted(base + draw.random() * 10 for _ in range(count))


def check(draw: random.Random, folder: Path) -> None:
    form = draw.choice(FORMS)
    texts = [form % time for time in clocks_of(draw)]
    values = [draw.randrange(4) for _ in texts]
    (folder / "a.csv").write_text("t,x\n" + "".join(f"{t},{x}\n" for t, x in zip(texts, values, strict=True)))
    lines = [f'{{"t": {t}, "x": {x}}}\n' for t, x in zip(texts, values, strict=True)]
    (folder / "a.jsonl").write_text("".join(lines))
    frame = pd.DataFrame({"t": [float(text) for text in texts], "x": values})
    frame.to_parquet(folder / "a.parquet")
    deadline = draw.choice(("0.1", "0.05", "0.3", "0.001"))
    formula = f"G (x == 3 -> F[0,{deadline}] x < 2)"
    traces: dict[str, Any] = {"frame": frame, **{end: folder / f"a.{end}" for end in ("csv", "jsonl", "parquet")}}
    found: dict[str, Any] = {}
    for name, trace in traces.items():
        told: Any = tachk.monitor(formula, trace).to_dict()
        read = open_trace(trace).read()
        clocks = [read.clock(int(tick)) for tick in read.times]
        found[name] = (told["results"][0]["verdict"], told["results"][0]["robustness"], clocks)
    assert all(each == found["frame"] for each in found.values()), (form, texts, formula)


@pytest.mark.parametrize("seed", seeds(range(40)))
def test_one_meaning_for_all_readers(seed: int, tmp_path: Path) -> None:
    check(random.Random(seed), tmp_path)


@pytest.mark.parametrize("form", ["%r", "%.17g", "%.18e", "%.9f", "%.12f"])
def test_a_tenth_of_a_second_since_1970(form: str, tmp_path: Path) -> None:
    times = [1764000000 + row * 0.1 for row in range(41)]
    rows = "".join(f"{form % time},{(3, 4, 0)[row % 3]}\n" for row, time in enumerate(times))
    (tmp_path / "a.csv").write_text("t,x\n" + rows)
    read = open_trace(tmp_path / "a.csv").read()
    assert [read.clock(int(tick)) for tick in read.times] == [1764000000 + Fraction(row, 10) for row in range(41)]
    assert tachk.monitor("G (x == 3 -> F[0,0.1] x == 4)", tmp_path / "a.csv").truth is tachk.Truth.TRUE


def test_one_long_time_leaves_the_others_their_decimals() -> None:
    times = np.array([1764000000.1, 1764000000.2, 1764000000.3000002, 1764000000.4])
    read = open_trace({"time": times, "x": [1, 2, 3, 4]}).read()
    assert [str(float(read.clock(int(tick)))) for tick in read.times] == [repr(float(time)) for time in times]
    assert read.clock(int(read.times[1])) == Fraction("1764000000.2")
    assert read.notes == ()


@pytest.mark.parametrize("ending", ["csv", "jsonl"])
def test_times_that_no_double_prints_are_exact(ending: str, tmp_path: Path) -> None:
    texts = ["1764000000.0999999", "1764000000.1000001", "1764000000.5999999"]
    last = ["1764000000.6000002"]
    assert f"{float(last[0]):.17g}" != last[0]
    for times, expected in (
        (texts, [Fraction("1764000000.1"), Fraction("1764000000.1000001"), Fraction("1764000000.6")]),
        (texts + last, [Fraction(time) for time in texts + last]),
    ):
        path = tmp_path / f"a.{ending}"
        if ending == "csv":
            path.write_text("t,x\n" + "".join(f"{time},1\n" for time in times))
        else:
            path.write_text("".join(f'{{"t": {time}, "x": 1}}\n' for time in times))
        read = open_trace(path).read()
        assert [read.clock(int(tick)) for tick in read.times] == expected
        assert bool(read.notes) == (expected[0] != Fraction(times[0]))
