"""Which constants are varied, and over which values."""

from __future__ import annotations

import re
from collections.abc import Iterable

from tachk.diagnostics.diagnostic import UsageError
from tachk.records import dataclass

_RANGE = re.compile(r"\s*(\w+)\s*=\s*(-?\d+)\s*(?:\.\.\s*(-?\d+)\s*(?::\s*(\d+)\s*)?)?")
_EXAMPLE = "for example --over PERIOD=1..50,DEADLINE=10..100:10"

MOST_CELLS = 1_000_000
"""More than that is taken for a mistake."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A global integer constant that takes the values ``low``, ``low + step``, ... up to ``high``."""

    name: str
    low: int
    high: int
    step: int = 1

    def __post_init__(self) -> None:
        if self.step < 1:
            raise UsageError(f"the step of {self.name} must be at least 1, not {self.step}")
        if self.high < self.low:
            raise UsageError(f"{self.name}={self.low}..{self.high} has no values", "write the smaller number first")

    @property
    def values(self) -> range:
        return range(self.low, self.high + 1, self.step)

    def __str__(self) -> str:
        step = f":{self.step}" if self.step != 1 else ""
        return f"{self.name}={self.low}..{self.high}{step}"


def parameters_of(texts: Iterable[str]) -> tuple[Parameter, ...]:
    """``A=1..50,B=0..60:5`` as parameters. Raises UsageError for anything else and for a name given twice."""
    found: list[Parameter] = []
    for text in texts:
        for part in text.split(","):
            match = _RANGE.fullmatch(part)
            if match is None:
                raise UsageError(f"--over {text}: expected NAME=LOW..HIGH or NAME=LOW..HIGH:STEP", _EXAMPLE)
            name, low, high, step = match.groups()
            found.append(Parameter(name, int(low), int(low if high is None else high), int(step or 1)))
    return checked_parameters(found)


def checked_parameters(parameters: Iterable[Parameter]) -> tuple[Parameter, ...]:
    """The parameters, if they can be varied together. Raises UsageError."""
    result = tuple(parameters)
    if not result:
        raise UsageError("nothing is varied", _EXAMPLE)
    names = [parameter.name for parameter in result]
    for name in names:
        if names.count(name) > 1:
            raise UsageError(f"{name} is varied twice")
    cells = 1
    for parameter in result:
        cells *= len(parameter.values)
    if cells > MOST_CELLS:
        raise UsageError(
            f"these are {cells} combinations of values, more than {MOST_CELLS}", "take shorter ranges or larger steps"
        )
    return result
