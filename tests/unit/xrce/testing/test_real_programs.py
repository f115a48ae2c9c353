"""Clients and Agents that speak real packets by UDP are tested by models, as real ones are."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.engine.options import Limits
from tachk.simulation.testing.tested_model import TestRequest, run_test_of_model
from tachk.simulation.testing.tester import TestResult, TestVerdict

HERE = Path(__file__).parent


def outcome_of(
    adapter: str, seconds: float = 0.5, late: str | None = None, name: str = "small_client.ta"
) -> TestResult:
    model = tachk.load(HERE / name)
    request = TestRequest(adapter, f"{seconds}s", pause="10ms", late=late)
    return run_test_of_model(model.loaded, model.path, request, Limits())[0]


def client(*words: str) -> str:
    return " ".join([f"xrce:client:{sys.executable}", str(HERE / "scripted.py"), "{port}", *words])


def test_client_that_is_as_modelled_passes() -> None:
    result = outcome_of(client(), 2)
    assert result.verdict is TestVerdict.PASS
    assert {event.name for event in result.recording.events} == {"write", "sent", "arrived"}
    assert {event.cells.get("number") for event in result.recording.events} >= {0, 1}, "they count from the set-up on"


def test_client_that_repeats_twice_fails() -> None:
    result = outcome_of(client("twice"), 30, "1s")
    assert result.verdict is TestVerdict.FAIL
    assert result.conformance is not None and result.conformance.refusal is not None
    event = result.conformance.refusal.event
    assert event is not None and result.recording.events[event].name == "sent"


def agent(*words: str) -> str:
    return " ".join([sys.executable, str(HERE / "fake_agent.py"), "{port}", *words])


def test_agent_that_is_as_modelled_passes() -> None:
    result = outcome_of(f"xrce:agent:{agent()}", 1, name="small_agent.ta")
    assert result.verdict is TestVerdict.PASS
    assert {(event.name, event.cells["number"]) for event in result.recording.events} >= {("arrived", 0), ("sent", 1)}


def test_agent_that_confirms_no_more_fails() -> None:
    result = outcome_of(f"xrce:agent:{agent('forgetful')}", 30, "1s", "small_agent.ta")
    assert result.verdict is TestVerdict.FAIL
    assert sum(event.name == "sent" for event in result.recording.events) >= 4


def test_network_between_a_client_and_an_agent() -> None:
    """What is not delivered is lost; what is delivered is the very packet."""
    commands = f"{agent()} -- {client().removeprefix('xrce:client:')}"
    result = outcome_of(f"xrce:relay:{commands}", 3, name="small_relay.ta")
    assert result.verdict is TestVerdict.PASS
    links = [(event.name, event.cells.get("link")) for event in result.recording.events]
    assert links.count(("sent", 0)) >= links.count(("arrived", 0)) > 0
    assert links.count(("sent", 1)) >= links.count(("arrived", 1)) > 0
    result = outcome_of(f"xrce:relay:{commands.replace(' -- ', ' forgetful -- ')}", 30, "1s", "small_relay.ta")
    assert result.verdict is TestVerdict.FAIL


def test_adapters_that_are_none() -> None:
    with pytest.raises(UsageError, match="does not say where the port of the test goes"):
        outcome_of("xrce:client:./client 8888")
    with pytest.raises(UsageError, match="`xrce:clients:x` names no system"):
        outcome_of("xrce:clients:x")
    with pytest.raises(UsageError, match="are not two commands"):
        outcome_of("xrce:relay:./agent {port}")
    with pytest.raises(UsageError, match="which is no message to this program"):
        outcome_of(f"xrce:agent:{agent()}")
    with pytest.raises(UsageError, match="did not write"):
        outcome_of(f"xrce:client:{sys.executable} -c pass {{port}}")
    ready = "print(chr(123)+chr(34)+'event'+chr(34)+':'+chr(34)+'ready'+chr(34)+chr(125),flush=True);input()"
    with pytest.raises(UsageError, match="has created nothing at port"):
        outcome_of(f'xrce:client:{sys.executable} -c "{ready}" {{port}}')
