"""Proofs that a clock grows without limit."""

from tachk.base.span import Source
from tachk.engine.growth import grows_without_limit
from tachk.formats.loading.load import load_model
from tachk.model.expressions import LocationTest, Reference
from tachk.model.run import Participant, Transition

TEXT = """
process P() {
    clock x, y, z;
    init location A { invariant x <= 4; to A { guard x < 4; assign y = 0; } to A { guard x >= 4; assign x = 0; } }
}
system P;
"""
QUICK, SLOW = (Transition((Participant(0, edge),)) for edge in (0, 1))


def grows(clock: int, *path: Transition, text: str = TEXT) -> bool:
    network = load_model(Source("m.ta", text)).network
    return grows_without_limit(network, path, LocationTest(0, 0), Reference(network.processes[0].variables[clock]))


def test_a_loop_that_takes_time_proves_it_for_the_clocks_that_it_does_not_set() -> None:
    assert grows(2, SLOW, SLOW)
    assert grows(2, *3 * (QUICK, SLOW))
    assert not grows(0, SLOW, SLOW)


def test_nothing_is_proved_of_paths_that_copy_clocks() -> None:
    text = TEXT.replace("x = 0", "x = 0, y = z")
    assert not grows(2, SLOW, SLOW, text=text)


def test_a_loop_that_need_not_take_time_proves_nothing() -> None:
    assert not grows(0, QUICK, QUICK)
    assert not grows(2, QUICK, QUICK)


BESIDE_OLD_CLOCKS = """
process P() {
    clock x, late, z;
    init location A { invariant x <= 1; to A { guard x >= 1; assign x = 0; } to B { guard late > 100; } }
    location B;
}
system P;
"""


def test_the_loop_is_found_behind_a_long_way_on_which_other_clocks_pass_all_constants() -> None:
    assert grows(2, *210 * (QUICK,), text=BESIDE_OLD_CLOCKS)
    assert not grows(2, *50 * (QUICK,), text=BESIDE_OLD_CLOCKS)  # where it is at most 50, `late` distinguishes them


def test_valuations_from_which_the_loop_does_not_start_again_are_left_out() -> None:
    """Behind the loop `y` is at least 1, and more each time: only where it is beyond all constants it comes back."""
    text = TEXT.replace("guard x < 4; assign y = 0;", "guard y > 4;").replace("guard x >= 4;", "")
    assert grows(1, *3 * (SLOW,), text=text)
    assert grows(2, *3 * (SLOW,), text=text)


def test_what_remains_of_the_valuations_must_go_on_as_the_path_does() -> None:
    text = TEXT.replace("guard x < 4; assign y = 0;", "guard y <= 4;").replace("guard x >= 4;", "")
    assert grows(2, SLOW, SLOW, SLOW, text=text)
    assert not grows(2, SLOW, SLOW, SLOW, QUICK, text=text)


def test_what_cannot_be_taken_proves_nothing() -> None:
    assert not grows(2, Transition((Participant(0, 1), Participant(0, 1))))


URGENT = """
urgent chan go;
process P() { clock x; init location A { to A { sync go!; } } }
process Takes(int[0, 2] number) { init location A { to A { sync go?; } } }
system P, Takes;
"""


def test_the_same_valuations_are_kept_once_where_several_synchronisations_are_urgent() -> None:
    """Each of the three gives the zone behind a step once more."""
    steps = 16 * (Transition((Participant(0, 0), Participant(1, 0))),)
    assert not grows(0, *steps, text=URGENT)
