"""Recordings that end with what their sender does itself, such as the DELETE of a session."""

from __future__ import annotations

from fractions import Fraction

import pytest

import tachk
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.events import Closing, EventLog, RecordedEvent

MODEL = """
time_unit = 1 ms;
broadcast chan out;

process Twice() {
    clock x;

    init location begin {
        invariant x <= 10;
        to between { guard x >= 5; sync out!; }
    }

    committed location between {
        to end { sync out!; assign x = 0; }
    }

    location end {
        invariant x <= 1;
        to end { sync out!; assign x = 0; }
    }
}

system Twice;

recording { visible out as sent(link = 0); tolerance 2 ms; }
"""


@pytest.mark.parametrize(
    ("messages", "by_sender", "expected"),
    [
        (2, True, True),
        (1, True, False),  # it would have been recorded before the end
        (1, False, True),  # somebody else ends the recording, so it may be late
        (0, True, True),  # it has time until 10, and what happens behind 8 may be recorded behind the end
        (3, True, True),
    ],
)
def test_what_a_sender_does_at_once_is_recorded_before_the_end(messages: int, by_sender: bool, expected: bool) -> None:
    """After the second message there is time for the end."""
    model = tachk.loads(MODEL)
    assert model.loaded.recording is not None
    sent = tuple(RecordedEvent(Fraction(9), "sent", {"link": 0}, f"line {n}") for n in range(messages))
    closings = (Closing("link", 0, Fraction(10), by_sender),)
    recording = EventLog("run.csv", sent, None, Fraction(0), Fraction(30), closings)
    found = conform(model.network, model.loaded.recording, recording, constants_of(model.loaded))
    assert found.accepted is expected


WAITED_FOR = """
time_unit = 1 ms;
chan press;

process Lamp() {
    clock x;
    init location off { invariant x <= 10; to on { sync press?; } }
    location on { }
}

process User() { init location u { to u { sync press!; } } }

system Lamp, User;

recording { replaces User; visible press as press(); }
"""


@pytest.mark.parametrize(("end", "late", "expected"), [(12, 0, True), (13, 0, True), (14, 0, False), (14, 4, True)])
def test_an_input_may_be_recorded_behind_the_end(end: int, late: int, expected: bool) -> None:
    """With a tolerance of 3 ms an input that happens at 10 may be recorded at 13, whatever the lateness of outputs."""
    model = tachk.loads(WAITED_FOR)
    assert model.loaded.recording is not None
    recording = EventLog("run.csv", (), None, Fraction(0), Fraction(end))
    uncertainty = TimestampUncertainty.of(Fraction(3), Fraction(late))
    found = conform(model.network, model.loaded.recording, recording, constants_of(model.loaded), uncertainty)
    assert found.accepted is expected
