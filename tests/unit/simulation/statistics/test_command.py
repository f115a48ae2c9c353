"""`tachk estimate`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner
from jsonschema import Draft202012Validator

from tachk.cli.main import app

ROOT = Path(__file__).parents[4]
SCHEMA = json.loads((ROOT / "docs/schema/estimate.schema.json").read_text(encoding="utf-8"))

COIN = """
int[0, 2] side;
clock x;
process Coin() {
    init location Held { invariant x <= 1; to air; }
    location Down;
    branchpoint air {
        to Down { probability 3; assign side = 1; }
        to Down { probability 1; assign side = 2; }
    }
}
system Coin;
property certain: A<> Coin.Down;
property heads: Pr[<=1](<> side == 1) >= 0.6;
property tails: Pr[<=1](<> side == 2) >= 0.6 expect fails;
property often: Pr[<=1](<> side == 1) >= 0.9;
"""


def _run(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, ["estimate", *arguments])
    return result.exit_code, result.output


@pytest.fixture
def coin(tmp_path: Path) -> str:
    path = tmp_path / "coin.ta"
    path.write_text(COIN, encoding="utf-8")
    return str(path)


def test_the_json_follows_its_schema(coin: str) -> None:
    queries = ["Pr[<=1](<> side == 1)", "Pr[<=1](<> side == 1) >= 0.6", "Pr[<=1; 50](<> side == 1) >= 0.1",
               "E[<=1; 30](max: side)", "E[#<=1; 30](max: x)", "simulate [<=1; 2] {side, x}"]  # fmt: skip
    status, output = _run(coin, *queries, "--format", "json", "--seed", "3")
    assert status == 0
    document = json.loads(output)
    Draft202012Validator(SCHEMA).validate(document)
    assert [answer["query"] for answer in document["answers"]] == queries
    probability = document["answers"][0]
    assert probability["low"] <= 0.75 <= probability["high"]
    assert len(probability["times"]) == probability["samples"][0]["hits"]


@pytest.mark.parametrize(("name", "status"), [("heads", 0), ("tails", 0), ("often", 10)])
def test_the_status_says_whether_tests_are_as_expected(coin: str, name: str, status: int) -> None:
    assert _run(coin, "--property", name)[0] == status


def test_all_statistical_properties_are_answered(coin: str) -> None:
    status, output = _run(coin)
    assert status == 10
    assert [line.split(":")[0] for line in output.splitlines() if not line.startswith(" ")] == [
        "heads",
        "tails",
        "often",
    ]


def test_a_test_without_a_decision_is_unknown(coin: str) -> None:
    assert _run(coin, "Pr[<=1](<> side == 1) >= 0.75", "--delta", "0.001", "--max-runs", "300")[0] == 20


def test_a_query_of_another_kind_is_for_verify(coin: str) -> None:
    status, output = _run(coin, "A[] side < 3")
    assert status == 2 and "tachk verify" in output


def test_wrong_queries_keep_no_others_from_being_answered(coin: str, tmp_path: Path) -> None:
    queries = tmp_path / "some.q"
    queries.write_text("Pr[<=1](<> sid == 1)\n\nPr[<=1](<> side == 1) >= 0.5\n", encoding="utf-8")
    status, output = _run(coin, "-q", str(queries))
    assert status == 2
    assert "E0201" in output and "holds" in output


def test_uppaal_files_bring_their_queries(tmp_path: Path) -> None:
    path = tmp_path / "coin.xml"
    path.write_text(
        """<?xml version="1.0" encoding="utf-8"?>
<nta><declaration>int n;</declaration>
<template><name>P</name><location id="id0"><name>A</name><label kind="exponentialrate">1</label></location>
<location id="id1"><name>B</name></location><init ref="id0"/>
<transition><source ref="id0"/><target ref="id1"/></transition></template>
<system>system P;</system>
<queries><query><formula>Pr[&lt;=1; 2000](&lt;&gt; P.B)</formula><comment/></query></queries></nta>""",
        encoding="utf-8",
    )
    status, output = _run(str(path), "--confidence", "0.999", "--format", "json")
    assert status == 0
    found = json.loads(output)["answers"][0]
    assert found["query"] == "Pr[<=1; 2000](<> P.B)"
    assert found["low"] <= 1 - 1 / 2.718281828 <= found["high"]


def test_splitting_answers_in_json(coin: str) -> None:
    query = "Pr[<=1](<> side == 2)"
    status, output = _run(coin, query, "--splitting", "--effort", "200", "--relative", "0.2", "--format", "json")
    assert status == 0
    document = json.loads(output)
    Draft202012Validator(SCHEMA).validate(document)
    found = document["answers"][0]
    assert found["kind"] == "splitting" and found["levels"] == 1
    assert abs(found["mean"] - 0.25) < 0.05


def test_pictures_show_every_answer(coin: str, tmp_path: Path) -> None:
    picture = tmp_path / "all.svg"
    queries = ["Pr[<=1](<> side == 1)", "Pr[<=1](<> side == 1) >= 0.6", "E[<=1; 30](max: side)", "simulate [<=1] {x}"]
    assert _run(coin, *queries, "--plot", str(picture))[0] == 0
    text = picture.read_text(encoding="utf-8")
    assert all(f"q{number}: {query}" in text.replace("&lt;", "<").replace("&gt;", ">")
               for number, query in enumerate(queries, 1))  # fmt: skip
    split = tmp_path / "split.svg"
    assert _run(coin, "Pr[<=1](<> side == 2)", "--splitting", "--effort", "50", "--plot", str(split))[0] == 0
    assert "replications" in split.read_text(encoding="utf-8")


def test_one_run_says_nothing_of_a_mean(coin: str) -> None:
    status, output = _run(coin, "E[<=1; 1](max: side)", "--format", "json")
    assert status == 0
    document = json.loads(output, parse_constant=pytest.fail)
    Draft202012Validator(SCHEMA).validate(document)
    assert "say nothing" in _run(coin, "E[<=1; 1](max: side)")[1]


def test_floating_point_variables_are_read(tmp_path: Path) -> None:
    path = tmp_path / "warm.ta"
    path.write_text(
        """double heat = 1.5;
process P() {
    clock x;
    init location A { invariant x <= 1; to A { guard x >= 1; assign x = 0, heat = heat * 2.0; } }
}
system P;""",
        encoding="utf-8",
    )
    queries = "Pr[<=3; 20](<> heat > 11.0)", "E[<=3; 20](max: heat)", "simulate [<=3] {heat}"
    status, output = _run(str(path), *queries, "--format", "json")
    assert status == 0
    probability, mean, drawn = json.loads(output)["answers"]
    assert probability["frequency"] == 1
    assert mean["mean"] == 12 and mean["low"] is None
    assert drawn["runs"][0]["lines"][0]["values"][-1] == 12


@pytest.mark.parametrize(("update", "bounded"), [("x = 0", True), ("x = t", True), ("x = x + 5", False)])
def test_a_clock_that_is_advanced_may_be_larger_than_the_time_that_passed(
    tmp_path: Path, update: str, bounded: bool
) -> None:
    path = tmp_path / "advancing.ta"
    location = f"location a {{ invariant t <= 1; to a {{ guard t >= 1; assign {update}, t = 0; }} }}"
    path.write_text(f"clock x, t; process P() {{ init {location} }} system P;", encoding="utf-8")
    _, output = _run(str(path), "E[<=3; 30](max: x)", "--format", "json", "--seed", "3")
    (answer,) = json.loads(output)["answers"]
    assert (answer["high"] is not None) == bounded
    assert answer["mean"] <= 3 or update == "x = x + 5"
