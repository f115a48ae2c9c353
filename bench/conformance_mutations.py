"""Changes single events of captures that are runs, and counts how many of the changed ones are rejected.

    python -m bench.conformance_mutations CAPTURES_FOLDER [-D NAME=VALUE]... [--seed 1] [--only PREFIX] [--packets-only]

One event of each kind of change for each capture, drawn at random; each capture at the first step of the ladder 2/2,
5/5, 5/20, 5/50 ms at which it is a run unchanged, with the logs of the applications, or with packets only. What is
not rejected is listed: it has to be judged whether it is possible.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from random import Random

import tachk
from bench.application_logs import with_log
from bench.conformance import as_told, held, settings
from tachk.engine.options import Limits
from tachk.recordings.conformance.edits import Edit, edited
from tachk.recordings.conformance.events import EventLog, RecordedEvent
from tachk.xrce.conformance.packet_events import read_capture

LADDER = ((2, 2), (5, 5), (5, 20), (5, 50))
MILLISECOND = Fraction(1, 10**6)

Change = Callable[[EventLog, int], EventLog]


def _cell(name: str, change: Callable[[int], int]) -> Change:
    def changed(recording: EventLog, number: int) -> EventLog:
        event = recording.events[number]
        cells = {**event.cells, name: change(int(event.cells[name]))}
        events = (*recording.events[:number], replace(event, cells=cells), *recording.events[number + 1 :])
        return replace(recording, events=events)

    return changed


def _edit(what: str, by: int = 0) -> Change:
    return lambda recording, number: edited(recording, Edit(number, what, by), MILLISECOND)


def _gone(recording: EventLog, number: int) -> EventLog:
    """Without a message and its arrivals."""
    numbers = [n for n, event in enumerate(recording.events) if n == number or event.after == number]
    for n in reversed(numbers):
        recording = edited(recording, Edit(n, "lost"), MILLISECOND)
    return recording


def _is(kind: str) -> Callable[[RecordedEvent], bool]:
    return lambda event: event.name == "sent" and event.cells.get("kind") == kind


CHANGES: dict[str, tuple[Callable[[RecordedEvent], bool], Change]] = {
    "message missing": (_is("DATA"), _gone),
    "HEARTBEAT missing": (_is("HEARTBEAT"), _gone),
    "HEARTBEAT number + 1": (_is("HEARTBEAT"), _cell("number", lambda n: n + 1)),
    "HEARTBEAT 35 ms early": (_is("HEARTBEAT"), _edit("moved", -35)),
    "ACKNACK missing": (_is("ACKNACK"), _gone),
    "ACKNACK number + 1": (_is("ACKNACK"), _cell("number", lambda n: n + 1)),
    "ACKNACK bitmap flipped": (_is("ACKNACK"), _cell("detail", lambda n: n ^ 1)),
    "message sent twice": (_is("DATA"), _edit("doubled")),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--model", default="models/micro_xrce_dds/recorded.ta")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--packets-only", action="store_true")
    parser.add_argument("--states", type=int, default=400_000)
    parser.add_argument("-D", dest="definitions", action="append", default=[])
    asked = parser.parse_args()
    random, counts = Random(asked.seed), Counter[tuple[str, str]]()
    for path in sorted(asked.folder.glob(f"{asked.only}*.pcap")):
        truth = json.loads(path.with_name(path.stem + ".truth.json").read_text(encoding="utf-8"))
        given = {name: int(value) for name, value in (pair.split("=") for pair in asked.definitions)}
        logged = {} if asked.packets_only else {"PAUSES": 0}
        model = tachk.load(asked.model, **settings(truth) | logged | given)
        recording = as_told(read_capture(path), truth)
        if not asked.packets_only:
            recording = with_log(recording, truth)

        def accepted(other: EventLog, step: tuple[int, int], model: tachk.Model = model) -> bool | None:
            return held(model, other, step, Limits(seconds=30, states=asked.states)).accepted

        step = next((step for step in LADDER if accepted(recording, step)), None)
        if step is None:
            continue
        for name, (fits, change) in CHANGES.items():
            places = [n for n, event in enumerate(recording.events) if fits(event)]
            if not places:
                continue
            number = random.choice(places)
            answer = {True: "accepted", False: "rejected", None: "undecided"}[accepted(change(recording, number), step)]
            counts[name, answer] += 1
            if answer != "rejected":
                where = f"{recording.events[number].place} on link {recording.events[number].cells['link']}"
                print(f"{path.stem}, {step[0]}/{step[1]} ms: {name}, {where}: {answer}", flush=True)
    for name in CHANGES:
        print(name, {answer: counts[name, answer] for answer in ("rejected", "accepted", "undecided")}, flush=True)


if __name__ == "__main__":
    main()
