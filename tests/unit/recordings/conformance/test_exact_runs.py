"""The run that shows that a recording is one: made and judged by the core, and by the reference."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

import tachk
from tachk.engine.compiler.program import Program
from tachk.engine.exact.exact_run import Moments
from tachk.model.run import Transition
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.model.types import ClockType
from tachk.recordings.conformance import conform as conformance
from tachk.recordings.conformance import conform as exact_runs
from tachk.recordings.conformance.conform import Conformance, conform, moments_of_trace, run_by_reference
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.rejection import FinalState, end_by_reference, end_of
from tachk.recordings.conformance.trace_product import TraceProduct
from tachk.xrce.conformance.packet_events import read_capture

ROOT = Path(__file__).parents[4]
CAPTURES = ROOT / "tests/data/captures/later"


def held(name: str) -> Conformance:
    words = json.loads((CAPTURES / f"{name}.json").read_text(encoding="utf-8"))["settings"].split()
    given = {key: json.loads(value) for key, value in (word.split("=") for word in words if "=" in word)}
    model = tachk.load(ROOT / "models/micro_xrce_dds/recorded.ta", **given)
    assert model.loaded.recording is not None
    recording = read_capture(CAPTURES / f"{name}.pcap")
    exact = TimestampUncertainty.of(Fraction(5), Fraction(5))
    return conform(model.network, model.loaded.recording, recording, constants_of(model.loaded), exact)


def test_core_and_reference_make_the_same_run_of_a_capture(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exact_runs, "LONGEST_BY_REFERENCE", 0)
    found = held("client_2_0")
    assert found.accepted
    for run in found.runs:
        assert run.moments == moments_of_trace(run_by_reference(run.product, run.path), len(run.path))


def test_long_run_is_not_made_by_the_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exact_runs, "LONGEST_BY_REFERENCE", 0)
    monkeypatch.setattr(exact_runs, "run_by_reference", None)
    assert held("client_2_0").runs


def test_reference_judges_what_the_core_cannot(monkeypatch: pytest.MonkeyPatch) -> None:
    dimmer = ROOT / "examples/dimmer/dimmer.ta", ROOT / "examples/dimmer/pressed.csv"
    expected = [run.moments for run in tachk.conform(*dimmer).runs]
    monkeypatch.setattr(exact_runs, "exact_run", lambda *_: (None, "there are priorities"))
    assert [run.moments for run in tachk.conform(*dimmer).runs] == expected


def test_moments_are_in_units_of_time() -> None:
    assert Moments((3, 5), 2)[1] == Fraction(5, 2)
    assert replace(Moments((3, 5), 2), unit=1)[0] == 3


def test_core_and_reference_end_a_run_in_the_same_state(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the recording of a changed capture leaves the model."""
    found: list[tuple[FinalState, FinalState]] = []

    def both(
        product: TraceProduct, program: Program, path: Sequence[Transition], actions: Sequence[Sequence[int]]
    ) -> FinalState:
        end = end_of(product, program, path, actions)
        found.append((end, end_by_reference(product, path)))
        return end

    monkeypatch.setattr(conformance, "end_of", both)
    model = tachk.load(ROOT / "models/micro_xrce_dds/recorded.ta")
    assert model.loaded.recording is not None
    recording = read_capture(CAPTURES / "client_2_0.pcap")
    refused = conform(model.network, model.loaded.recording, recording, constants_of(model.loaded))
    assert refused.accepted is False
    for core, reference in found:
        assert core.locations == reference.locations
        assert core.zones == reference.zones
        clocks = {variable for variable in core.values if isinstance(variable.type, ClockType)}
        assert all(core.values[v] == reference.values[v] for v in core.values.keys() - clocks)
    assert found
