"""Formulas without deadline on random networks, against regions: `python -m bench.awaited_agreement PAIRS SEED`.

Compares the verdicts about `tests.support.endless.awaited_oracle.FORMS` with an oracle that knows neither observers nor
zones, until that many pairs of a network and a formula are compared. Prints how many of each there were, and every
difference with the seed that reproduces it. Exit status 1 after a difference.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from itertools import count

from tests.support.endless.awaited_agreement import compare_awaited


def main(arguments: list[str]) -> int:
    pairs, first = int(arguments[0]), int(arguments[1])
    compared: Counter[tuple[str, bool]] = Counter()
    wrong = committed = networks = 0
    started = time.monotonic()
    for seed in count(first):
        if compared.total() >= pairs:
            break
        networks += 1
        for found in compare_awaited(seed):
            compared[found.form, found.expected] += 1
            committed += found.committed
            if not found.agrees:
                wrong += 1
                told = "violated" if found.expected else "not violated"
                print(f"seed {seed}: {found.form} is {told}, and {found.answer}", flush=True)
    for (form, expected), times in sorted(compared.items()):
        print(f"{times:8} {'violated' if expected else 'not violated':14} {form}")
    print(f"{compared.total()} pairs, {networks} networks, {committed} pairs with committed locations", end="")
    print(f", {wrong} differ, {time.monotonic() - started:.0f} s")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
