"""Seeds of random examples: a quarter of the named ones at each run, and others that are drawn from the commit.

A failure with a fresh seed is repeated by ``pytest --seed NUMBER``, with the number that the report names, whichever
commit is checked out. ``--seed 0`` draws nothing: all seeds are those that the tests name.
"""

from __future__ import annotations

import functools
import subprocess
from collections.abc import Sequence
from pathlib import Path
from random import Random
from typing import TypeVar

from hypothesis import seed as hypothesis_seed

T = TypeVar("T")

NUMBERS = 800_000
"""The largest number; all seeds fit into 32 bits."""
STRIDE = 5040
"""Fresh seeds leave the same remainders as those they replace for all divisors up to 10: tests choose shapes so."""
_WITHOUT_COMMIT = 20_260


class Draw:
    """Which examples are drawn.

    Attributes:
        number: what is drawn from the commit, or the number of the option; 0 draws nothing.
        times: so many fresh seeds stand for each one that is not kept.
    """

    number: int | None = None
    times = 1


def number() -> int:
    """The number from which seeds are drawn."""
    return _number_of_commit() if Draw.number is None else Draw.number


def seeds(named: Sequence[int]) -> list[int]:
    """A quarter of some seeds, and fresh ones for a fifth of the others: no commit tries the same ones again."""
    if not number():
        return list(named)
    kept = -(-len(named) // 4)
    replaced = named[kept : kept + -(-(len(named) - kept) // 5)]
    turns = range(number(), number() + Draw.times)
    return [*named[:kept], *(seed + STRIDE * turn for turn in turns for seed in replaced)]


def some(things: Sequence[T], count: int) -> list[T]:
    """So many of some things, in their order: the first, or those that are drawn."""
    count = min(len(things), count * Draw.times)
    if not number():
        return list(things[:count])
    return [things[n] for n in sorted(Random(number()).sample(range(len(things)), count))]


def one_in(size: int, tests: Sequence[str]) -> list[str]:
    """One in so many tests, drawn; all where nothing is drawn."""
    return some(tests, -(-len(tests) // size)) if number() else list(tests)


def enough(met: bool) -> bool:
    """Whether examples met what a test is about often enough: the named ones must, drawn ones may happen not to."""
    return met or number() != 0


def refresh(test: object, name: str) -> None:
    """Has three quarters of the tests by hypothesis, chosen by their names, draw from the number, too."""
    if number() and sum(name.encode()) % 4:
        hypothesis_seed(number())(test)  # type: ignore[type-var]


@functools.cache
def _number_of_commit() -> int:
    command = ["git", "rev-parse", "HEAD"]
    try:
        done = subprocess.run(command, cwd=Path(__file__).parent, check=True, capture_output=True, text=True)
    except (OSError, subprocess.CalledProcessError):
        return _WITHOUT_COMMIT
    return 1 + int(done.stdout[:12], 16) % NUMBERS
