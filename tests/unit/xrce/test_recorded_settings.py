"""Settings for models that recordings are held against: what clients and the Agent were like."""

from __future__ import annotations

from pathlib import Path

import pytest

import tachk

CAPTURES = Path(__file__).parents[2] / "data/captures/later"


@pytest.mark.parametrize(
    ("name", "slots"),
    [
        ("input_window", 4),  # five ACKNACKs do not count what came too early
        ("micro_ros_spin_losses", None),  # made with four slots, too, but nothing shows it
        ("fragments_losses", None),
        ("client_2_0", None),
    ],
)
def test_acknacks_show_the_window(name: str, slots: int | None) -> None:
    assert tachk.measure(CAPTURES / f"{name}.pcap").recorded_definitions().get("INPUT_HISTORY") == slots


def test_packets_that_a_client_does_not_read() -> None:
    """Its radio is off; clients that are awake answer all."""
    assert tachk.measure(CAPTURES / "dead_time_3s.pcap").recorded_definitions().get("SLEEPS") == 1
    assert "SLEEPS" not in tachk.measure(CAPTURES / "two_publishers_losses.pcap").recorded_definitions()


def test_heartbeats_show_a_delay_of_the_thread() -> None:
    """Between two HEARTBEATs of the Agent are three rounds and 48 ms."""
    assert tachk.measure(CAPTURES / "input_window.pcap").recorded_definitions()["AGENT_DELAY"] == 49
    assert "AGENT_DELAY" not in tachk.measure(CAPTURES / "two_publishers_losses.pcap").recorded_definitions()


@pytest.mark.parametrize(
    ("name", "law"),
    [
        ("client_2_0", 2),
        ("client_2_0_losses", 2),
        ("../second_read", None),  # one of two HEARTBEATs was overdue, and came 13 ms after something else
        ("two_publishers_losses", 1),
    ],
)
def test_old_clients_are_known_by_their_short_waits(name: str, law: int | None) -> None:
    assert tachk.measure(CAPTURES / f"{name}.pcap").recorded_definitions().get("HEARTBEAT_LAW") == law


def test_a_busy_machine_does_not_change_the_period_of_the_agent() -> None:
    """Its rounds come late, never early: some waits of 202 ms do not speak for more than 200."""
    assert tachk.measure(CAPTURES / "two_publishers_losses.pcap").quantity("agent_heartbeat").value in (None, 200)
    assert tachk.measure(CAPTURES / "input_window.pcap").quantity("agent_heartbeat").value == 200
