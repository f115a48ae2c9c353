"""The publishing half of Micro XRCE-DDS obeys its closed forms: each bound is exact, one less fails."""

import pytest

import tachk
from tachk.base.resources import data_root

pytestmark = pytest.mark.drawn

PUBLICATION = data_root() / "models" / "micro_xrce_dds" / "publication.ta"

STEADY, REARMED, DOUBLING = 0, 1, 2
LONG = 20


def answer(name: str, **constants: int | bool) -> str:
    report = tachk.load(PUBLICATION, **constants).verify(
        property=name, trace=False, limits=tachk.Limits(states=500_000)
    )
    return report[name].answer.value


def assert_exact(name: str, bound: str, value: int, **constants: int | bool) -> None:
    """`value` is the least bound under which the property holds."""
    assert answer(name, **constants, **{bound: value}) == "holds"
    assert answer(name, **constants, **{bound: value - 1}) == "fails"


@pytest.mark.parametrize("losses", [0, 1, 2])
def test_the_last_delivery_comes_by_the_closed_form(losses: int) -> None:
    """(N-1) max(PACE, SPIN) + K (HBC + 2D) + D: 9, 13, ... for N = 3, SPIN = 4, HBC = 2, D = 1."""
    assert_exact("ECFS", "DELIVERY_BOUND", 9 + 4 * losses, LOSSES=losses)


def test_with_three_losses_the_last_delivery_may_take_that_long() -> None:
    """The other half, that 21 is enough, takes 2.5 million states and half a minute."""
    assert answer("ECFS", LOSSES=3, DELIVERY_BOUND=20) == "fails"


def test_a_loss_is_detected_after_one_heartbeat() -> None:
    assert_exact("TMRK", "REPAIR_BOUND", 3, LOSSES=1)


@pytest.mark.parametrize("losses", [1, 2, 3])
def test_with_doubling_waits_detection_takes_two_to_the_losses(losses: int) -> None:
    assert_exact(
        "TMRK",
        "REPAIR_BOUND",
        2**losses,
        HEARTBEAT_LAW=DOUBLING,
        CLIENT_HEARTBEAT=1,
        LOSSES=losses,
        MESSAGES=1,
        SPIN=1000,
    )


@pytest.mark.parametrize("losses", [0, 1, 2, 3])
@pytest.mark.parametrize(("heartbeat", "delay"), [(5, 1), (10, 2)])
def test_a_publish_blocks_as_long_as_the_closed_form_says(losses: int, heartbeat: int, delay: int) -> None:
    """k (H + 2d) + 2d."""
    assert_exact(
        "blocking",
        "DELIVERY_BOUND",
        losses * (heartbeat + 2 * delay) + 2 * delay,
        LOSSES=losses,
        CLIENT_HEARTBEAT=heartbeat,
        DELAY=delay,
        MESSAGES=1,
        SPIN=1000,
        PACE=0,
    )


def test_run_slices_shorter_than_the_heartbeat_starve_it() -> None:
    assert answer("TMRK", HEARTBEAT_LAW=REARMED, SPIN=1, REPAIR_BOUND=LONG) == "fails"
    assert answer("ECFS", HEARTBEAT_LAW=REARMED, SPIN=1, DELIVERY_BOUND=LONG) == "fails"
    assert_exact("TMRK", "REPAIR_BOUND", 3, HEARTBEAT_LAW=STEADY, SPIN=1, PACE=4)


def test_an_outstanding_acknack_delays_the_detection_of_the_next_loss() -> None:
    """An ACKNACK starts the timer again: with PACE = HBC the worst detection is 5, not HBC + D = 3."""
    assert_exact("TMRK", "REPAIR_BOUND", 5, HEARTBEAT_LAW=STEADY, SPIN=1, PACE=2, MESSAGES=2)


def test_inbound_traffic_starves_the_heartbeat() -> None:
    assert answer("TMRK", HEARTBEAT_LAW=REARMED, TRAFFIC=1, REPAIR_BOUND=LONG) == "fails"
    assert_exact("TMRK", "REPAIR_BOUND", 3, HEARTBEAT_LAW=STEADY, TRAFFIC=1)


LATE = {"DELAY": 2, "PACE": 1, "SPIN": 1, "CLIENT_HEARTBEAT": 20}


def test_a_stale_acknack_makes_a_hole_only_with_reordering_and_without_the_guard() -> None:
    assert answer("NOHOLE", LOSSES=1, REORDER=True, GUARDED=False, **LATE) == "fails"
    assert answer("NOHOLE", LOSSES=1, REORDER=False, GUARDED=False, **LATE) == "holds"
    assert answer("NOHOLE", LOSSES=1, REORDER=True, GUARDED=True, GO_BACK=False, **LATE) == "holds"


def test_a_second_create_client_loses_messages_or_repeats_them() -> None:
    assert answer("RMIO", LOSSES=1, DUPLICATES=1, RESETS=True) == "fails"
    assert answer("ECFS", LOSSES=0, DUPLICATES=1, RESETS=True, DELIVERY_BOUND=LONG) == "fails"
    assert answer("ECFS", LOSSES=0, DUPLICATES=1, RESETS=False, DELIVERY_BOUND=9) == "holds"
