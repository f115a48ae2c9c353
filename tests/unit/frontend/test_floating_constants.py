from __future__ import annotations

import pytest

import tachk

MODEL = """
const double HALF = 0.5;
const double RATE = HALF * 3 + 1 / 2;
const double BIG = 4503599627370497.0;
const string NAME = "front";
const int N = 7;
int[0,9] n;
process P() {{ init location a {{ to a {{ guard {guard}; assign n = {value}; }} }} }}
system P;
property p : A[] n == 0;
property q : E<> n == {value};
"""


def answers(guard: str = "true", value: str = "1") -> list[str]:
    return [verdict.answer.value for verdict in tachk.loads(MODEL.format(guard=guard, value=value)).verify()]


@pytest.mark.parametrize(
    ("guard", "truth"),
    [
        ("HALF < 1", True),
        ("HALF * 2 == 1", True),
        ("RATE == 1.5", True),  # 1 / 2 divides integers
        ("RATE > N", False),
        ("-HALF <= -0.5", True),
        ("0.1 + 0.2 == 0.3", False),  # as doubles are
        ("1.0 / 3 * 3 == 1.0", True),
        ("sqrt(2.25) == 1.5", True),
        ("fmax(HALF, 2) == 2.0 && fmin(HALF, 2) == 0.5", True),
        ("floor(-1.5) == -2 && ceil(-1.5) == -1 && trunc(-1.5) == -1 && round(-1.5) == -2", True),
        ("round(BIG) == BIG", True),
        ("fabs(-HALF) != HALF", False),
        ('NAME == "front"', True),
        ('NAME != "front"', False),
        ('"back" == NAME', False),
    ],
)
def test_comparisons_are_decided_when_the_model_is_read(guard: str, truth: bool) -> None:
    assert answers(guard) == (["fails", "holds"] if truth else ["holds", "fails"])


@pytest.mark.parametrize(
    ("value", "whole"),
    [("fint(RATE)", 1), ("fint(RATE * N) - 4", 6), ("fint(9.99)", 9), ("fint(-0.5) + 2", 2), ("fint(round(HALF))", 1)],
)
def test_fint_makes_an_integer(value: str, whole: int) -> None:
    model = tachk.loads(MODEL.format(guard="true", value=value))
    assert model.verify(f"E<> n == {whole}")[0].answer.value == "holds"


@pytest.mark.parametrize(
    "guard",
    [
        "n < 1.5",  # n is not known before the model runs
        "sin(HALF) < 1",  # libraries round it differently
        "1.0 / 0 > 1",
        "sqrt(-1.0) == 0",
        "fint(1e10) == 0",
        "NAME < HALF",
        "NAME",
        "random(1.0) < 2",
        "HALF",
    ],
)
def test_what_is_not_known_before_is_refused(guard: str) -> None:
    model = tachk.loads(MODEL.format(guard=guard, value="1"))
    assert [refusal.code for refusal in model.refusals][:1] == ["E0750"]


def test_constants_with_a_value_need_no_warning_and_variables_do() -> None:
    assert tachk.loads(MODEL.format(guard="true", value="1")).warnings == ()
    text = """double d = 0.5; string s = "x";
    process P() { init location a { to a { assign d = d * 2, s = "y"; } } }
    system P;"""
    model = tachk.loads(text)
    assert [(w.code, w.span.text) for w in model.warnings] == [("W0406", "d"), ("W0406", "s")]
    assert model.refusals == ()
