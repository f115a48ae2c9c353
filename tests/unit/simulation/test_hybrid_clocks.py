"""Hybrid clocks against closed forms: when conditions become true, where clocks are, and how delays are distributed."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.span import Source as Text
from tachk.cli.main import app
from tachk.engine.compiler.hybrid import refuse_hybrid
from tachk.engine.simulation.simulator import TICKS_PER_UNIT
from tachk.formats.loading.load import load_model
from tachk.frontend.hybrid_clocks import declared_names, hybrid_clocks
from tachk.frontend.loaded import elaborate_query_file
from tachk.frontend.queries import statistical
from tachk.frontend.queries.statistical import StatisticalReader
from tachk.simulation.statistics.estimate import Estimate, Estimated, Mean, Settings, estimate
from tachk.simulation.statistics.sampling import RunSource
from tachk.simulation.stepping.library import DrawnRun

BALL = """
const double G = 9.81;
hybrid clock height;
hybrid clock speed;
int bounces = 0;
process Ball() {
    committed init location Held { to Falling { assign height = 10, speed = 0; } }
    location Falling {
        invariant height' == speed && speed' == -G && height >= 0;
        to Falling { guard height <= 0 && speed < 0; assign speed = -0.8 * speed, bounces = bounces + 1; }
    }
}
system Ball;
"""

THERMOSTAT = """
hybrid clock T;
int switches = 0;
process Heater() {
    committed init location Start { to Off { assign T = 20; } }
    location Off {
        invariant T' == -0.5 * T && T >= 18;
        to On { guard T <= 18; assign switches = switches + 1; }
    }
    location On {
        invariant T' == 5 - 0.1 * T && T <= 22;
        to Off { guard T >= 22; assign switches = switches + 1; }
    }
}
system Heater;
"""

OSCILLATOR = """
hybrid clock x;
hybrid clock v;
int turns = 0;
process Mass() {
    committed init location Held { to Right { assign x = 1, v = 0; } }
    location Right { invariant x' == v && v' == -4 * x && x >= 0; to Left { guard x <= 0; assign turns = turns + 1; } }
    location Left { invariant x' == v && v' == -4 * x && x <= 0; to Right { guard x >= 0; assign turns = turns + 1; } }
}
system Mass;
"""

TANK = """
clock level;
int valves = 0;
process Tank() {
    init location Filling {
        invariant level' == 2 && level <= 9;
        to Emptying { guard level >= 9; assign valves = valves + 1; }
    }
    location Emptying {
        invariant level' == -0.75 && level >= 1.5;
        to Filling { guard level <= 1.5; assign valves = valves + 1; }
    }
}
system Tank;
"""

DELAYED = """
hybrid clock x;
process P() {
    init location A { invariant x' == 0.5 * x + 1 && x <= 4; to B { guard x >= 1; } }
    location B { invariant x' == 0; }
}
system P;
"""


PRODUCT = """
hybrid clock x;
hybrid clock y;
process P() {
    committed init location Start { to A { assign x = 0, y = 1; } }
    location A { invariant x' == 1 && y' == 1 && x * y <= 6; to B { guard x * y >= 6; } }
    location B { invariant x' == 0 && y' == 0; }
}
system P;
"""

CONTRARY = """
hybrid clock x;
process P() {
    init location A { invariant x' == 0.5 && !(x > 3); to B { guard !(x < 3); } }
    location B { invariant x' == 0; }
}
system P;
"""


QUICK = """
hybrid clock x;
process P() {
    committed init location Start { to A { assign x = 0; } }
    location A { invariant x' == 200 * (1 - x) && x <= 0.5; to B { guard x >= 0.5; } }
    location B { invariant x' == 0; }
}
system P;
"""

LASTING = """
hybrid clock x;
process P() {
    committed init location Start { to A { assign x = 1; } }
    location A { exponential_rate 1 : 1000000000; invariant x' == -x && x <= 5; to B; }
    location B { invariant x' == 0; }
}
system P;
"""


def drawn(text: str, tmp_path: Path, until: float, runs: int = 1, threads: int = 1) -> list[DrawnRun]:
    path = tmp_path / "model.ta"
    path.write_text(text)
    return list(tachk.simulate(str(path), runs=runs, until=until, threads=threads))


def changes(run: DrawnRun, name: str) -> list[float]:
    """When a column has another value than before."""
    values = run[name]
    return [float(time) for time, old, new in zip(run.times[1:], values, values[1:], strict=False) if old != new]


def test_a_clock_with_constant_rates_is_exact(tmp_path: Path) -> None:
    (run,) = drawn(TANK, tmp_path, 100)
    times = changes(run, "valves")
    expected, now = [4.5], 4.5
    while now <= 100:
        now += 10 if len(expected) % 2 else 3.75
        expected.append(now)
    assert times == [time for time in expected if time <= 100]
    assert run["level"][-1] == pytest.approx(1.5 + 2 * (100 - times[-1]), abs=1e-9)


def test_exponential_changes_cross_limits_on_time(tmp_path: Path) -> None:
    (run,) = drawn(THERMOSTAT, tmp_path, 20)
    heating, cooling = 10 * math.log(32 / 28), 2 * math.log(22 / 18)
    expected = [2 * math.log(20 / 18)]
    while expected[-1] < 20:
        expected.append(expected[-1] + (heating if len(expected) % 2 else cooling))
    assert changes(run, "switches") == pytest.approx([time for time in expected if time <= 20], abs=1e-7)


@pytest.mark.parametrize(("text", "moment"), [(PRODUCT, 2), (CONTRARY, 6), (QUICK, math.log(2) / 200)])
def test_curves_and_negated_conditions_are_crossed_on_time(tmp_path: Path, text: str, moment: int) -> None:
    (run,) = drawn(text, tmp_path, 10)
    assert changes(run, "P")[-1] == pytest.approx(moment, abs=1e-6)


def test_an_oscillator_keeps_its_period_and_amplitude(tmp_path: Path) -> None:
    (run,) = drawn(OSCILLATOR, tmp_path, 30)
    expected = [math.pi / 4 + n * math.pi / 2 for n in range(19)]
    assert changes(run, "turns") == pytest.approx(expected, abs=1e-6)
    assert run["x"].max() == pytest.approx(1, abs=1e-6)
    for time, x, v in zip(run.times[3::50], run["x"][3::50], run["v"][3::50], strict=True):
        assert x == pytest.approx(math.cos(2 * time), abs=1e-6)
        assert v == pytest.approx(-2 * math.sin(2 * time), abs=1e-6)


def test_a_ball_bounces_lower_each_time(tmp_path: Path) -> None:
    (run,) = drawn(BALL, tmp_path, 9)
    fall = math.sqrt(2 * 10 / 9.81)
    expected, flight = [fall], 2 * fall
    while expected[-1] < 9:
        flight *= 0.8
        expected.append(expected[-1] + flight)
    assert changes(run, "bounces") == pytest.approx([time for time in expected if time <= 9], abs=1e-6)


def test_a_delay_is_uniform_between_the_crossings_of_guard_and_invariant(tmp_path: Path) -> None:
    first, last = 2 * math.log(1.5), 2 * math.log(3)
    delays = sorted(changes(run, "P")[0] for run in drawn(DELAYED, tmp_path, 5, runs=1000))
    assert first <= delays[0] and delays[-1] <= last + 1e-6
    distance = max(abs((d - first) / (last - first) - n / 1000) for n, d in enumerate(delays))
    assert distance < 1.95 / math.sqrt(1000)  # Kolmogorov, 0.999


def test_no_process_acts_at_the_end_of_the_sampled_run(tmp_path: Path) -> None:
    (run,) = drawn(LASTING, tmp_path, 25_000)
    assert set(run["P"]) == {"A"}


def test_runs_are_the_same_with_any_number_of_threads(tmp_path: Path) -> None:
    one, two = (drawn(DELAYED, tmp_path, 5, runs=8, threads=threads) for threads in (1, 2))
    for first, second in zip(one, two, strict=True):
        assert first.times.tolist() == second.times.tolist()
        assert first["x"].tolist() == second["x"].tolist()


def answered(text: str, query: str) -> Estimate:
    loaded = load_model(Text("model.ta", text), keeps_doubles=True)
    _, unchecked = elaborate_query_file(loaded, Text("<query>", query))
    return estimate(loaded.network, StatisticalReader(loaded).read(unchecked[0]), Settings(RunSource(seed=3), runs=400))


def test_goals_are_reached_within_delays(tmp_path: Path) -> None:
    # x passes 2.5 after 2 ln 2.25; B is entered before that in so many cases.
    expected = (math.log(2.25) - math.log(1.5)) / (math.log(3) - math.log(1.5))
    found = answered(DELAYED, "Pr[<=10](<> x > 2.5)")
    assert isinstance(found, Estimated)
    assert found.low < 1 - expected < found.high
    certain = answered(OSCILLATOR, "Pr[<=10](<> x < -0.999 && v > 0)")
    assert isinstance(certain, Estimated) and certain.sample.hits == 400
    assert certain.sample.all_times[0] == pytest.approx(math.pi / 2, abs=1e-6)


def test_the_largest_value_is_that_at_the_crossing() -> None:
    found = answered(THERMOSTAT, "E[<=10](max: T)")
    assert isinstance(found, Mean) and found.mean == pytest.approx(22, abs=1e-6)
    lowest = answered(OSCILLATOR, "E[<=10](min: x)")
    assert isinstance(lowest, Mean) and lowest.mean == pytest.approx(-1, abs=1e-3)


def test_what_does_not_know_hybrid_clocks_says_so() -> None:
    network = load_model(Text("model.ta", TANK), keeps_doubles=True).network
    with pytest.raises(UnsupportedError, match="E0729"):
        refuse_hybrid(network, "something")
    assert {refusal.code for refusal in tachk.loads(TANK).refusals} == {"E0750"}


RATED = """
typedef int[0, 1] bit_t;
typedef struct { int k; bool t; bit_t b; } r_t;
int p[2] = {2, 3}, n = -3, three = 3;
bit_t bits[2] = {1, 1};
r_t r = {3, true, 1};
int f() { return 3; }
double h() { return 3.0; }
bool g() { return true; }
bit_t one() { return 1; }
clock e;
process P() { init location A { invariant e' == RATE; } }
system P;
"""


def reached_at_5(rate: str) -> list[float]:
    (found,) = tachk.loads(RATED.replace("RATE", rate)).estimate("Pr[<=20](<> e >= 5)", runs=3)
    assert isinstance(found, Estimated)
    return [time / TICKS_PER_UNIT for time in found.sample.times[0].tolist()]


@pytest.mark.parametrize(
    "rate",
    ["f()", "h()", "r.k", "abs(n)", "-n", "p[1]", "(three > 0 ? 3 : 0)", "sum(i : int[0, 2]) bits[0]", "fint(3.4)"],
)
def test_a_rate_that_is_not_certainly_0_or_1(rate: str) -> None:
    assert reached_at_5(rate) == pytest.approx([5 / 3] * 3)


@pytest.mark.parametrize("rate", ["g()", "one()", "r.t", "r.b", "bits[1]", "one() * bits[0]", "+r.t", "!(n > 0)"])
def test_a_rate_that_is_0_or_1_leaves_a_clock_plain(rate: str) -> None:
    model = tachk.loads(RATED.replace("RATE", rate))
    assert hybrid_clocks(model.loaded.items) == frozenset()
    assert reached_at_5(rate) == [5] * 3


def test_weights_may_read_clocks() -> None:
    text = """
        clock x;
        process M() {
            init location s { invariant x <= 4; to b; }
            branchpoint b { to t { probability x; } to u { probability 4 - x; } }
            location t;
            location u;
        }
        system M;
    """
    # The share of t is x / 4, with x uniform on 0 to 4.
    (found,) = tachk.loads(text).estimate("Pr[<=5](<> M.t)", runs=4000, confidence=0.999)
    assert isinstance(found, Estimated)
    assert found.low < 0.5 < found.high
    assert found.high - found.low < 0.06
    (late,) = tachk.loads(text.replace("to b; }", "to b { guard x >= 4; } }")).estimate("Pr[<=5](<> M.t)", runs=200)
    assert isinstance(late, Estimated)
    assert late.sample.hits == 200


PASSED = """
clock g;
hybrid clock h;
hybrid clock many[2];
void reset(clock &c) { c = 0; }
process P(clock &x) { init location A { invariant x' == 2; to B { guard x >= 3; } } location B; }
process Q(hybrid clock &x) { init location A { invariant x' == 2; to B { guard x >= 3; } } location B; }
process V(hybrid clock x) { init location A { invariant x' == 2; to B { guard x >= 4.5; } } location B; }
process W(clock x) { init location A { invariant x <= 4; to B { guard x >= 4; assign reset(x); } } location B; }
p = P(g);
q = P(h);
r = Q(many[1]);
s = Q(g);
v = V(1.5);
w = W(2.5);
"""


@pytest.mark.parametrize(
    ("process", "clock"),
    [("p", "g"), ("q", "h"), ("r", "many[1]"), ("s", "g"), ("v", "v.x"), ("p", "p.x"), ("q", "q.x")],
)
def test_parameters_and_arguments_are_hybrid_together(process: str, clock: str) -> None:
    model = tachk.loads(f"{PASSED}system {process};")
    (found,) = model.estimate(f"Pr[<=20](<> {clock} >= 9)", runs=3)
    assert isinstance(found, Estimated)
    # Until 3 (or from 1.5 until 4.5) the rate is 2, then 1 from some moment on.
    begins = 1.5 if process == "v" else 0
    assert all(4.49 - begins <= time / TICKS_PER_UNIT <= 9 for time in found.sample.times[0].tolist())
    (reached,) = model.estimate(f"Pr[<=1](<> {clock} >= 1.9)", runs=3)
    assert isinstance(reached, Estimated)
    assert reached.sample.hits == 3


def test_a_clock_passed_by_value_may_begin_with_a_fraction() -> None:
    (found,) = tachk.loads(f"{PASSED}system w;").estimate("Pr[<=20](<> w.B)", runs=3)
    assert isinstance(found, Estimated)
    assert [time / TICKS_PER_UNIT for time in found.sample.times[0].tolist()] == pytest.approx([1.5] * 3)


def test_the_steps_of_a_run_are_its_transitions(tmp_path: Path) -> None:
    model, run = tmp_path / "m.ta", tmp_path / "a.run"
    model.write_text(
        "hybrid clock h; clock x; process P() { init location A { to B { guard x >= 1; } } location B; } system P;"
    )
    command = ["simulate", str(model), "--policy", "earliest", "--until", "5", "-o", str(run)]
    assert app.main(command, standalone_mode=False) == 0
    steps = [line.split() for line in run.read_text().splitlines() if not line.startswith("#")]
    assert steps == [["1", "P:", "A", "->", "B"], ["5"]]


def test_what_a_model_declares_is_found_once_for_all_queries(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = """clock x; int n = 0;
    process P() { init location A { to A { guard x >= 1; assign x = 0, n = n + 1; } } }
    system P;
    """
    loaded = load_model(Text("model.ta", plain), keeps_doubles=True)
    query = "E[<=9; 5](max: 2 * x + n)"
    _, unchecked = elaborate_query_file(loaded, Text("<query>", f"{query}\n" * 20))
    lookups: list[object] = []
    monkeypatch.setattr(statistical, "declared_names", lambda items: (lookups.append(items), declared_names(items))[1])
    hybrid: list[object] = []
    real = statistical.with_hybrid_clocks
    monkeypatch.setattr(
        statistical, "with_hybrid_clocks", lambda model, names: (hybrid.append(names), real(model, names))[1]
    )
    reader = StatisticalReader(loaded)
    networks = {id(reader.read(each).network) for each in unchecked}
    assert (len(unchecked), len(networks), len(lookups), hybrid) == (20, 1, 1, [frozenset({"x"})])
