"""Random models with a part that can be left out: `python -m bench.left_out COUNT SEED`.

Each model is checked with everything and without what does not count; answers and hidden run-time errors are compared.
Runs are carried over from parts of any size, also where that is not worth while.
Prints every disagreement with the seed that reproduces it. Ctrl-C ends it with what is known so far. Exit status 1
after a disagreement.
"""

from __future__ import annotations

import sys
import time
from random import Random

from tachk import Limits
from tachk.verify import over_approximations
from tests.support.independent.lossy_links import compare, random_components

_LIMITS = Limits(states=10_000)


def main(arguments: list[str]) -> int:
    count, seed = map(int, arguments)
    over_approximations.WORTH_CARRYING_OVER = 0
    started = time.monotonic()
    done = compared = fewer = faults = wrong = 0
    try:
        for number in range(seed, seed + count):
            found = compare(random_components(Random(number)), _LIMITS)
            compared += found.compared
            fewer += found.fewer
            faults += found.faults
            wrong += len(found.problems)
            for problem in found.problems:
                print(f"seed {number}: {problem}", flush=True)
            done += 1
    except KeyboardInterrupt:
        pass  # what is known so far is told
    print(
        f"{done} models, {compared} answers compared, {fewer} queries with fewer states, "
        f"{faults} with run-time errors, {wrong} disagreements, {time.monotonic() - started:.0f} s"
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
