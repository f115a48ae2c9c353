"""Families of models, this checkout beside another one: verdicts, states, memory and CPU time of whole processes.

    python bench/families.py --against /path/to/another/checkout
    python bench/families.py --against /path/to/another/checkout --repeat 9 --only fischer fddi

Both checkouts need the extension in src/tachk (`cmake --workflow --preset dev`). They take turns; CPU seconds are user
and system time by wait4, the least of several runs, start included: what others do on the machine only adds to it.
Each model is that of its own checkout. The last column is the ratio of the CPU times, below 1 where this checkout is
faster.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from dataclasses import dataclass
from pathlib import Path

from processes import finished

HERE = Path(__file__).resolve().parents[1]

FAMILIES = {
    "fischer": ("classics/fischer.ta", "N=9", "mutual_exclusion"),
    "csma_cd": ("classics/csma_cd.ta", "N=11", "collision_noticed"),
    "train_gate": ("classics/train_gate.ta", "N=8", "one_at_a_time"),
    "fddi": ("classics/fddi.ta", "N=14", "one_sender"),
    "dining": ("classics/dining_philosophers.ta", "N=7", "no_deadlock"),
    "brp": ("classics/brp.ta", "N=16", None),
    "client_3_0": ("micro_xrce_dds/client_3_0.ta", "LOSSES=1", "ECFS"),
    "publication": ("micro_xrce_dds/publication.ta", "LOSSES=1", None),
}
"""Model, definition of a constant, and property; None for all of them."""


@dataclass(frozen=True, slots=True)
class Measurement:
    """One run of a whole process.

    Attributes:
        answers: what must not differ: verdict, states explored and stored, for each property.
        memory: largest memory of a search, in bytes.
    """

    answers: tuple[tuple[str, int, int], ...]
    memory: int
    cpu_seconds: float


def measure(checkout: Path, family: str) -> Measurement:
    """One run of a family in a checkout."""
    model, definition, name = FAMILIES[family]
    command = [sys.executable, "-m", "tachk", "verify", str(checkout / "models" / model), "-D", definition]
    command += ["--format", "json", *(() if name is None else ("--property", name))]
    process = finished(command, checkout / "src")
    report = json.loads(process.output)
    results = [result for run in report["runs"] for result in run["results"]]
    searches = [result["stats"] for result in results]
    answers = [
        (result["answer"], search["states_explored"], search["states_stored"])
        for result, search in zip(results, searches, strict=True)
    ]
    return Measurement(
        tuple(answers),
        max(search["peak_bytes"] for search in searches),
        process.cpu_seconds,
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--against", type=Path, required=True, metavar="FOLDER", help="the other checkout")
    parser.add_argument("--repeat", type=int, default=5, help="how often each is run")
    parser.add_argument("--only", nargs="+", choices=FAMILIES, default=list(FAMILIES), metavar="FAMILY")
    given = parser.parse_args()
    print(f"load average {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores, least of {given.repeat}\n")
    print("| family | explored | stored | MB other | MB this | CPU s other | CPU s this | ratio |")
    print("|---|---|---|---|---|---|---|---|")
    differ = False
    for family in given.only:
        pairs = [(measure(given.against, family), measure(HERE, family)) for _ in range(given.repeat)]
        other, this = (min(side, key=lambda run: run.cpu_seconds) for side in zip(*pairs, strict=True))
        explored, stored = (sum(answer[column] for answer in this.answers) for column in (1, 2))
        print(
            f"| {family} {FAMILIES[family][1]} | {explored:,} | {stored:,} | {other.memory / 1e6:.1f} | "
            f"{this.memory / 1e6:.1f} | {other.cpu_seconds:.2f} | {this.cpu_seconds:.2f} | "
            f"{this.cpu_seconds / other.cpu_seconds:.3f} |",
            flush=True,
        )
        if this.answers != other.answers:
            differ = True
            print(f"    answers differ: {other.answers} there, {this.answers} here")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
