"""Sweeps of statistical queries: a probability with its interval in each cell."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from jsonschema import Draft202012Validator

import tachk
from tachk.cli.main import app
from tachk.simulation.statistics.estimate import Settings
from tachk.simulation.statistics.sampling import RunSource

SCHEMA = json.loads((Path(__file__).parents[4] / "docs/schema/sweep.schema.json").read_text(encoding="utf-8"))

LINK = """
const int LOSS = 10;
const int TRIES = 3;
int[0, 20] tries;
process Sender() {
    clock x;
    init location Send {
        invariant x <= 1;
        to way { guard x >= 1 && tries < TRIES; assign x = 0, tries = tries + 1; }
        to Lost { guard x >= 1 && tries == TRIES; }
    }
    location Done;
    location Lost;
    branchpoint way { to Done { probability 100 - LOSS; } to Send { probability LOSS; } }
}
system Sender;
property safe: A[] tries <= TRIES;
property arrives: Pr[<=100](<> Sender.Done);
property sure: Pr[<=100](<> Sender.Done) >= 0.6;
property often: E[<=100; 200](max: tries);
"""


@pytest.fixture(scope="module")
def link(tmp_path_factory: pytest.TempPathFactory) -> tachk.Model:
    path = tmp_path_factory.mktemp("sweep") / "link.ta"
    path.write_text(LINK, encoding="utf-8")
    return tachk.load(path)


def test_cells_have_intervals(link: tachk.Model, tmp_path: Path) -> None:
    settings = Settings(RunSource(seed=2), confidence=0.999, half_width=0.04)
    found = link.sweep(over=["LOSS=20,50", "TRIES=1"], processes=1, settings=settings)
    Draft202012Validator(SCHEMA).validate(found.to_dict())
    rows = {(row["LOSS"], row["property"]): row for row in found.rows}
    assert [row["property"] for row in found.rows] == ["safe", "arrives", "sure", "often"] * 2
    for loss in (20, 50):
        arrives = rows[loss, "arrives"]
        assert arrives["answer"] == "estimated"
        low, high, runs = arrives["low"], arrives["high"], arrives["runs"]
        assert isinstance(low, float) and isinstance(high, float) and isinstance(runs, int)
        assert low <= 1 - loss / 100 <= high <= low + 0.08
        assert rows[loss, "safe"]["answer"] == "holds" and rows[loss, "safe"]["estimate"] is None
    assert [rows[loss, "sure"]["answer"] for loss in (20, 50)] == ["holds", "fails"]
    assert rows[20, "often"]["estimate"] == 1
    text = found.to_text()
    assert "estimated in 2" in text and "holds in 1, fails in 1" in text
    found.plot(tmp_path / "map.svg", "estimate")
    assert "estimated probability" in (tmp_path / "map.svg").read_text(encoding="utf-8")


def test_a_named_query_is_estimated_alone(link: tachk.Model) -> None:
    found = link.sweep(over="LOSS=20", property="arrives", processes=1)
    assert [row["property"] for row in found.rows] == ["arrives"]


def test_cells_split_as_estimate_does(tmp_path: Path) -> None:
    path = tmp_path / "link.ta"
    path.write_text(LINK, encoding="utf-8")
    query = "Pr[<=100](<> Sender.Lost)"
    options = ["--splitting", "--effort", "50", "--relative", "0.5", "--seed", "3", "--format", "json"]

    def ran(command: str, *further: str) -> dict[str, Any]:
        result = CliRunner().invoke(app, [command, str(path), query, "-D", "TRIES=4", *options, *further])
        assert result.exit_code == 0, result.output
        found: dict[str, Any] = json.loads(result.stdout)
        return found

    table = ran("sweep", "-D", "LOSS=5,10", "-j", "1")
    Draft202012Validator(SCHEMA).validate(table)
    rows = {row["LOSS"]: row for row in table["rows"]}
    for loss, row in rows.items():
        answer = ran("estimate", "-D", f"LOSS={loss}")["answers"][0]
        assert answer["kind"] == "splitting"
        assert row["estimate"] == answer["mean"]
        assert [row[name] for name in ("low", "high")] == [answer[name] for name in ("low", "high")]
        assert 0 < row["low"] <= row["estimate"] <= row["high"] < 0.01
    assert rows[5]["high"] < rows[10]["low"]
