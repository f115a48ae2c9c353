"""What a second thread brings: searches through all states, by one thread and by several, taking turns.

Each search has a process of its own. Seconds are those of the search alone, by the clock on the wall, so that the
machine must have nothing else to do; CPU seconds in user mode are told beside them. Medians.

    python -m bench.threads
    python -m bench.threads --threads 4 --repeat 3 fischer csma_cd
    python -m bench.threads --repetitions 100        are verdicts and runs the same?
"""

from __future__ import annotations

import argparse
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from statistics import median

import tachk
from tachk import Options
from tachk.engine.options import LocalTimes

MODELS = Path(__file__).resolve().parents[1] / "models"


@dataclass(frozen=True, slots=True)
class Instance:
    """A model, values for its constants, and a query."""

    model: str
    constants: dict[str, int | bool | str]
    query: str = "E<> false"


INSTANCES = {
    "fischer": Instance("classics/fischer.ta", {"N": 11}),
    "csma_cd": Instance("classics/csma_cd.ta", {"N": 11}),
    "critical_region": Instance("classics/critical_region.ta", {"N": 6, "CAREFUL": True}),
    "client_3_0": Instance("micro_xrce_dds/client_3_0.ta", {"LOSSES": 2}),
}
FAILING = (
    Instance("classics/fischer.ta", {"N": 8, "WAIT": 9}, "E<> exists (p : pid_t) P(p).critical && id != p"),
    Instance("classics/critical_region.ta", {"N": 5}, "E<> deadlock"),
)


@dataclass(frozen=True, slots=True)
class Found:
    """What one search gave: of its trace what is printed of it."""

    seconds: float
    user_seconds: float
    explored: int
    stored: int
    answer: str
    trace: str


def search(instance: Instance, threads: int) -> Found:
    """One search; to be called in a process of its own."""
    options = Options(threads=threads, local_times=LocalTimes.NEVER).off("symmetry")
    (verdict,) = tachk.load(MODELS / instance.model, **instance.constants).verify(instance.query, options=options)
    told = verdict.statistics
    return Found(
        told.seconds,
        told.user_seconds,
        told.states_explored,
        told.states_stored,
        verdict.answer.value,
        str(verdict.trace),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("instances", nargs="*", choices=[[], *INSTANCES], metavar="INSTANCE", help=", ".join(INSTANCES))
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--repetitions", type=int, default=0)
    asked = parser.parse_args()
    if asked.repetitions:
        sys.exit(same_runs(asked.threads, asked.repetitions))
    with ProcessPoolExecutor(1, mp_context=get_context("spawn"), max_tasks_per_child=1) as processes:
        print(f"| model | states | explored | 1 thread, s | {asked.threads} threads, s | times faster |", end="")
        print(f" CPU of 1, s | CPU of {asked.threads}, s |\n|---|---|---|---|---|---|---|---|")
        for name in asked.instances or INSTANCES:
            runs: dict[int, list[Found]] = {1: [], asked.threads: []}
            for _ in range(asked.repeat):
                for threads, found in runs.items():
                    found.append(processes.submit(search, INSTANCES[name], threads).result())
            if len({(found.explored, found.stored, found.answer) for all_ in runs.values() for found in all_}) != 1:
                sys.exit(f"{name}: the searches differ")
            wall = [median(found.seconds for found in all_) for all_ in runs.values()]
            cpu = [median(found.user_seconds for found in all_) for all_ in runs.values()]
            one = runs[1][0]
            print(f"| {name} | {one.stored:,} | {one.explored:,} | {wall[0]:.2f} | {wall[1]:.2f} |", end="")
            print(f" {wall[0] / wall[1]:.2f} | {cpu[0]:.2f} | {cpu[1]:.2f} |", flush=True)


def same_runs(threads: int, repetitions: int) -> int:
    """The exit status: whether some search finds another run than one thread does."""
    for instance in FAILING:
        alone = search(instance, 1)
        for _ in range(repetitions):
            found = search(instance, threads)
            if (found.answer, found.trace, found.explored) != (alone.answer, alone.trace, alone.explored):
                print(f"{instance.model}: another answer, run or number of states")
                return 1
        print(f"{instance.model}: {alone.answer}, {repetitions} times the same run, {alone.explored:,} states explored")
    return 0


if __name__ == "__main__":
    main()
