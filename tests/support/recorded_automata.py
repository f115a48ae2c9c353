"""Captures of the real client and Agent, held against the automata that take recordings."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import tachk
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.events import EventLog
from tachk.xrce.conformance.packet_events import read_capture

ROOT = Path(__file__).parents[2]
CAPTURES = ROOT / "tests/data/captures/unusual"
MODEL = ROOT / "models/micro_xrce_dds/recorded.ta"
MILLISECOND = Fraction(1, 10**6)
SETTINGS = {
    "MESSAGES": 64,
    "EXACT_BITMAPS": True,
    "CLIENT_JITTER": 5,
    "AGENT_JITTER": 5,
    "MISSED_ROUNDS": 1,
    "BEST_EFFORT_STREAMS": True,
    "READER_DELAY": 5,
    "SMALLEST_WORD": -(2**27),
}


def capture(name: str) -> EventLog:
    return read_capture(CAPTURES / f"{name}.pcap")


def is_run_of(recording: EventLog, late: int, states: int, **constants: int) -> bool | None:
    """True if the recording is a run of the automata with these constants; None where the limit was hit first.

    Args:
        late: in milliseconds; times are inexact by 5 ms.
        states: that a search stores at most.
    """
    model = tachk.load(MODEL, **SETTINGS | constants)
    assert model.loaded.recording is not None
    return conform(
        model.network,
        model.loaded.recording,
        recording,
        constants_of(model.loaded),
        TimestampUncertainty.of(Fraction(5), Fraction(late)),
        limits=tachk.Limits(states=states),
        run=False,
        explain=False,
    ).accepted
