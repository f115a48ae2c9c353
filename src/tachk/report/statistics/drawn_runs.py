"""The summary of runs that were drawn: `tachk simulate`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from tachk.base.records import dataclass
from tachk.engine.simulation.simulator import SimulationEnding
from tachk.recordings.traces.node_signal import Truth
from tachk.report.statistics.text import times_text
from tachk.simulation.tally import Tally


@dataclass(frozen=True, slots=True)
class SimulationHeading:
    """What was to be drawn.

    Attributes:
        model: its path as given.
        runs: how many, of which not all may have been drawn.
        first: the number of the first.
        until: their length as given.
        confidence: of the intervals of probabilities.
    """

    model: str
    runs: int
    first: int
    until: str
    seed: int
    policy: str
    confidence: float


def tally_lines(heading: SimulationHeading, tally: Tally) -> Iterator[str]:
    """The summary for people."""
    runs = "1 run" if heading.runs == 1 else f"{heading.runs} runs"
    if tally.stopped:
        runs = f"{tally.runs} of {runs}"
    yield f"{heading.model}: {runs} until {heading.until}, {tally.transitions} transitions, seed {heading.seed}"
    for ending, count in tally.endings.most_common():
        number, end = tally.examples[ending]
        where = "" if ending is SimulationEnding.HORIZON else f", the first is run {number} at {end}"
        yield f"  {count} {'run' if count == 1 else 'runs'} {ending.what_happened}{where}"
    for written, done in tally.done.items():
        missed = tally.missed[written]
        impossible = f", {times_text(missed)} the model does not allow it" if missed else ""
        yield f"{written}: {times_text(done)}{impossible}"
    for fault in tally.faults:
        yield f"  {fault}"
    for name, counts in tally.truths.items():
        verdicts = ", ".join(f"{truth} on {counts[truth]}" for truth in (Truth.TRUE, Truth.FALSE, Truth.UNDETERMINED))
        violating = tally.violating.get(name, [])
        yield f"{name}: {verdicts}" + (f"; the first violation is in run {violating[0]}" if violating else "")
        low, high = tally.probability_of_violation(name, heading.confidence)
        yield f"  probability of a violation: {low:.4g} to {high:.4g}, confidence {heading.confidence:.6g}"
    if tally.stopped:
        yield f"unknown what the other runs do ({tally.stopped})"


def tally_to_json(heading: SimulationHeading, tally: Tally, formulas: Mapping[str, str]) -> dict[str, object]:
    """The form that docs/schema/simulate.schema.json describes.

    Args:
        formulas: their texts by their names.
    """
    return {
        "model": heading.model,
        "runs": tally.runs,
        **({"not_drawn": heading.runs - tally.runs, "reason": tally.stopped} if tally.stopped else {}),
        "first": heading.first,
        "until": heading.until,
        "seed": heading.seed,
        "policy": heading.policy,
        "transitions": tally.transitions,
        "faults": [{"order": order, "done": done, "missed": tally.missed[order]} for order, done in tally.done.items()],
        "endings": {ending.value: count for ending, count in tally.endings.items()},
        "formulas": [
            {
                "name": name,
                "formula": formulas[name],
                "true": counts[Truth.TRUE],
                "false": counts[Truth.FALSE],
                "undetermined": counts[Truth.UNDETERMINED],
                "violating": tally.violating.get(name, []),
                "probability_of_violation": tally.probability_of_violation(name, heading.confidence),
                "confidence": heading.confidence,
            }
            for name, counts in tally.truths.items()
        ],
    }
