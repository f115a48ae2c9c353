"""What became of mutants: one JSON object a line, the last one of a mutant counts."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from tests.mutation.mutants import Mutant

KILLED = "killed"
TIMEOUT = "timeout"
SURVIVED = "survived"


@dataclass(frozen=True, slots=True)
class Result:
    """Attributes:
    digest: of the mutant, the file that it changes and its tests.
    fate: KILLED, TIMEOUT (a test did not come to its end, which is noticed, too), SURVIVED, or what kept the mutant
        from running.
    by: the test that failed, or the reason of the fate.
    seconds: of wall-clock time, building included.
    """

    id: str
    digest: str
    fate: str
    by: str
    seconds: float

    def is_valid_for(self, digest: str) -> bool:
        """Whether it tells what becomes of the mutant now."""
        return self.digest == digest and self.fate in (KILLED, TIMEOUT, SURVIVED)


def read_results(log: Path) -> dict[str, Result]:
    lines = log.read_text(encoding="utf-8").splitlines() if log.is_file() else []
    return {found.id: found for found in (Result(**json.loads(line)) for line in lines)}


def write_result(log: Path, result: Result) -> None:
    with log.open("a", encoding="utf-8") as file:
        file.write(json.dumps(asdict(result)) + "\n")


def summary(mutants: Sequence[Mutant], results: Mapping[str, Result]) -> str:
    """A table in Markdown: counts by area, and the rate of those killed among the mutants that are not equivalent."""
    lines = [
        "| area | mutants | killed | equivalent | survived | not run | killed of what can be |",
        "|---|---|---|---|---|---|---|",
    ]
    areas = list(dict.fromkeys(mutant.area for mutant in mutants))
    for area in [*areas, "all"]:
        here = [mutant for mutant in mutants if area in (mutant.area, "all")]
        counts = Counter(_fate(mutant, results) for mutant in here)
        run = counts[KILLED] + counts[SURVIVED]
        rate = f"{100 * counts[KILLED] // run} %" if run else "-"
        cells = [len(here), counts[KILLED], counts["equivalent"], counts[SURVIVED], counts["not run"], rate]
        lines.append(f"| {area} | {' | '.join(map(str, cells))} |")
    return "\n".join(lines)


def _fate(mutant: Mutant, results: Mapping[str, Result]) -> str:
    fate = results[mutant.id].fate if mutant.id in results else ""
    if fate in (KILLED, TIMEOUT):
        return KILLED
    if fate == SURVIVED:
        return "equivalent" if mutant.equivalent else SURVIVED
    return "not run"
