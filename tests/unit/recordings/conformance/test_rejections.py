"""What a model could do where a recording leaves it, also if its guards are disjunctions of many conjunctions."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import jsonschema
import pytest

import tachk
from tachk.engine.compiler.program import Program
from tachk.model.run import Transition
from tachk.recordings.conformance import conform as conformance
from tachk.recordings.conformance.conform import Conformance
from tachk.recordings.conformance.rejection import FinalState, end_by_reference, end_of
from tachk.recordings.conformance.trace_product import TraceProduct
from tachk.report.conformance.json import conformance_to_json
from tachk.report.conformance.text import conformance_to_text

ROOT = Path(__file__).parents[4]
SCHEMA = json.loads((ROOT / "docs/schema/conform.schema.json").read_text(encoding="utf-8"))

LISTENERS = """
const int N = 8;
typedef int[1, N] id_t;
clock x;
broadcast chan call, on;
process Caller() { state Idle, Called; init Idle; trans Idle -> Called { guard x >= 10; sync call!; }; }
process Listener(const id_t me) {
    clock y;
    state Waits, Heard;
    init Waits;
    trans Waits -> Heard { guard CLOCK >= 12 && CLOCK < 20 + me; sync call?; };
}
process Lamp() { state Off, On; init Off; trans Off -> On { sync on!; }; }
system Caller, Listener, Lamp;
recording { visible call as call(); visible on as on(); tolerance 1; }
"""
"""A step with `call` keeps listeners out, each by a disjunction."""


def refused(tmp_path: Path, clock: str, enabled_receivers: int) -> Conformance:
    file = tmp_path / "events.csv"
    file.write_text("time,event\n2,call\n30,on\n", encoding="utf-8")
    found = tachk.conform(tachk.loads(LISTENERS.replace("CLOCK", clock), N=enabled_receivers), file)
    assert found.accepted is False
    jsonschema.validate(conformance_to_json([found], "listeners.ta"), SCHEMA)
    return found


def test_disjunctions_over_one_clock_are_understood(tmp_path: Path) -> None:
    """Without pruning these are 3^7 conjunctions."""
    refusal = refused(tmp_path, "x", 7).refusal
    assert refusal is not None and refusal.enabled_complete
    assert ("call", 10) in [(enabled_event.name, enabled_event.earliest) for enabled_event in refusal.enabled_events]


def test_what_is_not_understood_is_reported(tmp_path: Path) -> None:
    """With a clock of each listener they are 2^40 zones."""
    found = refused(tmp_path, "y", 40)
    assert found.refusal is not None and not found.refusal.enabled_complete
    assert "there may be other events that the model allows" in conformance_to_text(found, "listeners.ta")


RESTED = """
const int REST = 500;
broadcast chan goes, comes;
process Heater() {
    clock rest = REST;
    init location Off {
        to On { guard rest >= REST; sync goes!; }
    }
    location On { to Off { sync comes!; assign rest = 0; } }
}
system Heater;
recording { visible goes as goes(); visible comes as comes(); tolerance 0; }
"""


def test_clocks_begin_with_their_initial_values(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "events.csv"
    file.write_text("time,event\n2,goes\n30,comes\n40,goes\n", encoding="utf-8")

    def both(
        product: TraceProduct, program: Program, path: Sequence[Transition], actions: Sequence[Sequence[int]]
    ) -> FinalState:
        end = end_of(product, program, path, actions)
        assert end.zones == end_by_reference(product, path).zones != ()
        return end

    monkeypatch.setattr(conformance, "end_of", both)
    refusal = tachk.conform(tachk.loads(RESTED), file).refusal
    assert refusal is not None and refusal.state == "Heater.Off"
    assert [(event.name, event.earliest) for event in refusal.enabled_events] == [("goes", 530)]
