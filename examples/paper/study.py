"""The study of the preprint "Co-Simulation and Runtime Verification of Micro-ROS Communication Mechanisms", repeated.

    python examples/paper/study.py        writes paper_study/report.html in a few minutes

It simulates the five automata, judges every run by the seven sentences, checks the sentences on all runs that there
are, shows where the two disagree, estimates how often that happens, and puts everything on a page. Every command is
printed before it runs; docs/paper.md describes it.
"""

from __future__ import annotations

import argparse
import json
import os
import shlex
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import texts
from loss_rates import Estimated, draw_loss_rates

MODEL = os.path.relpath(Path(__file__).parents[2] / "models/micro_xrce_dds/paper.ta")
SENTENCES = ("ECFS", "ECRA", "NIWS", "RMIO", "RMIO2", "TMRK", "FARS")
SIGNALS = (
    "allToAgent",
    "allToClient",
    "sleep",
    "arrive",
    "tenthAtAgent",
    "TDDSisSent",
    "tenthAtClient",
    "FDDSisSent",
    "lost",
    "marked",
    "behind",
    "caughtUp",
)
"""What the sentences speak of."""

SLEEPS = ("--fault", "falls asleep=now")
"""Without it no run would sleep: a single moment has no probability."""

DISTURBED = "Pr[<=200](<> subscriber.Asleep && subscriber.disturbed)"
ANSWERS = (0, 10, 20)
"""The exit statuses of commands that have an answer: as expected, not as expected, unknown."""


def tachk(*arguments: str, into: Path | None = None) -> None:
    """Runs a command of tachk. What it prints goes into a file where one is given."""
    print("$", shlex.join(["tachk", *arguments]), *([] if into is None else [">", str(into)]), flush=True)
    began = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-m", "tachk", *arguments], stdout=None if into is None else subprocess.PIPE, check=False
    )
    if done.returncode not in ANSWERS:
        sys.exit(f"this command ended with the status {done.returncode}")
    if into is not None:
        into.write_bytes(done.stdout)
    print(f"  {time.monotonic() - began:.1f} s", flush=True)


def read(path: Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8"))


def answers(path: Path) -> dict[str, str]:
    """The answers of tachk verify by the names of properties."""
    return {result["name"]: result["answer"] for run in read(path)["runs"] for result in run["results"]}


def main() -> None:
    parser = argparse.ArgumentParser(description="The study of the preprint, repeated with tachk.")
    parser.add_argument("--folder", type=Path, default=Path("paper_study"), help="where everything is written")
    parser.add_argument("--runs", type=int, default=1000, help="simulated runs that are judged")
    parser.add_argument("--drawn", type=int, default=40_000, help="runs that are drawn for each loss rate")
    parser.add_argument("--losses", type=int, default=3, help="packets that may be lost at most")
    parser.add_argument("--rates", default="0.3 0.2 0.1 0.05", help="loss rates")
    parser.add_argument("--lingers", default="3..8", help="seconds after which the subscriber may sleep")
    asked = parser.parse_args()
    folder: Path = asked.folder
    folder.mkdir(parents=True, exist_ok=True)
    losses = asked.losses
    any_number, fewer, more = (("-D", f"LOSSES={number}", "-D", "PLACES=12") for number in (1000, losses - 1, losses))
    chosen = [part for name in SENTENCES for part in ("--property", name)]
    seed = ("--seed", "1")

    recorded = [part for name in SIGNALS for part in ("--record", name)]
    lost = ("--fault", "lost=send[PUB_UP][DATA]:5", "--fault", "lost=send[SUB_DOWN][DATA]:3")
    run = folder / "run-0.csv"
    tachk("simulate", MODEL, "--until", "200 s", *seed, *SLEEPS, *lost, *recorded, "-o", str(folder / "run-{run}.csv"))
    tachk("plot", MODEL, str(run), *chosen, "-o", str(folder / "run.svg"))

    simulated = folder / "simulated.json"
    drawn = ("--runs", str(asked.runs), "--until", "200 s", *seed, *SLEEPS, "--fault", "lost=0.01")
    tachk("simulate", MODEL, *any_number, *drawn, "--monitor", MODEL, "--format", "json", into=simulated)

    few, many = folder / "verified.json", folder / "verified_more.json"
    tachk("verify", MODEL, *fewer, *chosen, "--format", "json", into=few)
    tachk("verify", MODEL, *more, *chosen, "--trace", "shortest", "--format", "json", into=many)
    found = []
    for rate in map(float, asked.rates.split()):
        into = folder / f"estimate_{rate}.json"
        order = ("--runs", str(asked.drawn), *seed, "--threads", "2", *SLEEPS, "--fault", f"lost={rate}")
        tachk("estimate", MODEL, DISTURBED, *any_number, *order, "--format", "json", into=into)
        (answer,) = read(into)["answers"]
        found.append(Estimated(rate, answer["low"], answer["high"], answer["frequency"]))
    draw_loss_rates(found, folder / "loss_rates.svg")

    sweep = folder / "sweep.json"
    grid = ("-D", f"LOSSES=0..{losses}", "-D", f"LINGER={asked.lingers}", "-D", "PLACES=12")
    tachk("sweep", MODEL, *grid, "--property", "NIWS", "--property", "FARS", "--format", "json", into=sweep)

    told = texts.write(folder, read(simulated), (answers(few), answers(many)), found, losses)
    pages = [told[0], folder / "run.svg", told[1], simulated, told[2], few, told[3], many, told[4]]
    pages += [folder / "loss_rates.svg", told[5], sweep]
    title = "Micro XRCE-DDS: what simulation sees, and what it does not"
    tachk("report", *map(str, pages), "--title", title, "-o", str(folder / "report.html"))


if __name__ == "__main__":
    main()
