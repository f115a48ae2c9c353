"""What is remembered of discrete states."""

from __future__ import annotations

from fractions import Fraction

import pytest

import tachk
from tachk.meaning.discrete import prepare
from tachk.meaning.memory import MOST_STATES, Memory, by_state
from tachk.meaning.step import initial_state, satisfies_invariants
from tachk.model.fault import EvaluationFault


class Model:
    def __init__(self) -> None:
        self.memory = Memory()
        self.asked: list[tuple[str, int]] = []


@by_state
def answer(model: Model, state: str, number: int) -> str:
    model.asked.append((state, number))
    if number < 0:
        raise ValueError
    return f"{state}{number}"


def test_what_is_asked_again_is_remembered_for_each_state_and_question() -> None:
    model = Model()
    questions = [("a", 1), ("a", 2), ("b", 1), ("a", 1), ("b", 1), ("b", 2)]
    assert [answer(model, *question) for question in questions] == ["a1", "a2", "b1", "a1", "b1", "b2"]
    assert model.asked == [("a", 1), ("a", 2), ("b", 1), ("b", 2)]


def test_what_goes_wrong_goes_wrong_again() -> None:
    model = Model()
    for _ in range(2):
        with pytest.raises(ValueError):
            answer(model, "a", -1)
    assert len(model.asked) == 2


def test_only_the_last_states_are_remembered() -> None:
    model = Model()
    for number in range(MOST_STATES + 1):
        answer(model, str(number), 0)
    answer(model, str(MOST_STATES), 0)
    answer(model, "1", 0)
    assert len(model.asked) == MOST_STATES + 1
    answer(model, "0", 0)
    assert len(model.asked) == MOST_STATES + 2


INVARIANTS = """
int n = 0; int a[2];
process First() { clock x; init location A { invariant x <= 2; } }
process Second() { init location A { invariant SECOND; } }
system First, Second;
"""


def test_invariants_are_asked_up_to_the_first_that_is_false() -> None:
    def holds(second: str, time: int) -> bool:
        model = prepare(tachk.loads(INVARIANTS.replace("SECOND", second)).network)
        state = initial_state(prepare(tachk.loads(INVARIANTS.replace("SECOND", "true")).network))
        later = type(state)(state.discrete, (Fraction(time),), Fraction(time))
        return satisfies_invariants(model, later)

    assert holds("n == 0", 2)
    assert not holds("n == 0", 3)
    assert not holds("n == 1", 2)
    assert not holds("a[n + 2] == 0", 3)
    with pytest.raises(EvaluationFault):
        holds("a[n + 2] == 0", 2)
