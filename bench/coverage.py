"""Which edges of the automata real captures exercise, each with the settings that are measured in it.

    python -m bench.coverage FOLDER... [--model MODEL] [--seconds 10] [--ladder "5/5 10/20"] [-o coverage.json]

Every FILE.pcap of the folders is held against the model with the first tolerance of a ladder that fits; where
FILE.truth.json says when the Agent was killed, what is sent to it then does not arrive. Prints a table: each edge, how
often it is taken, in how many captures, and one of them; `tachk draw MODEL --coverage coverage.json` draws it.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter, defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import tachk
from bench.conformance import as_told, held, ladder_of
from tachk.engine.options import Limits
from tachk.formats.loading.recorded_models import recorded_model
from tachk.recordings.conformance.conform import Conformance
from tachk.recordings.conformance.coverage import Covered, coverage
from tachk.report.conformance.json import conformance_to_json
from tachk.xrce.conformance.packet_events import read_capture

ROOT = Path(__file__).resolve().parents[1]
LADDER = ((5, 5), (10, 20), (5, 150))


def accepted(model: tachk.Model, path: Path, seconds: float, ladder: Sequence[tuple[int, int]]) -> Conformance | None:
    """The run that a capture shows, with the first tolerance and lateness with which one is found."""
    recording = read_capture(path, ())
    truth = path.with_name(path.stem + ".truth.json")
    if truth.exists():
        recording = as_told(recording, json.loads(truth.read_text(encoding="utf-8")))
    for step in ladder:
        found = held(model, recording, step, Limits(seconds=seconds))
        if found.accepted:
            print(f"{path.stem}: {step[0]}/{step[1]} ms, {found.statistics.states_stored} states", flush=True)
            return found
    print(f"{path.stem}: no run was found; {found.reason}", flush=True)
    return None


def edge_of(each: Covered, occurrence: int) -> tuple[str, str, str, int, str]:
    return each.template, each.source, each.target, occurrence, each.doc


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--model", default=str(ROOT / "models/micro_xrce_dds/recorded.ta"))
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--ladder", default="")
    parser.add_argument("-o", dest="output", type=Path)
    asked = parser.parse_args()
    ladder = ladder_of(asked.ladder) or LADDER
    constants = {name for name, _ in tachk.load(asked.model).network.constants}
    taken: Counter[tuple[str, str, str, int, str]] = Counter()
    by: dict[tuple[str, str, str, int, str], list[str]] = defaultdict(list)
    answers: list[dict[str, Any]] = []
    for path in (path for folder in asked.folders for path in sorted(folder.glob("*.pcap"))):
        measured = tachk.measure(path).recorded_definitions(1)
        asking = tachk.load(asked.model, **{name: value for name, value in measured.items() if name in constants})
        model = tachk.Model(recorded_model(asking.loaded, asked.model, asking.definitions), asked.model)
        try:
            found = accepted(model, path, asked.seconds, ladder)
        except tachk.TachkError as error:
            print(f"{path.stem}: {error}", flush=True)
            continue
        if found is None:
            continue
        answers += conformance_to_json([found], asked.model)["answers"]
        seen: Counter[tuple[str, str, str]] = Counter()
        often: Counter[tuple[str, str, str, int, str]] = Counter()
        for each in coverage(model.network, [found]):
            ends = each.process, each.source, each.target
            often[edge_of(each, seen[ends])] += each.times
            seen[ends] += 1
        for edge, times in often.items():
            taken[edge] += times
            if times:
                by[edge].append(path.stem)
    table(taken, by)
    if asked.output is not None:
        rows = [
            {"process": template, "template": template, "source": source, "target": target, "doc": doc, "times": times}
            for (template, source, target, _, doc), times in taken.items()
        ]
        document = {"model": asked.model, "answers": answers, "coverage": rows}
        asked.output.write_text(json.dumps(document, indent=1), encoding="utf-8")


def table(taken: Counter[tuple[str, str, str, int, str]], by: dict[tuple[str, str, str, int, str], list[str]]) -> None:
    print("\n| automaton | edge | what | taken | captures | such as |\n|---|---|---|---|---|---|")
    for edge, times in sorted(taken.items()):
        template, source, target, _, doc = edge
        name = by[edge][0] if by[edge] else ""
        print(f"| {template} | {source} → {target} | {doc} | {times} | {len(by[edge])} | {name} |")
    for template in sorted({edge[0] for edge in taken}):
        own = [edge for edge in taken if edge[0] == template]
        print(f"{template}: {sum(taken[edge] > 0 for edge in own)} of {len(own)}")


if __name__ == "__main__":
    main()
