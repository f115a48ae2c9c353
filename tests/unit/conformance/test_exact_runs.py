"""The run that shows that a recording is one: made and judged by the core, and by the reference."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

import tachk
from tachk.conformance import exact_runs
from tachk.conformance.asking import constants_of
from tachk.conformance.conform import Conformance, conform
from tachk.conformance.exact_runs import moments_of_trace, run_by_reference
from tachk.conformance.packet_events import read_capture
from tachk.engines.exact.exact_run import Moments

ROOT = Path(__file__).parents[3]
CAPTURES = ROOT / "tests/data/captures/later"


def held(name: str) -> Conformance:
    words = json.loads((CAPTURES / f"{name}.json").read_text(encoding="utf-8"))["settings"].split()
    given = {key: json.loads(value) for key, value in (word.split("=") for word in words if "=" in word)}
    model = tachk.load(ROOT / "models/micro_xrce_dds/recorded.ta", **given)
    assert model.loaded.recording is not None
    recording = read_capture(CAPTURES / f"{name}.pcap")
    exact = Fraction(5), Fraction(5)
    return conform(model.network, model.loaded.recording, recording, constants_of(model.loaded), *exact)


def test_core_and_reference_make_the_same_run_of_a_capture(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exact_runs, "SHORT", 0)
    found = held("client_2_0")
    assert found.accepted
    for run in found.runs:
        assert run.moments == moments_of_trace(run_by_reference(run.following, run.path), len(run.path))


def test_long_run_is_not_made_by_the_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(exact_runs, "SHORT", 0)
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
