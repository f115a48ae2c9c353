"""Which constants take which values."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import product
from math import prod

from tachk.diagnostics.diagnostic import UsageError
from tachk.records import dataclass

_RANGE = re.compile(r"(-?\d+)\s*\.\.\s*(-?\d+)(?:\s*:\s*(\d+))?")
_EXAMPLE = "for example -D LOSSES=0..5 -D SLICE=10,50,100..400:100"

MOST_CELLS = 1_000_000
"""More than that is taken for a mistake."""

Values = tuple[int | str, ...]
"""The value of each constant of a grid, in order: a number, or an expression of the language."""


@dataclass(frozen=True, slots=True)
class Axis:
    """A global constant and the values it takes, each once."""

    name: str
    values: Values


@dataclass(frozen=True, slots=True)
class Grid:
    """All combinations of the values of some constants."""

    axes: tuple[Axis, ...]

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(axis.name for axis in self.axes)

    @property
    def varied(self) -> tuple[Axis, ...]:
        """The axes with more than one value."""
        return tuple(axis for axis in self.axes if len(axis.values) > 1)

    def __len__(self) -> int:
        return prod(len(axis.values) for axis in self.axes)

    def cells(self) -> Iterator[Values]:
        """Each combination; the last constant changes fastest."""
        return product(*(axis.values for axis in self.axes))


def grid_of(texts: Iterable[str]) -> Grid:
    """The grid of texts such as ``LOSSES=0..5``, ``SLICE=10,50,100..400:100`` and ``PULL=false,true``.

    Raises UsageError for anything else, for a name or a value given twice, and for more than `MOST_CELLS` cells.
    """
    axes = tuple(_axis(text) for text in texts)
    names = [axis.name for axis in axes]
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f"-D {name} is given twice", f"all values in one option: -D {name}=1,2,3")
    grid = Grid(axes)
    if len(grid) > MOST_CELLS:
        raise UsageError(f"these are {len(grid)} combinations of values, more than {MOST_CELLS}")
    return grid


def _axis(text: str) -> Axis:
    name, equals, listed = (part.strip() for part in text.partition("="))
    parts = [part.strip() for part in _split(listed)]
    if not (equals and name.isidentifier() and all(parts)):
        raise UsageError(f"-D {text}: expected NAME=VALUE, NAME=VALUE,VALUE,... or NAME=LOW..HIGH", _EXAMPLE)
    values = [value for part in parts for value in _values(name, part)]
    twice = next((value for value, times in Counter(values).items() if times > 1), None)
    if twice is not None:
        raise UsageError(f"-D {text}: the value {twice} is given twice")
    return Axis(name, tuple(values))


def _split(listed: str) -> list[str]:
    """At the commas outside of brackets, for a value may be ``{1, 2}`` or ``max(2, 3)``."""
    parts, depth = [""], 0
    for character in listed:
        depth += (character in "([{") - (character in ")]}")
        if character == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    return parts


def _values(name: str, part: str) -> Iterable[int | str]:
    if re.fullmatch(r"-?\d+", part):
        return (int(part),)
    match = _RANGE.fullmatch(part)
    if match is None:
        return (part,)
    low, high, step = int(match[1]), int(match[2]), int(match[3] or 1)
    if step < 1:
        raise UsageError(f"the step of {name} must be at least 1, not {step}")
    if high < low:
        raise UsageError(f"{name}={low}..{high} has no values", "write the smaller number first")
    if (high - low) // step >= MOST_CELLS:
        raise UsageError(f"{name}={part} has more than {MOST_CELLS} values")
    return range(low, high + 1, step)
