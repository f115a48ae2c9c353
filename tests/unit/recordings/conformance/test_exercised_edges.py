"""Captures that were made to exercise edges of the automata that no other capture takes.

They were runs of the model at once; nothing of it is fitted to them.
"""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import tachk
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import Conformance, conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.coverage import Covered, coverage
from tachk.xrce.conformance.packet_events import read_capture

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).parents[4]
CAPTURES = ROOT / "tests/data/captures/later"
MODEL = ROOT / "models/micro_xrce_dds/recorded.ta"


def settings(name: str) -> dict[str, Any]:
    words = json.loads((CAPTURES / f"{name}.json").read_text(encoding="utf-8"))["settings"].split()
    given = dict(word.split("=") for word in words if "=" in word)
    return {key: value == "true" if value in ("true", "false") else int(value) for key, value in given.items()}


def held(name: str, late: int = 5, **others: object) -> tuple[tachk.Model, Conformance]:
    model = tachk.load(MODEL, **settings(name) | others)
    assert model.loaded.recording is not None
    found = conform(
        model.network,
        model.loaded.recording,
        read_capture(CAPTURES / f"{name}.pcap"),
        constants_of(model.loaded),
        TimestampUncertainty.of(Fraction(5), Fraction(late)),
        limits=tachk.Limits(states=100_000),
        explain=False,
    )
    return model, found


def taken(name: str, late: int = 5, **others: object) -> list[tuple[str, str, str, int]]:
    """The edges that the run takes: template, locations, and which one of those between them."""
    model, found = held(name, late, **others)
    assert found.accepted is True
    edges: list[tuple[str, str, str, int]] = []
    before: list[Covered] = []
    for each in coverage(model.network, [found]):
        ends = (each.process, each.source, each.target)
        occurrence = sum((e.process, e.source, e.target) == ends for e in before)
        before.append(each)
        if each.times:
            edges.append((each.template, each.source, each.target, occurrence))
    return edges


@pytest.mark.parametrize(
    ("name", "edges"),
    [
        (
            "best_effort_losses",
            [("BestEffortPublisher", "Writing", "Ready", 0), ("ProxySubscriber", "Pushing", "Pushing", 3)],
        ),
        ("best_effort_overtaken", [("BestEffortProxy", "Delivering", "Waiting", 0)]),
        ("best_effort_batches", [("BestEffortProxy", "Delivering", "Delivering", 0)]),
        ("best_effort_mixed", [("ProxySubscriber", "Pushing", "Pushing", 3)]),
        ("quiet_topic", [("Agent", "FirstRound", "Dead", 0), ("Agent", "Dead", "FirstRound", 0)]),
        ("created_again_dead", [("Agent", "Dead", "Quiet", 0)]),
        ("window_opens", [("ProxySubscriber", "Repairing", "Pushing", 0)]),
        ("heartbeats_wait", [("AgentSocket", "overtaken", "empty", 0), ("AgentSocket", "held", "overtaken", 0)]),
        ("heartbeat_behind_data", [("AgentSocket", "held", "held", 1), ("AgentSocket", "overtaken", "arrived", 0)]),
        (
            "own_heartbeat_waits",
            [("AgentSocket", "reading", "reading", 1), ("AgentSocket", "released", "overtaken", 0)],
        ),
    ],
)
def test_an_edge_is_exercised(name: str, edges: list[tuple[str, str, str, int]]) -> None:
    assert set(edges) <= set(taken(name))


@pytest.mark.parametrize("name", ["heartbeats_wait", "heartbeat_behind_data", "own_heartbeat_waits"])
def test_only_a_stopped_thread_explains_it(name: str) -> None:
    assert held(name, READER_STOP=0)[1].accepted is False


def test_only_a_dead_client_explains_the_silence() -> None:
    """A sample is lost to a client that was silent for more than 30 s, and no HEARTBEAT follows."""
    assert held("quiet_topic", DEAD=40_000)[1].accepted is False


def test_the_reading_thread_goes_on_in_a_step_of_its_own() -> None:
    edges = set(taken("window_opens", READER_DELAY=5))
    assert {("ProxySubscriber", "Repairing", "Waking", 0), ("ReadingThread", "Woken", "Waiting", 0)} <= edges


def test_a_client_is_found_dead_in_the_round_of_another_one() -> None:
    """The machine was busy: the HEARTBEAT of one of the rounds comes 16 ms late."""
    assert ("Agent", "Rounds", "Dead", 1) in taken("dead_in_a_round", late=20)
