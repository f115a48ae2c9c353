"""A clock that begins with a number is one that is set to it before the first state."""

from __future__ import annotations

from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError
from tachk.cli.main import app
from tachk.model.builder import NetworkBuilder
from tachk.simulation.statistics.estimate import Estimated

BEGUN = """
const int N = 2;
clock x = N, y[2] = {1, N};
typedef struct { clock c; int n; } r_t;
r_t r = {3, 4};
process P() {
    clock own = 4;
    init location A { invariant x <= 5; to B { guard x >= 3 && y[1] >= 2 && r.c >= 4 && own >= 5; } }
    location B;
}
system P;
property early : A[] P.B imply x - y[0] == 1;
property late : A[] P.B imply P.own >= 5;
property met : A<> P.B;
"""
"""B is reached 1 to 3 units of time after the start."""


def test_all_engines(reaches) -> None:
    network = NetworkBuilder()
    x, y = network.clock("x", 2), network.clock("y")
    process = network.process("P")
    z = process.clock("z", 4)
    a, b = process.location("A", invariant=x <= 5), process.location("B")
    process.edge(a, b, guard=(x >= 3) & (z >= 5), updates=[x.assign(0)])
    assert reaches(network, b.reached & (y == 1) & (x == 0))
    assert reaches(network, b.reached & (y == 3) & (x == 0))
    assert not reaches(network, b.reached & (y < 1))
    assert not reaches(network, b.reached & (y > 3) & (x == 0))
    assert not reaches(network, a.reached & (z - y > 4))


@pytest.mark.parametrize("engine", ["zone", "smt", "both"])
def test_commands_and_certificates(engine: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model, proof = tmp_path / "a.ta", tmp_path / "a.cert"
    model.write_text(BEGUN)
    symbolic = ["verify", str(model), "--engine", engine, "E<> P.B && y[0] == 2", "A[] P.A imply P.own <= 7"]
    assert app.main(symbolic, standalone_mode=False) == 0
    assert capsys.readouterr().out.count("holds") == 2
    if engine == "zone":
        assert app.main(["verify", str(model), "--certificate", str(proof)], standalone_mode=False) == 0
        assert app.main(["certify", str(model), str(proof)], standalone_mode=False) == 0
        assert app.main(["time", str(model), "--to", "P.B"], standalone_mode=False) == 0
        assert "1      3      3" in capsys.readouterr().out


def test_runs(tmp_path: Path) -> None:
    model = tmp_path / "a.ta"
    model.write_text(BEGUN)
    loaded = tachk.loads(BEGUN)
    soon, never = loaded.estimate("Pr[<=2](<> P.B)", "Pr[<=0.9](<> P.B)", runs=1000)
    assert isinstance(soon, Estimated) and isinstance(never, Estimated)
    assert soon.low < 0.5 < soon.high
    assert never.sample.hits == 0
    command = ["simulate", str(model), "--runs", "3", "-o", str(tmp_path / "a-{run}.run")]
    assert app.main(command, standalone_mode=False) == 0
    assert all(tachk.replay(loaded, tmp_path / f"a-{run}.run").refusal is None for run in range(3))


def test_a_fraction_is_for_simulation_only() -> None:
    text = BEGUN.replace("clock x = N,", "clock x = 2.5,")
    assert "E0750" in str(tachk.loads(text).refusals)
    (found,) = tachk.loads(text).estimate("Pr[<=0.9](<> P.B)", runs=10)
    assert isinstance(found, Estimated)
    assert found.sample.hits == 0


def test_exports() -> None:
    model = tachk.loads(BEGUN)
    for form in ("xml", "xta"):
        written = tachk.export(model, form)
        assert "clock own = 4;" in written
        (met,) = tachk.loads(written).verify("E<> P.B && x < 3 || P.B && y[0] > 4 && x < 5")
        assert met.answer.value == "fails"
    with pytest.raises(UnsupportedError, match="TChecker has no clocks that do not begin with 0"):
        tachk.export(model, "tchecker")
    with pytest.raises(UnsupportedError, match="Munta has no clocks that do not begin with 0"):
        tachk.export(
            tachk.loads("clock x = 1; process P() { init location A; } system P; property p : A[] P.A;"), "munta"
        )


def test_an_initial_state_that_breaks_an_invariant() -> None:
    with pytest.raises(InputError, match="E0409"):
        tachk.loads(BEGUN, N=6).verify("E<> P.B")
