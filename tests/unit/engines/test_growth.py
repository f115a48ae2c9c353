"""Proofs that a clock grows without limit."""

from tachk.diagnostics.span import Source
from tachk.engines.growth import grows_without_limit
from tachk.loading.load import load_model
from tachk.model.expressions import LocationTest, Reference
from tachk.semantics.timed_trace import Participant, Transition

TEXT = """
process P() {
    clock x, y, z;
    init location A { invariant x <= 4; to A { guard x < 4; assign y = 0; } to A { guard x >= 4; assign x = 0; } }
}
system P;
"""
QUICK, SLOW = (Transition((Participant(0, edge),)) for edge in (0, 1))


def grows(clock: int, *path: Transition) -> bool:
    network = load_model(Source("m.ta", TEXT)).network
    return grows_without_limit(network, path, LocationTest(0, 0), Reference(network.processes[0].variables[clock]))


def test_a_loop_that_takes_time_proves_it_for_the_clocks_that_it_does_not_set() -> None:
    assert grows(2, SLOW, SLOW)
    assert grows(2, *3 * (QUICK, SLOW))
    assert not grows(0, SLOW, SLOW)


def test_a_loop_that_need_not_take_time_proves_nothing() -> None:
    assert not grows(0, QUICK, QUICK)
    assert not grows(2, QUICK, QUICK)


def test_what_cannot_be_taken_proves_nothing() -> None:
    assert not grows(2, Transition((Participant(0, 1), Participant(0, 1))))
