"""Grids: constants and the values that each of them takes."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product
from math import prod
from operator import index

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import DIGITS
from tachk.base.records import dataclass

_NUMBER = rf"-?{DIGITS}"
_RANGE = rf"(-?{DIGITS})\s*\.\.\s*(-?{DIGITS})(?:\s*:\s*({DIGITS}))?"
_SETTING = r"\s*[^\W\d]\w*\s*=(?!=)"
_EXAMPLE = "for example N=4; for several values LOSSES=0..5 or SLICE=10,50,100..400:100"
_IN_PYTHON = 'for example over="LOSSES=0..5,SLICE=10,50" or over={"LOSSES": range(6), "SLICE": [10, 50]}'

MOST_CELLS = 1_000_000
"""More than that is taken for a mistake."""

Values = tuple[int | str, ...]
"""The value of each constant of a grid, in order: a number, or an expression of the language."""


@dataclass(frozen=True, slots=True)
class ParameterAxis:
    """A global constant and the values it takes, each once."""

    name: str
    values: Values


@dataclass(frozen=True, slots=True)
class Grid:
    """All combinations of the values of some constants."""

    axes: tuple[ParameterAxis, ...]

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(axis.name for axis in self.axes)

    @property
    def varied(self) -> tuple[ParameterAxis, ...]:
        """The axes with more than one value."""
        return tuple(axis for axis in self.axes if len(axis.values) > 1)

    def __len__(self) -> int:
        return prod(len(axis.values) for axis in self.axes)

    def cells(self) -> Iterator[Values]:
        """Each combination; the last constant changes fastest."""
        return product(*(axis.values for axis in self.axes))


def grid_of(texts: Iterable[str], option: str = "-D") -> Grid:
    """The grid of texts such as ``LOSSES=0..5``, ``SLICE=10,50,100..400:100``, ``PULL=false,true``, and several of
    these with commas between: ``LOSSES=0..5,SLICE=10,50``.

    Args:
        option: where the texts come from, for messages.

    Raises UsageError for anything else, for a name or a value given twice, and for more than `MOST_CELLS` cells.
    """
    return _grid(
        [_axis(name, listed, f"{option} {text}") for text in texts for name, listed in _settings(text, option)]
    )


def grid_of_values(over: str | Iterable[str] | Mapping[str, object] | Grid) -> Grid:
    """The grid that a program gives: texts as for `grid_of`, or a dictionary from names to a value, to values such as
    ``range(4)`` or ``[1, 2, 5]``, or to a text such as ``"0..3"``. Raises UsageError as `grid_of` does."""
    match over:
        case Grid():
            return over
        case str():
            return grid_of([over], "over:")
        case Mapping():
            return _grid([_axis_of_values(name, values) for name, values in over.items()])
        case Iterable():
            texts = list(over)
            if all(isinstance(text, str) for text in texts):
                return grid_of(texts, "over:")
    raise UsageError(f"over: {over!r} does not say which constants take which values", _IN_PYTHON)


def set_by(texts: Iterable[str], option: str = "-D") -> Iterator[tuple[str, str]]:
    """The names in ``A=3`` or ``A=3,B=max(1, 2)``, each with what stands behind its ``=``. Raises UsageError."""
    for text in texts:
        yield from _settings(text, option)


def _grid(axes: Sequence[ParameterAxis]) -> Grid:
    names = [axis.name for axis in axes]
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f"{name} is given twice", f"all values at once: {name}=1,2,3")
    grid = Grid(tuple(axes))
    if len(grid) > MOST_CELLS:
        raise UsageError(f"these are {len(grid)} combinations of values, more than {MOST_CELLS}")
    return grid


def _settings(text: str, option: str) -> Iterator[tuple[str, str]]:
    """A comma separates values, and constants where a name and ``=`` stand behind it."""
    parts: list[str] = []
    for part in _split(text):
        if re.match(_SETTING, part) or not parts:
            parts.append(part)
        else:
            parts[-1] += f",{part}"
    for part in parts:
        name, equals, listed = (piece.strip() for piece in part.partition("="))
        if not (equals and name.isidentifier() and all(each.strip() for each in _split(listed))):
            raise UsageError(f"{option} {text}: expected NAME=VALUE", _EXAMPLE)
        yield name, listed


def _axis(name: str, listed: str, where: str) -> ParameterAxis:
    values = [value for part in _split(listed) for value in _values(name, part.strip())]
    twice = next((value for value, times in Counter(values).items() if times > 1), None)
    if twice is not None:
        raise UsageError(f"{where}: the value {twice} is given twice")
    return ParameterAxis(name, tuple(values))


def _axis_of_values(name: str, values: object) -> ParameterAxis:
    """An axis from the entry of a dictionary. Truth values become those of the language."""
    if isinstance(values, str):
        return _axis(name, values, f"over: {name}")
    listed = values if isinstance(values, Iterable) else (values,)
    found = tuple(_value(name, value) for value in listed)
    if not found or len(set(found)) < len(found):
        raise UsageError(f"over: {name} has {'a value twice' if found else 'no values'}")
    return ParameterAxis(name, found)


def _value(name: str, value: object) -> int | str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    try:
        number = index(value)  # type: ignore[arg-type]
    except TypeError:
        raise UsageError(f"over: {value!r} is not a value of {name}", _IN_PYTHON) from None
    if not -(2**31) <= number < 2**31:
        raise UsageError(f"over: {name} has a value that does not fit into 32 bits")
    return number


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
    if re.fullmatch(_NUMBER, part):
        return (int(part),)
    match = re.fullmatch(_RANGE, part)
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
