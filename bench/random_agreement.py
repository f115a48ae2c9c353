"""Random networks through all engines: `python bench/random_agreement.py COUNT SEED [FEATURE=VALUE ...]`.

Prints how often each engine reached which conclusion, and every disagreement with the seed that reproduces it.
Features are the fields of `tachk.testing.Shape`, for instance ``priorities=True clocks=2``. Without any, the shapes in
`SHAPES` take turns. Exit status 1 after a disagreement.
"""

from __future__ import annotations

import ast
import sys
import time
from collections import Counter
from random import Random

from tachk.testing import Shape, random_case
from tachk.testing.agreement import compare

SHAPES = (
    Shape(),
    Shape(clocks=2),
    Shape(priorities=True),
    Shape(diagonals=True, clocks=2),
    Shape(priorities=True, diagonals=True, clocks=2, constant=3),
    Shape(strict=False, deadlocks=False),
    Shape(stopwatches=True),
)


def main(arguments: list[str]) -> int:
    count, seed = int(arguments[0]), int(arguments[1])
    features = dict(argument.split("=", 1) for argument in arguments[2:])
    given = Shape(**{name: ast.literal_eval(value) for name, value in features.items()}) if features else None
    conclusions: Counter[tuple[str, str]] = Counter()
    wrong, started = 0, time.monotonic()
    for number in range(seed, seed + count):
        shape = given or SHAPES[number % len(SHAPES)]
        agreement = compare(random_case(Random(number), shape))
        for name, outcome in agreement.outcomes.items():
            conclusions.update((name, goal.status.value) for goal in outcome.goals)
        for problem in agreement.problems:
            wrong += 1
            print(f"seed {number}, {shape}: {problem}", flush=True)
    for (name, status), times in sorted(conclusions.items()):
        print(f"{times:8} {status:12} {name}")
    print(f"{count} networks, {wrong} disagreements, {time.monotonic() - started:.0f} s")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
