"""How many packets a second `tachk conform` holds against a model, with the run that is made and judged.

    python -m bench.conformance_speed CAPTURE.pcap... [--model MODEL] [--rounds 3] [-D NAME=VALUE]

For each capture: its packets (messages of DDS-XRCE that left their sender), how many packets it has of them (two for
each where both sides of a relay were recorded), and events; CPU seconds for reading the capture and for holding it
against the model, the least of some rounds after one that is not counted, of which the search and what makes and judges
the run take their parts; and packets a second, without and with reading the capture. `--shorter` also takes the first
half, quarter and eighth of each capture, which shows how the cost grows.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import tachk
from tachk.base.cycles import collect_rarely
from tachk.cli.arguments import parse_definitions
from tachk.formats.loading.recorded_models import recorded_model
from tachk.recordings.conformance.conform import Conformance, conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.events import EventLog
from tachk.xrce.conformance.packet_events import read_capture

T = TypeVar("T")


def least(rounds: int, work: Callable[[], T]) -> tuple[float, T]:
    """CPU seconds of the fastest round, the first one not counted, and what it gave."""
    found = work()
    seconds = []
    for _ in range(rounds):
        start = time.process_time()
        found = work()
        seconds.append(time.process_time() - start)
    return min(seconds), found


def shortened(recording: EventLog, share: int) -> EventLog:
    """The first part of a recording; what happens behind it has not been recorded."""
    kept = recording.events[: len(recording.events) // share]
    closings = tuple(c for c in recording.closings if c.time <= kept[-1].time)
    return replace(recording, events=kept, end=kept[-1].time, closings=closings)


def measure(model: tachk.Model, path: Path, rounds: int, shares: tuple[int, ...]) -> None:
    reading, whole = least(rounds, lambda: read_capture(path))
    for share in shares:
        recording = shortened(whole, share)
        packets = sum(event.name == "sent" for event in recording.events)
        recorded = max(int(event.place.removeprefix("packet ")) for event in recording.events)

        def held(run: bool, recording: EventLog = recording) -> Conformance:
            assert model.loaded.recording is not None
            return conform(model.network, model.loaded.recording, recording, constants_of(model.loaded), run=run)

        without, _ = least(rounds, lambda: held(False))
        seconds, found = least(rounds, lambda: held(True))
        read = reading / share
        print(
            f"{path.name}{'' if share == 1 else f' 1/{share}'}: {packets} packets, recorded {recorded} times, "
            f"{len(recording.events)} events, "
            f"accepted {found.accepted}, {sum(len(run.path) for run in found.runs)} transitions; "
            f"reading {read:.2f} s, conform {seconds:.2f} s (searches {found.statistics.user_seconds:.2f} s, making "
            f"and judging the run {seconds - without:.2f} s): {packets / seconds:,.0f} packets/s, with reading "
            f"{packets / (seconds + read):,.0f}"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("captures", nargs="+", type=Path)
    parser.add_argument("--model", default="models/micro_xrce_dds/client_3_0.ta")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--shorter", action="store_true")
    parser.add_argument("-D", dest="definitions", action="append", default=[], metavar="NAME=VALUE")
    given = parser.parse_args()
    collect_rarely()
    model = tachk.load(given.model, **parse_definitions(given.definitions))
    loaded = recorded_model(model.loaded, model.path, model.definitions)
    model = tachk.Model(loaded, model.path, model.definitions)
    for path in given.captures:
        measure(model, path, given.rounds, (1, 2, 4, 8) if given.shorter else (1,))


if __name__ == "__main__":
    main()
