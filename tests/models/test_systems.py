"""The composed systems of Micro XRCE-DDS, at sizes that take about a second."""

import pytest

import tachk
from tachk.base.resources import data_root

pytestmark = pytest.mark.drawn

SYSTEMS = data_root() / "models" / "micro_xrce_dds"

PUSH, PULL, PUSH_PING = 0, 1, 2
SMALL = {"MESSAGES": 3, "KEEP": 3, "QUOTA": 2, "AGENT_HEARTBEAT": 1, "DEAD": 6}


def answers(system: str, *properties: str, **constants: int | bool) -> dict[str, str]:
    model = tachk.load(SYSTEMS / f"{system}.ta", **constants)
    report = model.verify(property=properties, trace=False, limits=tachk.Limits(states=500_000))
    return {verdict.query.name: verdict.answer.value for verdict in report}


@pytest.mark.parametrize("system", ["paper", "spec"])
def test_the_rules_keep_every_property_of_a_short_scenario(system: str) -> None:
    model = tachk.load(SYSTEMS / f"{system}.ta", MESSAGES=4, KEEP=4, QUOTA=2, LOSSES=1)
    report = model.verify(trace=False, limits=tachk.Limits(states=500_000))
    assert [verdict.query.name for verdict in report if verdict.met is not True] == []


@pytest.mark.parametrize(("losses", "longest_sleep"), [(0, 3), (1, 2)])
def test_a_push_subscription_survives_a_sleep_shorter_than_the_dead_time(losses: int, longest_sleep: int) -> None:
    """Delivered iff q + SLEEP + (K + 1) HBA < DEAD, with q = LINGER = 1, HBA = 1, DEAD = 6."""
    for sleep, answer in ((longest_sleep, "holds"), (longest_sleep + 1, "fails")):
        found = answers("paper", "complete", LOSSES=losses, SUBSCRIPTION=PUSH, LINGER=1, SLEEP=sleep, **SMALL)
        assert found == {"complete": answer}, sleep


def test_a_ping_after_waking_or_a_longer_dead_time_brings_everything() -> None:
    settings = {**SMALL, "LOSSES": 0, "LINGER": 1, "SLEEP": 10}
    assert answers("paper", "complete", SUBSCRIPTION=PUSH, **settings) == {"complete": "fails"}
    assert answers("paper", "complete", SUBSCRIPTION=PUSH_PING, **settings) == {"complete": "holds"}
    assert answers("paper", "complete", SUBSCRIPTION=PUSH, **{**settings, "DEAD": 20}) == {"complete": "holds"}


def test_a_topic_quieter_than_the_dead_time_is_stuck_after_one_loss() -> None:
    settings = {**SMALL, "LOSSES": 1, "SUBSCRIPTION": PUSH, "SLEEPS": 0}
    assert answers("paper", "complete", PACE=4, **settings) == {"complete": "holds"}
    assert answers("paper", "complete", PACE=8, **settings) == {"complete": "fails"}


@pytest.mark.parametrize("losses", [0, 1, 2])
def test_a_pull_subscription_sleeps_undisturbed_if_it_lingers_long_enough(losses: int) -> None:
    """LINGER > LOSSES * HBA (links without delay)."""
    for linger, answer in ((losses, "fails"), (losses + 1, "holds")):
        found = answers("paper", "NIWS", LOSSES=losses, SLEEP=10, LINGER=linger, **SMALL)
        assert found == {"NIWS": answer}, linger


def test_a_reader_that_keeps_one_sample_loses_the_others_during_the_sleep() -> None:
    found = answers("paper", "ECRA", "RMIO2_prefix", LOSSES=0, KEEP=1)
    assert found == {"ECRA": "fails", "RMIO2_prefix": "fails"}


def test_the_paper_own_sleep_is_too_long_for_a_push_subscription() -> None:
    found = answers("paper", "ECRA", "NIWS", "FARS", "ECFS", LOSSES=0, SUBSCRIPTION=PUSH, LINGER=0)
    assert found == {"ECRA": "fails", "NIWS": "fails", "FARS": "fails", "ECFS": "holds"}
