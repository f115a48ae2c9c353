"""Rounds that repeat themselves in charts of captures."""

from __future__ import annotations

from fractions import Fraction

from tachk.report.drawing.sequence.chart import Chart, Message, Moment, Note
from tachk.report.sequence.repetitions import shown_once


def message(time: int, label: str) -> Message:
    return Message(0, (1,), Moment(Fraction(time)), (Moment(Fraction(time + 1)),), label, tag=str(time))


def told(*messages: Message) -> list[str]:
    chart = shown_once(Chart("t", "d", "ms", ("a", "b"), messages))
    return [event.text if isinstance(event, Note) else event.label for event in chart.events]


def test_rounds_of_two_messages_are_reported_once():
    rounds = [message(100 * n + more, label) for n in range(1, 9) for more, label in ((0, "HEARTBEAT"), (9, "ACKNACK"))]
    assert told(message(5, "DATA"), *rounds, message(2000, "DATA")) == [
        "DATA",
        "HEARTBEAT",
        "ACKNACK",
        "↻ 6 times, every 100 ms, packets 200 to 709",
        "HEARTBEAT",
        "ACKNACK",
        "DATA",
    ]


def test_few_rounds_are_drawn():
    assert told(*(message(100 * n, "HEARTBEAT") for n in range(5))) == ["HEARTBEAT"] * 5
    assert len(told(*(message(100 * n, f"DATA {n}") for n in range(30)))) == 30
