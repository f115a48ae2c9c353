"""A run that violates a formula says where it has what is awaited, but for no time."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest

import tachk
from tachk.meaning.discrete import prepare
from tachk.model.expressions import LocationTest
from tachk.model.run import DiscreteState, Participant, TimedState, TimedStep, TimedTrace, Transition
from tachk.verify.momentary_answers import moments
from tests.support.seeds import enough, seeds

MODEL = """
time_unit = 1 ms;
process P() {
    clock x;
    init location Idle { to Waiting { guard x > 100; assign x = 0; } }
    location Waiting { invariant x <= 20; to Done { guard x == 20; } }
    urgent location Done { to Idle; }
}
Client = P();
system Client;
"""


@pytest.mark.parametrize(
    "formula",
    [
        "Whenever Client.Waiting, within 60 ms, Client.Done must be true.",
        "G (Client.Waiting -> F[0, 60 ms] Client.Done)",
        "G (Client.Waiting -> (Client.Waiting U[0, 60 ms] Client.Done))",
    ],
)
def test_the_answer_comes_for_no_time(formula: str) -> None:
    (verdict,) = tachk.loads(MODEL).verify(formula)
    assert verdict.answer is tachk.Answer.FAILS
    (note,) = verdict.notes
    assert "`Client.Done` is true for no time" in note
    assert verdict.trace is not None
    (when,) = {state.time for state in verdict.trace.states if state.discrete.locations == (2,)}
    assert f"{when} ms" in note


@pytest.mark.parametrize(
    "formula",
    [
        "G (Client.Waiting -> F[0, 10 ms] Client.Done)",  # it comes too late
        "F[0, 90 ms] Client.Done",
        "G !Client.Waiting",
    ],
)
def test_no_note_where_nothing_of_it_came(formula: str) -> None:
    (verdict,) = tachk.loads(MODEL).verify(formula)
    assert verdict.notes == ()


def test_an_answer_before_the_window_needs_no_note() -> None:
    model = tachk.loads(MODEL.replace("Idle { to Waiting", "Idle { to Done { guard x < 5; } to Waiting"))
    (verdict,) = model.verify("G (Client.Waiting -> F[0, 10 ms] Client.Done)")
    assert verdict.answer is tachk.Answer.FAILS
    assert verdict.notes == ()


def test_random_runs_have_the_moments_that_their_values_just_before_and_after_say() -> None:
    """The oracle asks for the value a little before and a little after each state."""
    model = prepare(tachk.loads("process P() { init location a { to b; } location b { to a; } } system P;").network)
    found = 0
    for seed in seeds(range(200)):
        random = Random(seed)
        time, states, steps = Fraction(0), [random.randrange(2)], []
        times = [time]
        for _ in range(random.randrange(8)):
            delay = Fraction(random.choice((0, 0, 1, 2)))
            time += delay
            states.append(random.randrange(2))
            times.append(time)
            state = TimedState(DiscreteState((states[-1],), ()), (), time)
            steps.append(TimedStep(delay, Transition((Participant(0, 1 - states[-1]),)), state))
        run = TimedTrace(TimedState(DiscreteState((states[0],), ()), (), Fraction(0)), tuple(steps))

        def value_at(moment: Fraction, times: list[Fraction] = times, states: list[int] = states) -> int:
            return states[max(n for n, begin in enumerate(times) if begin <= moment)] if moment >= 0 else 0

        little = Fraction(1, 4)
        expected = {
            moment
            for moment, state in zip(times, states, strict=True)
            if state and not value_at(moment - little) and not value_at(moment + little)
        }
        assert set(moments(model, run, LocationTest(0, 1))) == expected, f"seed {seed}"
        found += bool(expected)
    assert enough(found > 20), found
