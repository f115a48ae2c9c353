"""Estimates against closed forms. The seeds are fixed: an interval of confidence 0.999 misses once in 1000."""

from __future__ import annotations

from dataclasses import replace
from math import exp

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError, TachkError, UnsupportedError
from tachk.base.diagnostics.explanation import explanations
from tachk.base.span import Source as Text
from tachk.frontend.loaded import elaborate_query_file
from tachk.frontend.queries.statistical import StatisticalReader
from tachk.model.statistical import StatisticalQuery
from tachk.simulation.statistics.deciding import Decision, Errors
from tachk.simulation.statistics.estimate import Decided, DrawnRuns, Estimate, Estimated, Mean, Settings, estimate
from tachk.simulation.statistics.sampling import RunSource

STATISTICS_CODES = explanations("statistics")

SURE = Settings(RunSource(seed=4), confidence=0.999, runs=20_000)


def asked(model: tachk.Model, text: str) -> StatisticalQuery:
    _, unchecked = elaborate_query_file(model.loaded, Text("<query>", text))
    return StatisticalReader(model.loaded).read(unchecked[0])


def answer(model: str, query: str, settings: Settings = SURE) -> Estimate:
    loaded = tachk.loads(model)
    return estimate(loaded.network, asked(loaded, query), settings)


def probability(model: str, query: str, settings: Settings = SURE) -> Estimated:
    found = answer(model, query, settings)
    assert isinstance(found, Estimated)
    return found


RACE = """
clock age;
int[0, 3] winner = 0;
process P(const int[1, 3] me, const int rate) {
    clock x;
    init location Wait { exponential_rate rate; to Done { guard winner == 0; assign winner = me; } }
    location Done;
}
A = P(1, 1); B = P(2, 2); C = P(3, 5);
system A, B, C;
"""


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ("Pr[<=100](<> winner == 2)", 2 / 8),
        ("Pr[<=0.125](<> winner > 0)", 1 - exp(-1)),
        ("Pr[<=0.125]([] winner == 0)", exp(-1)),
        ("Pr[age<=0.125](<> winner > 0)", 1 - exp(-1)),
        ("Pr[#<=1](<> winner == 3)", 5 / 8),
        ("Pr[#<=0](<> winner > 0)", 0),
        ("Pr[<=100](winner == 0 U C.Done)", 5 / 8),
        ("Pr[<=100](winner != 1 U B.Done)", 2 / 8),
        # Within one delay: the clock passes 1 while nothing happens.
        ("Pr[<=2](winner == 0 U age >= 1)", exp(-8)),
        ("Pr[<=2](<> age > 1 && age < 2)", 1),
        ("Pr[<=1](<> age > 1)", 0),
    ],
)
def test_races(query: str, expected: float) -> None:
    found = probability(RACE, query)
    assert found.low <= expected <= found.high
    assert found.high - found.low < 0.03


def test_moments_at_which_goals_are_reached() -> None:
    found = probability(RACE, "Pr[<=3](<> age >= 1)", replace(SURE, runs=10))
    assert found.sample.all_times.tolist() == [1.0] * 10
    assert found.sample.endings.total() == 0


RUIN = """
const int GOAL = 8;
int[0, GOAL] money = 3;
process Gambler() {
    init location Play { exponential_rate 10; to toss { guard money > 0 && money < GOAL; } }
    branchpoint toss {
        to Play { probability 3; assign money = money + 1; }
        to Play { probability 2; assign money = money - 1; }
    }
}
system Gambler;
"""
WON = (1 - (2 / 3) ** 3) / (1 - (2 / 3) ** 8)


def test_the_gambler() -> None:
    found = probability(RUIN, "Pr[<=200](<> money == GOAL)")
    assert found.low <= WON <= found.high


@pytest.mark.parametrize(
    ("query", "decision"),
    [
        ("Pr[<=200](<> money == GOAL) >= 0.7", Decision.HOLDS),
        ("Pr[<=200](<> money == GOAL) >= 0.78", Decision.FAILS),
        ("Pr[<=200](<> money == GOAL) <= 0.78", Decision.HOLDS),
        ("Pr[<=200](<> money == GOAL) <= 0.7", Decision.FAILS),
        ("Pr[<=200]([] money < GOAL) <= 0.3", Decision.HOLDS),
        ("Pr[<=200](<> money == GOAL) >= Pr[<=200](<> money == 0)", Decision.HOLDS),
        ("Pr[<=200](<> money == 0) >= Pr[<=200](<> money == GOAL)", Decision.FAILS),
        ("Pr[<=200](<> money == 0) <= Pr[<=200](<> money == GOAL)", Decision.HOLDS),
        ("Pr[<=200; 5000](<> money == GOAL) >= 0.7", Decision.HOLDS),
        ("Pr[<=200; 5000](<> money == GOAL) <= 0.7", Decision.FAILS),
        ("Pr[<=200; 100](<> money == GOAL) >= 0.74", Decision.UNKNOWN),
    ],
)
def test_tests(query: str, decision: Decision) -> None:
    found = answer(RUIN, query, Settings(RunSource(seed=3), errors=Errors(0.001, 0.001, 0.01)))
    assert isinstance(found, Decided)
    assert found.decision is decision


def test_a_test_ends_without_a_decision() -> None:
    found = answer(RUIN, "Pr[<=200](<> money == GOAL) >= 0.73", Settings(errors=Errors(delta=1e-4), most_runs=500))
    assert isinstance(found, Decided)
    assert found.decision is Decision.UNKNOWN and found.samples[0].runs == 500


def test_runs_are_drawn_until_the_interval_is_narrow() -> None:
    found = probability(RUIN, "Pr[<=200](<> money == GOAL)", Settings(RunSource(seed=2), 0.99, 0.04))
    assert found.method == "sequential"
    assert found.low <= WON <= found.high and found.high - found.low <= 0.08
    assert found.sample.runs < 1000
    seldom = probability(RUIN, "Pr[<=200](<> money == 5 && money == 6)", Settings(RunSource(seed=2)))
    assert (seldom.low, seldom.sample.hits) == (0, 0) and seldom.sample.runs < 60


def test_threads_make_no_difference() -> None:
    found = [
        answer(RUIN, query, Settings(RunSource(seed=5, threads=threads)))
        for threads in (1, 3)
        for query in ("Pr[<=20](<> money == GOAL)", "Pr[<=20](<> money == GOAL) >= 0.6", "E[<=2; 300](max: money)")
    ]
    first, second = found[0], found[3]
    assert isinstance(first, Estimated) and isinstance(second, Estimated)
    assert (first.low, first.high, first.sample.all_times.tolist()) == (
        second.low,
        second.high,
        second.sample.all_times.tolist(),
    )
    decided, likewise = found[1], found[4]
    assert isinstance(decided, Decided) and isinstance(likewise, Decided)
    assert (decided.decision, decided.samples[0].runs) == (likewise.decision, likewise.samples[0].runs)
    mean, same = found[2], found[5]
    assert isinstance(mean, Mean) and isinstance(same, Mean)
    assert mean.sample.all_values.tolist() == same.sample.all_values.tolist()


def test_runs_that_are_given_up_count_as_both() -> None:
    settings = replace(SURE, source=RunSource(seed=1, most_steps=5), runs=1000)
    found = probability(RUIN, "Pr[<=200](<> money == GOAL)", settings)
    assert found.sample.unknown > 500
    assert found.low <= WON <= found.high
    sequential = probability(RUIN, "Pr[<=200](<> money == GOAL)", replace(settings, runs=None))
    assert sequential.low <= WON <= sequential.high
    tested = answer(RUIN, "Pr[<=200](<> money == GOAL) >= 0.5", replace(settings, runs=None, most_runs=2000))
    assert isinstance(tested, Decided) and tested.decision is Decision.UNKNOWN


def test_run_time_errors_are_reported() -> None:
    found = probability("int[0, 2] n; process P() { init location A { to A { assign n = n + 1; } } } system P;",
                        "Pr[<=100](<> n == 7)", replace(SURE, runs=10))  # fmt: skip
    assert found.sample.unknown == 10 and (found.low, found.high) == (0, 1)
    assert found.sample.fault is not None


STEPS = """
clock x;
int[0, 9] n;
process P() {
    init location A { invariant x <= 2; to A { guard x >= 2 && n < 9; assign n = n + 1, x = 0; } }
}
system P;
"""


def test_means() -> None:
    found = answer(STEPS, "E[<=5; 50](max: n)")
    assert isinstance(found, Mean)
    assert found.mean == 2 and found.values == (0, 9)
    assert found.low is not None and found.high is not None and found.low <= 2 <= found.high
    for query, mean in (
        ("E[<=5; 50](min: 7 - n)", 5),
        ("E[<=5; 50](max: x)", 2),
        ("E[<=1; 50](max: x)", 1),
        ("E[#<=0; 50](max: x)", 2),
    ):
        clock = answer(STEPS, query)
        assert isinstance(clock, Mean)
        assert clock.mean == pytest.approx(mean, abs=0)
        assert (clock.values is None) == query.startswith("E[#")


def test_the_mean_of_a_maximum() -> None:
    # The first of the three acts after 1/8 on average, if it acts within 100.
    found = answer(RACE, "E[<=100; 20000](max: winner == 0 ? 0 : winner)")
    assert isinstance(found, Mean) and found.low is not None and found.high is not None
    assert found.low <= 20 / 8 <= found.high
    assert found.asymptotic[0] <= 20 / 8 <= found.asymptotic[1]


def test_trajectories() -> None:
    found = answer(STEPS, "simulate [<=5; 2] {n, x, n > 1}")
    assert isinstance(found, DrawnRuns)
    assert [run.number for run in found.runs] == [0, 1]
    n, x, condition = found.runs[0].lines
    assert list(zip(n.times, n.values, strict=True)) == [(0, 0), (2, 0), (2, 1), (4, 1), (4, 2), (5, 2)]
    assert list(zip(x.times, x.values, strict=True)) == [(0, 0), (2, 2), (2, 0), (4, 2), (4, 0), (5, 1)]
    assert condition.values.tolist() == [0, 0, 1, 1]
    old = answer(STEPS, "simulate 3 [#<=2] {n}")
    assert isinstance(old, DrawnRuns) and len(old.runs) == 3
    assert old.runs[0].lines[0].values[-1] == 2


@pytest.mark.parametrize(
    ("query", "error", "code"),
    [
        ("Pr[100](<> n == 1)", InputError, "E0147"),
        ("Pr[<=100](n == 1)", InputError, "E0147"),
        ("Pr[<=100](<> n == 1) >= 2", InputError, "E0147"),
        ("Pr[<=100](<> m == 1)", InputError, "E0201"),
        ("Pr[n<=100](<> n == 1)", InputError, "E0147"),
        ("Pr[<=5 s](<> n == 1)", InputError, "E0147"),
        ("Pr[<=-5](<> n == 1)", InputError, "E0147"),
        ("E[<=5; 0](max: n)", InputError, "E0147"),
        ("E[<=5; 10](n)", InputError, "E0147"),
        ("Pr[<=100](<> deadlock)", UnsupportedError, "E0728"),
    ],
)
def test_what_is_wrong_has_a_place(query: str, error: type[TachkError], code: str) -> None:
    with pytest.raises(error) as raised:
        answer(STEPS, query)
    value = raised.value
    found = value.diagnostics[0] if isinstance(value, InputError) else value.diagnostic  # type: ignore[attr-defined]
    assert found.code == code
    assert 0 <= found.span.start < found.span.end <= len(query)


@pytest.mark.parametrize("condition", ["<> n == 1", "<>[0,3] n == 1", "[] n == 1", "n == 0 U n == 1", "F n == 1"])
def test_a_formula_is_no_condition_of_one_state(condition: str) -> None:
    queries = (
        f"simulate [<=9; 2] {{n}} : 1 : {condition}",
        f"simulate [<=9] {{{condition}}}",
        f"E[<=9; 2](max: {condition})",
    )
    for query in queries:
        with pytest.raises(InputError) as raised:
            answer(STEPS, query)
        (found,) = raised.value.diagnostics
        assert (found.code, found.span.text.strip()) == ("E0147", condition)
        assert "temporal operator" in found.message and "Pr takes formulas" in str(found.help)


@pytest.mark.parametrize("code", STATISTICS_CODES)
def test_the_examples_of_the_explanations(code: str) -> None:
    model = "process P() { init location a; } system P;"
    with pytest.raises((InputError, UnsupportedError)) as raised:
        answer(model, STATISTICS_CODES[code].bad)
    assert code in str(raised.value)
    if code != "E0728":  # whose good example is for `tachk verify`
        answer(model, STATISTICS_CODES[code].good)


def test_differences_of_clocks_are_measured() -> None:
    found = tachk.loads("clock x; clock y; process P() { init location A; } system P;").estimate(
        "E[<=5; 5](max: x - y)"
    )
    assert isinstance(found[0], Mean)
    assert found[0].mean == 0
