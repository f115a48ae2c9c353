"""Bounds of temporal operators in models: constants, units, and what is wrong with them."""

from __future__ import annotations

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tests.support.queries import elaborate_queries

MODEL = """
%s
const int BOUND = 3;
const int[0, 9] TABLE[2] = { 4, 7 };
int n;
int twice(int value) { return 2 * value; }
process P() { init location A { to B; } location B { to A; } }
system P;
"""


def canonical(text: str, unit: str = "", **constants: int) -> str:
    """The formula of a property as its observer has it, with bounds that are numbers."""
    declared = f"time_unit = {unit};" if unit else ""
    loaded = load_model(Source("m.ta", MODEL % f"{declared} property p : {text};"), constants)
    observer = loaded.queries[0].observer
    assert observer is not None
    return observer.formula


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("F[0, BOUND] P.B", "F[0, 3] P.B"),
        ("F[0, 2 * BOUND + 1] P.B", "F[0, 7] P.B"),
        ("F[0, TABLE[1]] P.B", "F[0, 7] P.B"),
        ("F[0, twice(BOUND)] P.B", "F[0, 6] P.B"),
        ("G[BOUND - 3, BOUND) P.B", "G[0, 3) P.B"),
        ("F[0, BOUND / 2 * 2] P.B", "F[0, 3] P.B"),
        ("F[0, 0.5 * twice(TABLE[0])] P.B", "F[0, 4] P.B"),
    ],
)
def test_constants(text: str, expected: str) -> None:
    assert canonical(text) == expected


def test_constants_can_be_given_another_value() -> None:
    assert canonical("F[0, BOUND] P.B", BOUND=8) == "F[0, 8] P.B"


@pytest.mark.parametrize(
    ("unit", "expected"), [("1 ms", "5000"), ("10 ms", "500"), ("1 s", "5"), ("5 s", "1"), ("1 us", "5000000")]
)
def test_units(unit: str, expected: str) -> None:
    assert canonical("F[0, 5 s] P.B", unit) == f"F[0, {expected}] P.B"
    assert canonical("whenever P.A, within 5 s, P.B must be true.", unit) == f"G (P.A -> F[0, {expected}] P.B)"


def test_queries_of_the_command_line_know_the_time_unit() -> None:
    loaded = load_model(Source("m.ta", MODEL % "time_unit = 10 ms;"))
    queries, _ = elaborate_queries(loaded, "F[0, 20 ms] P.B")
    assert queries[0].observer is not None
    assert queries[0].observer.formula == "F[0, 2] P.B"


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("F[0, n] P.B", "E0601", "n"),
        ("F[0, GONE] P.B", "E0201", "GONE"),
        ("F[0, 2 - BOUND] P.B", "E0504", "2 - BOUND"),
        ("F[0, 1 / (BOUND - 3)] P.B", "E0602", "1 / (BOUND - 3)"),
        ("G (P.A -> F[BOUND, 2] P.B)", "E0505", "[BOUND, 2]"),
        ("F[0, 5 s] P.B", "E0506", "5 s"),
        ("whenever P.A, within 5 s, P.B must be true.", "E0506", "5 s"),
    ],
)
def test_wrong_bounds(text: str, code: str, place: str) -> None:
    with pytest.raises(InputError) as caught:
        canonical(text)
    assert [(d.code, d.span.text) for d in caught.value.diagnostics] == [(code, place)]


def test_a_bound_that_is_no_whole_number_is_not_rounded() -> None:
    loaded = load_model(Source("m.ta", MODEL % "property p : F[0, BOUND / 2] P.B;"))
    ((diagnostic,),) = [query.diagnostics for query in loaded.unchecked]
    assert (diagnostic.span.text, "1.5 time units" in diagnostic.message) == ("BOUND / 2", True)
