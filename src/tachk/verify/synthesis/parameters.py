"""The constants that are varied, and their values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import pairwise

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass
from tachk.model.grid import MOST_CELLS, Grid, ParameterAxis, grid_of_values

_EXAMPLE = "for example --over PERIOD=1..50,DEADLINE=10..100:10"


@dataclass(frozen=True, slots=True)
class VariedConstant:
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


def parameters_from(
    over: str | Iterable[str | VariedConstant] | Mapping[str, object] | Grid,
) -> tuple[VariedConstant, ...]:
    """Parameters as a program gives them: a grid, the argument of `grid_of_values`, or parameters.

    Raises UsageError for anything else, and for values that are not numbers at equal distances.
    """
    if isinstance(over, str | Mapping | Grid):
        return tuple(_parameter(axis) for axis in grid_of_values(over).axes)
    found: list[VariedConstant] = []
    for each in over:
        found += (each,) if isinstance(each, VariedConstant) else parameters_from(grid_of_values([each]))
    return tuple(found)


def _parameter(axis: ParameterAxis) -> VariedConstant:
    numbers = sorted(value for value in axis.values if isinstance(value, int))
    steps = {after - before for before, after in pairwise(numbers)}
    if len(numbers) < len(axis.values) or len(steps) > 1:
        raise UsageError(f"{axis.name} needs numbers at equal distances", _EXAMPLE)
    return VariedConstant(axis.name, numbers[0], numbers[-1], *steps)


def checked_parameters(parameters: Iterable[VariedConstant]) -> tuple[VariedConstant, ...]:
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
