"""`tachk.step`: what a walk says is possible is what the reference semantics lets happen."""

from __future__ import annotations

from fractions import Fraction
from inspect import signature
from random import Random

import pytest

import tachk
from tachk.simulation.stepping.walk import Walk
from tests.support.seeds import seeds

LAMP = """
chan press; int n = 0;
process Lamp() {
    clock x;
    init location Off { to Low { sync press?; assign x = 0; } }
    location Low { invariant x <= 4; to Bright { guard x > 1 && x < 3; sync press?; } to Off { guard x == 4; } }
    location Bright;
}
process Finger() { init location Up { to Up { guard n < 2; sync press!; assign n = n + 1; } } }
system Lamp, Finger;
"""


def lamp() -> Walk:
    return tachk.loads(LAMP).step()


def test_a_walk_lists_what_can_happen_and_when() -> None:
    (press,) = lamp().choices
    assert str(press) == "press!  Finger: Up -> Up & Lamp: Off -> Low, after a delay in [0, ∞)"
    low = lamp().take(press)
    assert repr(low) == "<Walk after 1 step, at time 0: Lamp.Low, Finger.Up>"
    assert [str(each.delays[0]) for each in low.choices] == ["4", "(1, 3)"]
    assert 2.5 in low.choices[1].delays[0] and str(low.delays) == "[0, 4]"
    assert lamp()  # also before the first step


def test_a_transition_is_chosen_by_its_place_or_its_text() -> None:
    low = lamp().take(0)
    by_text = low.take("Low -> Bright", after="7/3")
    assert by_text.state.time == Fraction(7, 3) == low.take(-1, after=Fraction(7, 3)).state.time
    assert by_text.state.locations[0] == ("Lamp", "Bright") and by_text.choices == ()
    assert low.take("Bright").state.time == 2  # a short delay of the open interval
    assert dict(low.delay(2.5).state.clocks or ())["Lamp.x"] == Fraction(5, 2)
    assert len(low) == 1  # a walk never changes


@pytest.mark.parametrize(
    ("index", "after", "message"),
    [
        (2, None, "2 is not possible in this state"),
        ("Low", None, "'Low' fits several choices"),
        ("Up -> Down", None, "'Up -> Down' is not possible in this state"),
        ("Bright", 3, "this is possible after a delay in (1, 3)"),
        ("Bright", "soon", "'soon' is not a number of time units"),
        (None, None, "`choice` is None, but it must be"),
    ],
)
def test_what_is_not_possible_says_why(index: int, after: float, message: str) -> None:
    with pytest.raises(tachk.UsageError) as caught:
        lamp().take(0).take(index, after)
    assert message in str(caught.value)


@pytest.mark.parametrize("time", [5, -1])
def test_time_passes_only_as_the_model_allows(time: int) -> None:
    with pytest.raises(tachk.UsageError):
        lamp().take(0).delay(time)


def test_random_steps_are_repeated_and_end_in_a_deadlock() -> None:
    walk = lamp().random(50, seed=4)
    assert walk.run.to_text() == lamp().random(50, seed=4).run.to_text() and len(walk) < 50 and not walk.choices


@pytest.mark.parametrize("seed", seeds(range(20)))
def test_a_random_walk_is_a_run_that_replay_accepts(seed: int, tmp_path_factory: pytest.TempPathFactory) -> None:
    model = tachk.random_network(seed)
    try:
        walk = model.step().random(8, seed)
    except tachk.TachkError:
        pytest.skip("no initial state, or a run-time error")
    for choice in walk.choices:
        delay = Random(seed).choice(choice.delays).some
        assert walk.take(choice, after=delay).state.time == (walk.state.time or 0) + delay
    file = tmp_path_factory.mktemp("runs") / "walk.run"
    file.write_text(f"# a walk\n{walk.run.to_text()}", encoding="utf-8")
    replayed = model.replay(file)
    assert replayed and replayed.states[-1] == walk.state and len(replayed) == len(walk)


def test_the_methods_of_a_model_have_the_parameters_of_the_functions() -> None:
    for name in ("simulate", "replay", "step"):
        function, method = signature(getattr(tachk, name)), signature(getattr(tachk.Model, name))
        assert list(function.parameters.values())[1:] == list(method.parameters.values())[1:]
    model = tachk.loads(LAMP)
    assert model.simulate(3, seed=2).to_rows() == tachk.simulate(model, 3, seed=2).to_rows()


def test_times_are_measured_from_the_start_of_the_run() -> None:
    model = tachk.loads("process P() { clock x; init location a { invariant x <= 5; to b; } location b; } system P;")
    assert str(model.time(end="P.b")) == str(model.time(None, "P.b"))
    with pytest.raises(tachk.UsageError, match="no second event"):
        model.time("P.b")
