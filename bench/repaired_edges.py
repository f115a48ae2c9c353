"""Deletes each edge of the five automata that captures exercise, and looks at what `tachk conform --repair` proposes.

    python -m bench.repaired_edges FOLDER... [--only TEMPLATE] [--seconds 120] [-o FILE.json]

The captures are those of the folders that are runs of `client_3_0.ta` with its own settings at 5/50 ms. For each edge,
three of those that take it, the shortest ones, are given, and two that do not. An edge is found if one of the first
three proposals is the deleted edge, or behaves like it: the model with it gives the answers of the whole model to all
captures that take the edge (ten at most) and to changed ones (an event lost, doubled or 150 ms later: 24 of them).
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import tachk
from tachk.base.job import limited
from tachk.base.records import replace
from tachk.engine.options import Limits
from tachk.formats.loading.recorded_models import recorded_model
from tachk.frontend.loaded import LoadedModel
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.edits import Edit, edited
from tachk.recordings.conformance.events import EventLog
from tachk.syntax import ast
from tachk.verify.repair.extended_model import extended_model
from tachk.verify.repair.proposals import ProposedEdge, edge_text
from tachk.verify.repair.repair import repair
from tachk.verify.repair.vocabulary import placed_edges
from tachk.xrce.conformance.packet_events import read_capture

ROOT = Path(__file__).resolve().parents[1]
MODEL = ROOT / "models/micro_xrce_dds/client_3_0.ta"
AUTOMATA = ("ClientPublisher", "ClientSubscriber", "Agent", "ProxyPublisher", "ProxySubscriber")
UNCERTAINTY = TimestampUncertainty.of(Fraction(5), Fraction(50))
LIMITS = Limits(states=100_000, seconds=20)


@dataclass
class Capture:
    name: str
    events: EventLog
    taken: set[tuple[int, str]]  # the edges that its run takes, by their places in the text


def answer(loaded: LoadedModel, proposal: ProposedEdge | None, recording: EventLog) -> bool | None:
    model = extended_model(loaded, () if proposal is None else (proposal,))
    network, mapping, constants = model.network, model.mapping, constants_of(loaded)
    found = conform(network, mapping, recording, constants, UNCERTAINTY, limits=LIMITS, run=False, explain=False)
    return found.accepted


def captures(loaded: LoadedModel, folders: Sequence[Path]) -> Iterator[Capture]:
    """Those that are runs of the model as it is."""
    model = extended_model(loaded, ())
    for path in (path for folder in folders for path in sorted(folder.glob("*.pcap"))):
        try:
            events = read_capture(path, ())
            found = conform(
                model.network, model.mapping, events, constants_of(loaded), UNCERTAINTY, limits=LIMITS, run=False
            )
        except tachk.TachkError:
            continue
        if found.accepted:
            edges: Counter[tuple[int, str]] = Counter()
            for run in found.runs:
                for transition in map(run.product.lift_transition, run.path):
                    for taking in () if transition is None else transition.participants:
                        process = model.network.processes[taking.process]
                        edges[process.edges[taking.edge].spans[0].start, process.template] += 1
            yield Capture(path.stem, events, set(edges))


def without(loaded: LoadedModel, template: str, edge: ast.EdgeDeclaration) -> LoadedModel:
    def left(edges: Sequence[ast.EdgeDeclaration]) -> tuple[ast.EdgeDeclaration, ...]:
        return tuple(each for each in edges if each is not edge)

    items = []
    for item in loaded.items:
        if isinstance(item, ast.Template) and item.name.name == template:
            places = tuple(replace(place, edges=left(place.edges)) for place in item.locations)
            item = replace(item, locations=places, edges=left(item.edges))
        items.append(item)
    return replace(loaded, items=tuple(items))


def changed(exercising: Sequence[Capture], random: Random) -> Iterator[EventLog]:
    for number in range(24):
        recording = exercising[number % len(exercising)].events
        event = random.randrange(len(recording.events))
        edit = random.choice((Edit(event, "lost"), Edit(event, "doubled"), Edit(event, "moved", 150)))
        yield edited(recording, edit, Fraction(1, 10**6))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--only", default="")
    parser.add_argument("--seconds", type=float, default=120)
    parser.add_argument("-o", dest="output", type=Path)
    asked = parser.parse_args()
    given = tachk.load(MODEL)
    loaded = recorded_model(given.loaded, str(MODEL), given.definitions)
    every = list(captures(loaded, asked.folders))
    print(f"{len(every)} captures are runs", flush=True)
    rows: list[dict[str, Any]] = []
    for item in loaded.items:
        if not isinstance(item, ast.Template) or item.name.name not in AUTOMATA or asked.only not in item.name.name:
            continue
        for placed in placed_edges(item):
            row = _row(loaded, item.name.name, placed.source, placed.edge, every, asked.seconds)
            if row is not None:
                rows.append(row)
                print(json.dumps(row), flush=True)
                if asked.output is not None:
                    asked.output.write_text(json.dumps(rows, indent=2), encoding="utf-8")
    needed = [row for row in rows if row["refused"]]
    print(
        f"{len(rows)} edges are taken; without {len(needed)} of them a capture is refused; of these "
        f"{sum(row['same'] is not None for row in needed)} are found as they were, "
        f"{sum(row['found'] is not None for row in needed)} as they were or with the same behaviour"
    )


def _row(
    loaded: LoadedModel,
    template: str,
    source: str,
    edge: ast.EdgeDeclaration,
    every: Sequence[Capture],
    seconds: float,
) -> dict[str, Any] | None:
    key = edge.span.start, template
    exercising = sorted((c for c in every if key in c.taken), key=lambda c: len(c.events.events))
    others = sorted((c for c in every if key not in c.taken), key=lambda c: len(c.events.events))
    if not exercising:
        return None
    smaller = without(loaded, template, edge)
    refusing = [c for c in exercising[:10] if answer(smaller, None, c.events) is not True]
    row: dict[str, Any] = {
        "edge": f"{template} {source} {edge_text(edge)}",
        "captures": len(exercising),
        "refused": len(refusing),
        "same": None,
        "found": None,
        "proposals": [],
    }
    if not refusing:
        return row
    chosen = [*refusing[:3], *others[:2]]
    begun = time.process_time()
    with limited(seconds):
        result = repair(smaller, [c.events for c in chosen], UNCERTAINTY, LIMITS)
    row |= {"seconds": round(time.process_time() - begun, 1), "tried": result.tried, "left_out": result.left_out}
    row["given"] = [c.name for c in chosen]
    for rank, each in enumerate(result.edges, 1):
        proposal = each.proposal
        row["proposals"].append(f"{proposal.template} {proposal.source} {proposal.text}")
        if (proposal.template, proposal.source, proposal.text) == (template, source, edge_text(edge)):
            row["same"] = row["same"] or rank
            row["found"] = row["found"] or rank
    if row["found"] is None and result.edges:
        recordings = [*(c.events for c in exercising[:10]), *changed(exercising[:6], Random(edge.span.start))]
        wanted = [answer(loaded, None, recording) for recording in recordings]
        for rank, each in enumerate(result.edges, 1):
            if all(answer(smaller, each.proposal, r) == w for r, w in zip(recordings, wanted, strict=True)):
                row["found"] = rank
                break
    return row


if __name__ == "__main__":
    main()
