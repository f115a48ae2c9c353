"""Holds captures of a real client and Agent against the automata: which are runs, and with which tolerance.

    python bench/conformance.py CAPTURES_FOLDER [--model MODEL] [--only PREFIX] [--seconds 20] [-D NAME=VALUE]

Beside each FILE.pcap lies FILE.truth.json, of which this reads what no packet tells: the histories that the client was
made with, when the Agent was killed, and clients that ended without a word. A line for each capture: the answer,
the tolerance of the ladder with which it was found, states, seconds; of a refusal the place and what was allowed there.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import tachk
from tachk.engine.options import Limits
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import Conformance, conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.events import Closing, EventLog, RecordedEvent
from tachk.xrce.conformance.packet_events import read_capture

LADDER = ((5, 5), (5, 20), (5, 50))
"""Pairs of tolerance and lateness in milliseconds."""


def as_told(recording: EventLog, truth: dict[str, Any]) -> EventLog:
    """The recording with what no packet tells: when the Agent was killed, and clients that ended without a DELETE.

    What is sent to who is not there any more does not arrive. A client that has ended says no more.
    """
    ends = {2 * client: end for client, end in _ended(truth)}
    killed = min([a["t_wall_ns"] for a in truth.get("agent", []) if "KILL" in a["event"]], default=None)

    def arrives(event: RecordedEvent) -> bool:
        link = int(event.cells.get("link", 0))
        gone = killed if link % 2 == 0 else ends.get(link - 1)
        return event.name != "arrived" or gone is None or event.time + recording.epoch < gone

    kept = [event for event in recording.events if arrives(event)]
    order = {id(event): n for n, event in enumerate(kept)}
    changed = [
        event if event.after is None else replace(event, after=order[id(recording.events[event.after])])
        for event in kept
    ]
    closings = [
        Closing(column, value, Fraction(end - recording.epoch))
        for link, end in ends.items()
        for column, value in (("client", link // 2), ("link", link))
    ]
    return replace(recording, events=tuple(changed), closings=(*recording.closings, *closings))


def logs_of_clients(truth: dict[str, Any]) -> list[list[dict[str, Any]]]:
    """What the clients noted, those that write samples first, as recordings number them."""
    found: list[list[dict[str, Any]]] = [
        [entry for entry in log if "t_wall_ns" in entry] for log in truth.get("app_events", {}).values()
    ]
    found.sort(key=lambda log: log[0]["t_wall_ns"])
    return sorted(found, key=lambda log: all(entry["event"] != "write" for entry in log))


def _ended(truth: dict[str, Any]) -> Iterator[tuple[int, int]]:
    for client, log in enumerate(logs_of_clients(truth)):
        if all(entry["event"] != "session_deleted" for entry in log):
            yield from ((client, entry["t_wall_ns"]) for entry in log if entry["event"] == "exit")


def settings(truth: dict[str, Any]) -> dict[str, int]:
    """What the models of the automata have to be told: how clients were made, and what no packet shows.

    Jitter of 5 ms; the captures of kind h but h6 to h8 have a subscriber that does not listen for seconds.
    """
    history = max([node.get("history", 16) for node in truth["nodes"]])
    pauses = int(str(truth.get("scenario", ""))[:2] in ("h1", "h2", "h3", "h4", "h5"))
    return {
        "HISTORY": history,
        "INPUT_HISTORY": history,
        "CLIENT_JITTER": 5,
        "AGENT_JITTER": 5,
        "EXACT_BITMAPS": 1,
        "MISSED_ROUNDS": 1,
        "PAUSES": pauses,
    }


def held(
    model: tachk.Model, recording: EventLog, step: tuple[int, int], limits: Limits, explain: bool = False
) -> Conformance:
    """A recording held against a model, with a tolerance and a lateness."""
    assert model.loaded.recording is not None
    exact = TimestampUncertainty.of(Fraction(step[0]), Fraction(step[1]))
    names = constants_of(model.loaded)
    return conform(
        model.network, model.loaded.recording, recording, names, exact, limits=limits, run=False, explain=explain
    )


def ladder_of(text: str) -> tuple[tuple[int, int], ...]:
    """``5/5 10/20`` as tolerances with their latenesses."""
    steps = (step.split("/") for step in text.split())
    return tuple((int(tolerance), int(late)) for tolerance, late in steps)


def answers(
    model: tachk.Model, recording: EventLog, seconds: float, ladder: tuple[tuple[int, int], ...]
) -> Iterator[Conformance]:
    for number, step in enumerate(ladder, start=1):
        found = held(model, recording, step, Limits(seconds=seconds), explain=number == len(ladder))
        yield found
        if found.accepted:
            return


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--model", default="models/micro_xrce_dds/recorded.ta")
    parser.add_argument("--only", default="")
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("-D", dest="definitions", action="append", default=[])
    parser.add_argument("--ladder", default="")
    asked = parser.parse_args()
    ladder = ladder_of(asked.ladder) or LADDER
    for path in sorted(asked.folder.glob(f"{asked.only}*.pcap")):
        truth = json.loads(path.with_name(path.stem + ".truth.json").read_text(encoding="utf-8"))
        given = {name: int(value) for name, value in (pair.split("=") for pair in asked.definitions)}
        links = len(truth["nodes"])
        model = tachk.load(asked.model, **settings(truth) | given)
        if links != 2:
            print(f"{path.stem}: {links} clients", flush=True)
        started = time.process_time()
        recording = read_capture(path, ())
        recording = as_told(recording, truth)
        *_, found = answers(model, recording, asked.seconds, ladder)
        word = {True: "a run", False: "NO RUN", None: f"undecided ({found.reason})"}[found.accepted]
        used = time.process_time() - started
        print(
            f"{path.stem}: {word}, {found.tolerance}/{found.late} ms, {len(recording.events)} events, "
            f"{found.statistics.states_stored} states, {found.statistics.seconds:.2f} s, {used:.1f} s CPU in all",
            flush=True,
        )
        if found.refusal is not None and found.refusal.event is not None:
            event = recording.events[found.refusal.event]
            print(f"    at {event.place}: {event.name} {dict(event.cells)}; {found.refusal.state}")
            for offer in found.refusal.enabled_events[:4]:
                print(f"    allowed: {offer.text} {offer.earliest}..{offer.latest}")


if __name__ == "__main__":
    main()
