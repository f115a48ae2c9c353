"""What formulas mean on runs of a model: `--monitor` of simulate, replay and sweep."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

import tachk
from tachk.cli.main import app
from tachk.recordings.monitors.formulas import formula_source
from tachk.verify.campaign.evaluated_runs import EvaluatedRuns

MODEL = """
const int T = 1;
int n = 1;
clock x;
process P() {
    init location A { invariant x <= 4; to B { guard x >= 3; assign n = 5; } }
    location B;
}
system P;
property reached : F[0, T] P.B;
"""


@pytest.fixture
def model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(tmp_path)
    Path("m.ta").write_text(MODEL, encoding="utf-8")
    return "m.ta"


def verdicts(*arguments: str) -> dict[str, tuple[int, int]]:
    """How many runs satisfy and violate each formula."""
    result = CliRunner().invoke(app, ["simulate", *arguments, "--until", "9", "--runs", "3", "--format", "json"])
    assert result.exit_code in (0, 10), result.output
    return {each["name"]: (each["true"], each["false"]) for each in json.loads(result.stdout)["formulas"]}


def test_constants_of_the_model_count(model: str) -> None:
    assert verdicts(model, "--monitor", "F[0, T] P.B") == {"p1": (0, 3)}
    assert verdicts(model, "--monitor", "F[0, T] P.B", "-D", "T=4") == {"p1": (3, 0)}
    assert verdicts(model, "--monitor", "G (n < 9)", "-D", "T=4") == {"p1": (3, 0)}


def test_files_of_formulas(model: str) -> None:
    Path("named.stl").write_text("early: n < 2\nlater: F !early\nsoon: F[0, T] !early\n", encoding="utf-8")
    assert verdicts(model, "--monitor", "named.stl") == {"early": (3, 0), "later": (3, 0), "soon": (0, 3)}
    assert verdicts(model, "--monitor", "named.stl", "-D", "T=4")["soon"] == (3, 0)
    Path("own.stl").write_text("const T = 4\nsoon: F[0, T] P.B\n", encoding="utf-8")
    assert verdicts(model, "--monitor", "own.stl") == {"soon": (3, 0)}
    assert verdicts(model, "--monitor", "own.stl", "-D", "T=2") == {"soon": (0, 3)}


def test_replayed_runs(model: str) -> None:
    Path("named.stl").write_text("early: n < 2\nsoon: F[0, T] !early\n", encoding="utf-8")
    CliRunner().invoke(app, ["simulate", model, "--until", "9", "-D", "T=4", "-o", "r-{run}.run"])
    result = CliRunner().invoke(app, ["replay", model, "r-0.run", "--monitor", "named.stl", "--quiet"])
    assert (result.exit_code, "soon: true" in result.output) == (0, True), result.output


@pytest.mark.parametrize("formula", ["m.ta", "F[0, T] P.B"])
def test_each_cell_of_a_sweep_has_its_constants(model: str, formula: str) -> None:
    found = tachk.load(model).sweep(over="T=1,4", monitor=formula, until=9, runs=5, processes=1)
    assert [row["estimate"] for row in found.rows] == [0, 1]


def test_a_store_knows_what_formulas_said(model: str) -> None:
    """A file of formulas may change while its name stays."""
    Path("f.stl").write_text("const C = 2\na: F[0, C] P.B\n", encoding="utf-8")
    before = str(EvaluatedRuns(formula_source("f.stl")))
    Path("f.stl").write_text("const C = 3\na: F[0, C] P.B\n", encoding="utf-8")
    assert str(EvaluatedRuns(formula_source("f.stl"))) != before
    Path("g.stl").write_text("const C = 2\na: F[0, C] P.B\n", encoding="utf-8")
    assert str(EvaluatedRuns(formula_source("g.stl"))) == before


def test_only_chosen_constants_replace_those_of_the_formulas(model: str) -> None:
    """As for `tachk simulate`: a constant of the model that nobody has chosen does not."""
    Path("own.stl").write_text("const T = 4\nsoon: F[0, T] P.B\n", encoding="utf-8")
    Path("n.ta").write_text("const int N = 1;" + MODEL, encoding="utf-8")

    def estimates(over: str, **constants: int) -> list[object]:
        found = tachk.load("n.ta", **constants).sweep(over=over, monitor="own.stl", until=9, runs=3, processes=1)
        return [row["estimate"] for row in found.rows]

    assert estimates("N=2") == [1]
    assert estimates("T=2,4") == [0, 1]
    assert estimates("N=2", T=2) == [0]


def test_formulas_are_read_once(model: str) -> None:
    judge = EvaluatedRuns(formula_source("m.ta"), "9", 3)
    Path("m.ta").write_text("no model any more", encoding="utf-8")
    assert judge.names == ("reached",)


@pytest.mark.parametrize("unit", ["", "time_unit = 1 ms;", "time_unit = 10 us;", "time_unit = 1 min;"])
def test_written_runs_have_the_unit_of_their_model(unit: str, model: str) -> None:
    """Bounds without unit are meant in it, whatever a dump counts its time in."""
    Path("u.ta").write_text(unit + MODEL.replace("T = 1", "T = 4"), encoding="utf-8")
    for ending in ("csv", "vcd"):
        CliRunner().invoke(app, ["simulate", "u.ta", "--until", "9", "-o", f"run.{ending}"])
        result = CliRunner().invoke(app, ["monitor", "u.ta", f"run.{ending}"])
        assert (result.exit_code, "1 true" in result.output) == (0, True), result.output
    plain = [tachk.monitor("F[0, 4] P.B", f"run.{ending}").to_text() for ending in ("csv", "vcd")]
    assert plain[0].replace("run.csv", "run.vcd") == plain[1]


def test_values_that_are_too_large_for_a_constant(model: str) -> None:
    with pytest.raises(tachk.UsageError, match="does not fit into 32 bits"):
        tachk.load(model).sweep(over={"T": [10**20]}, processes=1)
