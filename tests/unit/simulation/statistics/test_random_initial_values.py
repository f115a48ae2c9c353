"""Initial values that are drawn for each run, beside closed forms."""

from __future__ import annotations

import pytest

import tachk
from tachk.simulation.statistics.estimate import DrawnRuns, Estimated, Mean

MODEL = """
double d = random(5);
int n = fint(random(10));
int pair[2] = { 7, fint(random_normal(100.0, 1.0)) };
double first() { return 20 + random(2); }
double f = first();
clock x = random(4);
process P() {
    int own = fint(random(3));
    state A { x <= 4 }, B; init A;
    trans A -> B { guard x >= 4; };
}
Q = P(); R = P();
system Q, R;
"""


def test_each_run_has_its_own() -> None:
    model = tachk.loads(MODEL)
    found = model.estimate(
        "Pr[<=1](<> d <= 2)",
        "Pr[<=1](<> n == 3)",
        "Pr[<=1](<> Q.own != R.own)",
        "Pr[<=1](<> Q.B)",  # x begins at 3 or more
        "Pr[#<=0]([] pair[0] == 7 && pair[1] > 90 && pair[1] < 110 && f >= 20 && f <= 22)",
        runs=4000,
        seed=1,
        confidence=0.999,
    )
    for answer, exact in zip(found, [0.4, 0.1, 2 / 3, 0.25, 1.0], strict=True):
        assert isinstance(answer, Estimated)
        assert answer.low <= exact <= answer.high
    mean = model.estimate("E[<=1; 4000](max: f)", confidence=0.999)[0]
    assert isinstance(mean, Mean)
    assert mean.asymptotic[0] <= 21 <= mean.asymptotic[1]


def test_the_seed_and_the_number_of_the_run_determine_them() -> None:
    def values(seed: int, threads: int) -> list[float]:
        drawn = tachk.loads(MODEL).estimate("simulate [<=1; 20] {d}", seed=seed, threads=threads)[0]
        assert isinstance(drawn, DrawnRuns)
        return [float(run.lines[0].values[0]) for run in drawn.runs]

    assert values(3, 1) == values(3, 2)
    assert values(3, 1) != values(4, 1)
    assert len(set(values(3, 1))) == 20


def test_a_value_outside_its_range_ends_the_run() -> None:
    text = "int[0, 4] n = fint(random(10)); process P() { state A; init A; } system P;"
    found = tachk.loads(text).estimate("Pr[<=1](<> n <= 4)", runs=1000, confidence=0.999)[0]
    assert isinstance(found, Estimated)
    assert 400 < found.sample.unknown < 600


def test_a_search_rejects_them() -> None:
    model = tachk.loads(MODEL)
    with pytest.raises(tachk.UnsupportedError, match="random initial values are for simulations only"):
        assert model.network


@pytest.mark.parametrize(
    ("declaration", "said"),
    [
        ("const int N = fint(random(5));", "must be a constant, but this is random"),
        ("int a[fint(random(5))];", "must be a constant, but this is random"),
        ("meta int m = fint(random(5));", "which no meta variable can be"),
    ],
)
def test_what_cannot_be_random(declaration: str, said: str) -> None:
    text = f"double d; {declaration} process P() {{ state A; init A; }} system P;"
    with pytest.raises((tachk.InputError, tachk.UnsupportedError), match=said):
        tachk.loads(text).estimate("Pr[<=1](<> d > 0)")
