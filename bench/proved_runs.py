"""Formulas that `verify` proves, on simulated runs: `python -m bench.proved_runs NETWORKS SEED`.

Proves random formulas for random networks and judges runs of these by them. Prints how many runs end how and what
the verdicts are, and each one on which a proved formula is false. Exit status 1 if there is one.
"""

from __future__ import annotations

import sys
import time
from collections import Counter

from tachk.recordings.traces.node_signal import Truth
from tests.support.simulated.proved import proved_on_runs


def main(arguments: list[str]) -> int:
    networks, first = int(arguments[0]), int(arguments[1])
    verdicts: Counter[tuple[str, str]] = Counter()
    proved: set[tuple[int, str]] = set()
    wrong, started = 0, time.monotonic()
    for seed in range(first, first + networks):
        for judged in proved_on_runs(seed):
            proved.add((seed, judged.formula))
            verdicts[str(judged.truth), str(judged.ending)] += 1
            if judged.truth is Truth.FALSE:
                wrong += 1
                print(f"seed {seed}, run {judged.run}, which ends with {judged.ending}: {judged.formula}", flush=True)
    for (truth, ending), times in sorted(verdicts.items()):
        print(f"{times:8} {truth:12} {ending}")
    print(f"{networks} networks, {len(proved)} proved formulas, {wrong} false, {time.monotonic() - started:.0f} s")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
