"""The subscribing half of Micro XRCE-DDS with links that take time."""

import pytest

import tachk
from tachk.base.resources import data_root

pytestmark = pytest.mark.drawn

SUBSCRIPTION = data_root() / "models" / "micro_xrce_dds" / "subscription.ta"

PULL, PUSH_PING = 1, 2


def answer(name: str, **constants: int | bool) -> str:
    report = tachk.load(SUBSCRIPTION, **constants).verify(
        property=name, trace=False, limits=tachk.Limits(states=300_000)
    )
    return report[name].answer.value


def test_the_half_answers_as_it_expects() -> None:
    assert tachk.load(SUBSCRIPTION).verify(trace=False).met is True


def test_the_longest_sleep_follows_from_the_dead_time() -> None:
    """q + SLEEP + HBA < DEAD with q = LINGER = 2, HBA = 2, DEAD = 8."""
    assert answer("complete", SLEEP=3) == "holds"
    assert answer("complete", SLEEP=4) == "fails"
    assert answer("complete", SLEEP=4, SUBSCRIPTION=PUSH_PING) == "holds"
    assert answer("complete", SLEEP=4, SUBSCRIPTION=PUSH_PING, PING_IN_SESSION=False) == "fails"


@pytest.mark.parametrize("sleep", [3, 4])
@pytest.mark.parametrize("in_session", [True, False])
def test_it_expects_what_a_ping_outside_the_session_does_not_help(sleep: int, in_session: bool) -> None:
    model = tachk.load(SUBSCRIPTION, SLEEP=sleep, SUBSCRIPTION=PUSH_PING, PING_IN_SESSION=in_session)
    assert model.verify(trace=False).met is True


@pytest.mark.parametrize(("losses", "linger", "expected"), [(0, 2, "fails"), (0, 3, "holds"), (2, 3, "fails")])
def test_a_pull_subscriber_lingers_longer_the_more_can_be_lost(losses: int, linger: int, expected: str) -> None:
    found = answer("NIWS", SUBSCRIPTION=PULL, AGENT_HEARTBEAT=1, DEAD=6, SLEEP=10, LINGER=linger, LOSSES=losses)
    assert found == expected


def test_with_two_losses_the_silence_before_the_sleep_is_longer_than_the_lingering() -> None:
    """LINGER + SLEEP + 3 HBA = 5 < DEAD, but the Agent has missed the last answer of the client: q = 4."""
    constants = {"MESSAGES": 2, "KEEP": 2, "LINGER": 1, "SLEEP": 1, "AGENT_HEARTBEAT": 1, "DEAD": 6}
    assert answer("ECRA", LOSSES=2, **constants) == "fails"
