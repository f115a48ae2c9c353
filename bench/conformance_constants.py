"""Holds captures of a real client and Agent against automata with wrong constants: each has to be refused.

    python -m bench.conformance_constants CAPTURES_FOLDER

Each capture at the first step of the ladder 5/5, 5/20, 5/50 ms at which it is a run with the true constants.
"""

from __future__ import annotations

import argparse
import json
from fractions import Fraction
from pathlib import Path

import tachk
from bench.conformance import LADDER, as_told, settings
from tachk.engine.options import Limits
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import Conformance, conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.xrce.conformance.packet_events import read_capture

WRONG: dict[str, tuple[dict[str, int], tuple[str, ...]]] = {
    "steady heartbeat": ({"HEARTBEAT_LAW": 0}, ("i1", "i2")),
    "doubling from 1 ms": ({"HEARTBEAT_LAW": 2, "CLIENT_HEARTBEAT": 1, "LOSSES": 12}, ("c1", "c3")),
    "client heartbeat 110 ms": ({"CLIENT_HEARTBEAT": 110}, ("d1", "d2", "e1", "g1")),
    "client heartbeat 90 ms": ({"CLIENT_HEARTBEAT": 90}, ("d1", "d2", "e1", "g1")),
    "selective repeat": ({"GO_BACK": 0}, ("c2", "c4")),
    "guarded ACKNACK": (
        {"GUARDED": 1},
        ("f3a", "f3b", "f5_reorder_loss10_seed28", "f5_reorder_loss10_seed36", "f5_reorder_loss10_seed92", "f6a"),
    ),
    "Agent heartbeat 250 ms": ({"AGENT_HEARTBEAT": 250}, ("d4", "h6")),
    "ACKNACK for HEARTBEATs only": ({"ANSWER_DATA": 0}, ("a1", "c1")),
    "dead time 60 s": ({"DEAD": 60000}, ("h6", "h8")),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--model", default="models/micro_xrce_dds/recorded.ta")
    asked = parser.parse_args()
    for name, (wrong, captures) in WRONG.items():
        for prefix in captures:
            (path,) = sorted(asked.folder.glob(f"{prefix}*.pcap"))
            print(f"{name}, {path.stem}: {_answers(asked.model, path, wrong)}", flush=True)


def _answers(name: str, path: Path, wrong: dict[str, int]) -> str:
    truth = json.loads(path.with_name(path.stem + ".truth.json").read_text(encoding="utf-8"))
    recording = read_capture(path)
    recording = as_told(recording, truth)

    def ask(constants: dict[str, int], step: tuple[int, int], explain: bool) -> Conformance:
        model = tachk.load(name, **settings(truth) | constants)
        mapping = model.loaded.recording
        assert mapping is not None
        exact, limits = TimestampUncertainty.of(Fraction(step[0]), Fraction(step[1])), Limits(seconds=20)
        names = constants_of(model.loaded)
        return conform(model.network, mapping, recording, names, exact, limits=limits, run=False, explain=explain)

    step = next((step for step in LADDER if ask({}, step, False).accepted), None)
    if step is None:
        return "no run with the true constants"
    found = ask(wrong, step, True)
    word = {True: "a run", False: "refused", None: f"undecided ({found.reason})"}[found.accepted]
    place = ""
    if found.refusal is not None and found.refusal.event is not None:
        event = recording.events[found.refusal.event]
        place = f" at {event.place}, {event.name} {dict(event.cells)}"
    return f"{word} at {step[0]}/{step[1]} ms{place}"


if __name__ == "__main__":
    main()
