"""Floating point variables are part of the state of a simulation."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise
from math import exp, sqrt
from pathlib import Path

import pytest

import tachk
from tachk.base.span import Source
from tachk.cli.main import app
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationOptions
from tachk.formats.loading.load import load_model
from tachk.meaning.run_view import RunNames
from tachk.model.network import Network
from tachk.simulation.columns import all_columns
from tachk.simulation.runs import Runs, steps_of
from tachk.simulation.stepping.replaying import replay_submitted
from tachk.simulation.stepping.run_file import read_run_file, steps_text
from tachk.simulation.stepping.signals import signals_of
from tachk.simulation.tables import run_writer

TANK = """
typedef struct { int[0, 3] kind; double share; } part_t;
double level = 20.0;
double trend[2] = {0.5, -0.25};
part_t parts[2] = {{1, 0.1}, {2, 0.3}};
int[0, 100] n = 0;
process Tank() {
    clock x;
    double own = 1.5;
    init location Filling {
        invariant x <= 1;
        to Filling { guard x == 1 && level < 22.2; assign x = 0, level = level + trend[0], n = n + 1; }
        to Draining { guard x == 1 && level >= 22.2; assign x = 0, own = own / 3; }
    }
    location Draining {
        exponential_rate level > 6.0 ? level / 10 : 0.5;
        to Draining { guard level > 5.0; assign level = level * (1 - parts[0].share); }
    }
}
signal high = level > 21.1;
system Tank;
"""


def _network(text: str) -> Network:
    return load_model(Source("<text>", text), keeps_doubles=True).network


def test_values_are_those_of_the_semantics() -> None:
    network = _network(TANK)
    runs = Runs(network, all_columns(network))
    names = RunNames(network)
    for run in runs.draw(
        SimulationOptions(2, 30 * TICKS_PER_UNIT), range(3), RecordedChanges(actions=True, observed=True)
    ):
        trace = runs.trace(run)
        replayed = replay_submitted(names, read_run_file(Source("a.run", steps_text(names, steps_of(run)))))
        assert replayed.refusal is None
        expected = signals_of(names, runs.columns, replayed.trace, "a", Fraction(run.end, TICKS_PER_UNIT)).trace
        assert trace.times.tolist() == expected.times.tolist()
        assert {name: values.tolist() for name, values in trace.columns.items()} == {
            name: values.tolist() for name, values in expected.columns.items()
        }
        assert list(trace.columns)[2:8] == [
            "level",
            "trend[0]",
            "trend[1]",
            "parts[0].kind",
            "parts[0].share",
            "parts[1].kind",
        ]
        levels = list(dict.fromkeys(trace.columns["level"].tolist()))
        fallen = levels[levels.index(22.5) :]
        assert len(fallen) > 5
        assert all(after == before * (1 - 0.1) for before, after in pairwise(fallen))
        assert trace.columns["Tank.own"].tolist()[-1] == 1.5 / 3
        assert {*trace.columns["high"].tolist()} == {0, 1}


def test_a_rate_may_depend_on_them() -> None:
    text = """
        double rate = 0.25;
        double waits[2] = {4.0, 0.5};
        int[0, 1] which = 0;
        process P() { init location A { exponential_rate which == 0 ? rate : waits[1]; to B; } location B; }
        system P;
    """
    network = _network(text)
    runs = Runs(network, ())
    drawn = runs.draw(SimulationOptions(7, 2 * TICKS_PER_UNIT), range(4000))
    moved = sum(run.transitions for run in drawn)
    probability = 1 - exp(-0.5)
    assert abs(moved - 4000 * probability) < 4.5 * sqrt(4000 * probability * (1 - probability))


def test_a_search_leaves_them_out() -> None:
    model = tachk.loads(TANK)
    assert {"W0406"} <= {found.code for found in model.warnings}
    assert {"E0750"} == {found.code for found in model.refusals}


def test_files_and_paths(tmp_path: Path) -> None:
    model = tmp_path / "tank.ta"
    model.write_text(TANK)
    (run,) = tachk.simulate(model, until=10)
    assert run["level"].max() == 22.5
    dump = tmp_path / "a.vcd"
    with run_writer(dump) as write:
        write(0, run.trace)
    text = dump.read_text()
    assert "$var real 64" in text and "r20.5 " in text


def test_a_clock_that_takes_floating_point_numbers_is_a_hybrid_one() -> None:
    network = _network(TANK.replace("assign x = 0, level", "assign x = 0.5, level"))
    runs = Runs(network, all_columns(network))
    (run,) = runs.draw(SimulationOptions(2, 3 * TICKS_PER_UNIT), range(1), RecordedChanges(actions=True))
    assert [int(time) * 2 for time in run.times[1:]] == [n * TICKS_PER_UNIT for n in range(2, 7)]


FUNCTIONS = {
    "exp(0.7)": math.exp(0.7),
    "ln(0.7)": math.log(0.7),
    "log(0.7)": math.log10(0.7),
    "log10(0.7)": math.log10(0.7),
    "log2(0.7)": math.log2(0.7),
    "sin(0.7)": math.sin(0.7),
    "cos(0.7)": math.cos(0.7),
    "tan(0.7)": math.tan(0.7),
    "asin(0.7)": math.asin(0.7),
    "acos(0.7)": math.acos(0.7),
    "atan(0.7)": math.atan(0.7),
    "atan2(0.7, -2.0)": math.atan2(0.7, -2.0),
    "pow(0.7, 2.5)": 0.7**2.5,
    "fmod(-7.5, 2.0)": math.fmod(-7.5, 2.0),
    "hypot(0.7, 2.0)": math.hypot(0.7, 2.0),
}


@pytest.mark.parametrize("call", FUNCTIONS)
def test_functions_are_those_of_the_library(call: str) -> None:
    """Computed by the core, from a variable, and while the model is read, from numbers."""
    computed = call.replace("0.7", "x").replace("-7.5", "y")
    text = f"""
        double x = 0.7, y = -7.5, got, folded;
        process P() {{ init location A {{ to B {{ assign got = {computed}, folded = {call}; }} }} location B; }}
        system P;
    """
    network = _network(text)
    runs = Runs(network, all_columns(network))
    (run,) = runs.draw(SimulationOptions(1), range(1), RecordedChanges(observed=True))
    last = {name: values[-1] for name, values in runs.trace(run).columns.items()}
    assert last["got"] == pytest.approx(FUNCTIONS[call], rel=1e-15)
    assert last["folded"] == pytest.approx(FUNCTIONS[call], rel=1e-15)


RANDOM = """
double drawn = 0.0, normal = 0.0;
process P() {
    clock x;
    init location A { invariant x <= 1; to A {
        guard x == 1;
        assign x = 0, drawn = random(4), normal = random_normal(5.0, 2.0);
    } }
}
system P;
"""


def test_random_numbers_have_their_distributions() -> None:
    network = _network(RANDOM)
    runs = Runs(network, all_columns(network))
    (run,) = runs.draw(SimulationOptions(3, 8000 * TICKS_PER_UNIT), range(1), RecordedChanges(observed=True))
    columns = runs.trace(run).columns
    drawn, normal = columns["drawn"][1:-1], columns["normal"][1:-1]
    count = len(drawn)
    assert drawn.min() >= 0 and drawn.max() < 4
    for share in (0.1, 0.5, 0.9):
        assert abs((drawn < 4 * share).sum() - share * count) < 4.5 * sqrt(count * share * (1 - share))
    for sigmas in (-1.0, 0.0, 1.5):
        probability = (1 + math.erf(sigmas / sqrt(2))) / 2
        below = (normal < 5 + 2 * sigmas).sum()
        assert abs(below - probability * count) < 4.5 * sqrt(count * probability * (1 - probability))
    (again,) = runs.draw(SimulationOptions(3, 8000 * TICKS_PER_UNIT), range(1), RecordedChanges(observed=True))
    assert runs.trace(again).columns["normal"].tolist() == columns["normal"].tolist()


def test_random_numbers_are_drawn_in_updates_of_simulations_only(tmp_path: Path) -> None:
    for place in ("x == 1", "invariant x <= 1"):
        with pytest.raises(tachk.InputError, match="E0313"):
            _network(RANDOM.replace(place, f"{place} && random(2) < 1.0", 1))
    assert "E0750" in {found.code for found in tachk.loads(RANDOM).refusals} or tachk.loads(RANDOM).warnings
    model, run = tmp_path / "m.ta", tmp_path / "a.run"
    model.write_text(RANDOM)
    run.write_text("1 P: A -> A\n")
    for line in (["replay", str(model), str(run)], ["simulate", str(model), "--policy", "script", str(run)]):
        assert app.main(line, standalone_mode=False) == 2
