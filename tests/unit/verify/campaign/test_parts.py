"""Parts of a sweep for several jobs, what makes one table of them, and cells of random runs that formulas judge."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from click.testing import CliRunner

import tachk
from tachk.cli.main import app
from tachk.model.grid import Values
from tachk.verify.campaign.job import ComputedCell, Verification, computed

MODEL = """
const int T = 3;
const int LIMIT = 5;
clock x;
double level = 0;
process P() {
    init location A { invariant x <= LIMIT; to B { guard x <= T; assign level = 0.5; } }
    location B;
}
system P;
property reach : E<> P.B;
property likely : Pr[<=10](<> level > 0.1);
"""


@pytest.fixture(autouse=True)
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Other tests look at processes; to start one takes a second."""

    def compute(job: Verification, cells: Sequence[Values], _: float | None) -> Iterator[ComputedCell]:
        yield from (computed(job, values) for values in cells)

    monkeypatch.setattr("tachk.verify.campaign.run.computing", lambda *_: compute)


@pytest.fixture
def model(tmp_path: Path) -> tachk.Model:
    (tmp_path / "m.ta").write_text(MODEL)
    return tachk.load(tmp_path / "m.ta")


def test_parts_make_one_table(model: tachk.Model, tmp_path: Path) -> None:
    whole = model.sweep(over="T=1..5", property="reach", processes=1)
    files = [tmp_path / f"{number}.sqlite" for number in (1, 2, 3)]
    cells = []
    for number, file in enumerate(files, 1):
        part = model.sweep(over="T=1..5", property="reach", store=file, part=(number, 3), processes=1)
        assert part.campaign.unfinished == 0
        cells.append([row["T"] for row in part.rows])
    assert cells == [[1, 4], [2, 5], [3]]
    merged = model.sweep(over="T=1..5", property="reach", merge=files, store=tmp_path / "all.sqlite")
    assert merged.campaign.earlier == 5
    assert [(row["T"], row["answer"]) for row in merged.rows] == [(row["T"], row["answer"]) for row in whole.rows]


def test_what_is_no_part_of_the_sweep(model: tachk.Model, tmp_path: Path) -> None:
    model.sweep(over="T=1..2", property="reach", store=tmp_path / "a.sqlite", processes=1)
    with pytest.raises(tachk.UsageError, match="belongs to another sweep"):
        model.sweep(over="T=1..2", property="likely", merge=[tmp_path / "a.sqlite"])
    with pytest.raises(tachk.UsageError, match="no file"):
        model.sweep(over="T=1..2", property="reach", merge=[tmp_path / "b.sqlite"])
    loaded = tachk.load(model.path, LIMIT=4)
    with pytest.raises(tachk.UsageError, match="belongs to another sweep"):
        loaded.sweep(over="T=1..2", property="reach", store=tmp_path / "a.sqlite")
    with pytest.raises(tachk.UsageError, match="at least one run"):
        model.sweep(over="T=1", monitor="F P.B", runs=0)
    for part in ((0, 3), (4, 3)):
        with pytest.raises(tachk.UsageError, match="there is no part"):
            model.sweep(over="T=1..2", property="reach", part=part)


def test_runs_are_evaluated_in_each_cell(model: tachk.Model) -> None:
    found = model.sweep(over="T=1..3", monitor="F[0,3] P.B", until="10", runs=300, seed=4, processes=1)
    assert [row["property"] for row in found.rows] == ["p1"] * 3
    for row in found.rows:
        low, exact, high = row["low"], row["T"], row["high"]
        assert isinstance(low, float)
        assert isinstance(high, float)
        assert isinstance(exact, int)
        assert low <= exact / 5 <= high
        assert row["runs"] == 300


def test_formulas_beside_properties(model: tachk.Model) -> None:
    found = model.sweep(over="T=3", monitor="F[0,3] P.B", runs=50, property=("reach", "likely"), processes=1)
    assert [row["property"] for row in found.rows] == ["reach", "likely", "p1"]
    assert [row["answer"] for row in found.rows] == ["holds", "estimated", "estimated"]


def test_options(model: tachk.Model, tmp_path: Path) -> None:
    def sweep(*arguments: str) -> tuple[int, str]:
        result = CliRunner().invoke(app, ["sweep", model.path, "-D", "T=1..3", "-j", "1", *arguments])
        return result.exit_code, result.output

    one = str(tmp_path / "1.sqlite")
    status, output = sweep("--property", "reach", "--part", "1/2", "--store", one)
    assert (status, "2 cells, 2 computed" in output) == (0, True)
    status, output = sweep("--property", "reach", "--merge", one)
    assert (status, "3 cells, 1 computed" in output, "2 known from before" in output) == (0, True, True)
    status, output = sweep("--monitor", "F[0,3] P.B", "--until", "10", "--runs", "20")
    assert (status, "p1: estimated in 3" in output) == (0, True)
    assert sweep("--part", "2")[0] == 2
