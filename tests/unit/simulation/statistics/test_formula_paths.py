"""Formulas with several operators in ``Pr(...)``: what is read, what is refused, and how answers are told."""

from __future__ import annotations

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError, UsageError
from tachk.simulation.statistics.deciding import Decision
from tachk.simulation.statistics.estimate import Decided, Estimated, Settings, estimate
from tachk.simulation.statistics.rare import Splitting

# p is true from 2 to 5, at 7 the run goes on for ever.
FIXED = """
bool p; int[0, 3] n;
process P() {
    clock x;
    init location a { invariant x <= 2; to b { guard x >= 2; assign p = true, n = 1; } }
    location b { invariant x <= 5; to c { guard x >= 5; assign p = false, n = 2; } }
    location c { invariant x <= 7; to d { guard x >= 7; } }
    location d;
}
system P;
"""


@pytest.fixture(scope="module")
def fixed() -> tachk.Model:
    return tachk.loads(FIXED)


def share(model: tachk.Model, query: str) -> tuple[float, int]:
    (found,) = model.estimate(query, runs=3)
    assert isinstance(found, Estimated)
    return found.frequency, found.sample.unknown


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("<>[0,3] ([][0,2] p)", 1),
        ("<>[0,3] ([][0,3] p)", 0),
        ("<>[0,2] p && [][0,1] !p", 1),
        ("<>[0,1] p || [][0,1] p", 0),
        ("(!p U[0,2] p) && <>[0,7] P.d", 1),
        ("(!p U[0,1] p) || P.d", 0),
        ("[][0,6] (rise(p) -> <>[0,3] !p)", 1),
        ("G[0,6] (rise(p) -> F[0,2] !p)", 0),
        ("[][0,2) !p", 1),
        ("G[0,2] !p", 0),
        ("F(2,2.5] [][0,2] n == 1", 1),
        ("<>[2.5,4.5] n == 2", 0),
        ("not <>[0,1] p and [][3,4] (n > 0 imply p)", 1),
        ("[][0,6] (forall (i : int[2,3]) n != i)", 0),
        ("F[5,6] O[0,1] p", 1),
        ("F[1,9] change(n)", 1),
    ],
)
def test_formulas_mean_what_the_logic_says(fixed: tachk.Model, formula: str, expected: int) -> None:
    assert share(fixed, f"Pr({formula})") == (expected, 0)
    assert share(fixed, f"Pr[<=20]({formula})") == (expected, 0)


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ("Pr[<=10]([] (p -> <>[0,3] !p))", (1, 0)),
        ("Pr[<=6](!p W n == 1)", (1, 0)),
        ("Pr[<=1](F p)", (0, 0)),
        ("Pr[<=3](<>[0,9] P.d && n < 3)", (0, 3)),
        ("Pr[<=4](<>[0,9] P.d)", (0, 3)),
        ("Pr[<=1](G[2,3] (p && false -> F[1,2] p))", (1, 0)),
        ("Pr[<=1](F[2,3] !true)", (0, 0)),
        ("Pr[<=4](<>[0,3] P.x > 2)", (1, 0)),
    ],
)
def test_the_bound_ends_runs_and_is_the_interval_of_outermost_operators(
    fixed: tachk.Model, query: str, expected: tuple[int, int]
) -> None:
    assert share(fixed, query) == expected


@pytest.mark.parametrize(
    ("query", "decision"),
    [
        ("Pr(<>[0,3] ([][0,2] p)) >= 0.5", Decision.HOLDS),
        ("Pr(<>[0,3] ([][0,3] p)) >= 0.5", Decision.FAILS),
        ("Pr(<>[0,3] ([][0,3] p)) <= 0.5", Decision.HOLDS),
        ("Pr(<>[0,3] ([][0,3] p)) >= Pr(<>[0,3] p && n < 2)", Decision.FAILS),
    ],
)
def test_they_are_tested_and_compared(fixed: tachk.Model, query: str, decision: Decision) -> None:
    (found,) = fixed.estimate(query)
    assert isinstance(found, Decided)
    assert found.decision is decision
    expected = "holds" if decision is Decision.HOLDS else "fails"
    assert tachk.loads(f"{FIXED}property q: {query} expect {expected};").verify().met is True


@pytest.mark.parametrize(
    ("formula", "code"),
    [
        ("Pr(<>[0,3] ([] p))", "E0728"),
        ("Pr([] (p -> <>[0,5] p))", "E0728"),
        ("Pr[<=9](<>[0,3] p && [] (p -> F p))", "E0728"),
        ("Pr(<>[0,3] p && X p)", "E0728"),
        ("Pr(p R[0,3] p)", "E0728"),
        ("Pr(<>[0,3] p && <>[0,2] P.x > 1)", "E0728"),
        ("Pr[#<=9](<>[0,3] p && <>[0,2] p)", "E0728"),
        ("Pr(<>[0,3] p && deadlock)", "E0728"),
    ],
)
def test_what_is_not_estimated_is_named(fixed: tachk.Model, formula: str, code: str) -> None:
    with pytest.raises(UnsupportedError) as raised:
        fixed.estimate(formula)
    assert raised.value.diagnostic.code == code


@pytest.mark.parametrize("formula", ["Pr(<>[0,3] p && <>[0,2] nope)", "Pr(F[3,1] G[0,1] p)", "Pr[<=3](F[5,oo] p)"])
def test_mistakes_have_their_places(fixed: tachk.Model, formula: str) -> None:
    with pytest.raises(InputError) as raised:
        fixed.estimate(formula)
    assert raised.value.diagnostics[0].span.start > 0


def test_there_is_no_splitting(fixed: tachk.Model) -> None:
    (found,) = fixed.estimate("Pr(<>[0,3] ([][0,2] p))", runs=1)
    with pytest.raises(UsageError, match="several temporal operators"):
        estimate(fixed.network, found.query, Settings(splitting=Splitting()))


def test_a_name_of_the_model_is_no_operator() -> None:
    model = tachk.loads(FIXED.replace("bool p;", "bool p; bool R[2]; bool X;"))
    assert share(model, "Pr[<=9]([] !R[0] && !X)") == (1, 0)


def test_bounds_of_intervals_vary_in_sweeps() -> None:
    model = tachk.loads("const int T = 2;" + FIXED)
    found = model.sweep("Pr(<>[0,3] ([][0,T] p))", over="T=2,3", processes=1)
    assert [row["estimate"] for row in found.rows] == [1, 0]
