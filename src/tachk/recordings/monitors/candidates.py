"""The values of a parameter at which the truth of a formula on given traces can change.

Between two of them it is the same. A bound of time matters where it comes to a difference of instants of rows, shifted
by other bounds: these are multiples of a tick. A threshold matters where it comes to a value that it is compared with.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import ceil, floor, lcm

import numpy as np
from numpy.typing import NDArray

from tachk.recordings.traces.monitor_program import ValueInstruction, ValueOperator
from tachk.recordings.traces.trace import Trace

MOST_OCCURRENCES = 7
"""In bounds of time; the sums of more would be too many."""


@dataclass(frozen=True, slots=True)
class Lattice:
    """All multiples of a step, and the ends of the range."""

    low: Fraction
    high: Fraction
    step: Fraction

    def __len__(self) -> int:
        return floor(self.high / self.step) - ceil(self.low / self.step) + 1 + self._before + self._behind

    def __getitem__(self, index: int) -> Fraction:
        if index == 0:
            return self.low
        if index == len(self) - 1:
            return self.high
        return (ceil(self.low / self.step) + index - self._before) * self.step

    @property
    def _before(self) -> int:
        return 0 if (self.low / self.step).denominator == 1 else 1

    @property
    def _behind(self) -> int:
        return 0 if (self.high / self.step).denominator == 1 else 1


@dataclass(frozen=True, slots=True)
class Values:
    """Numbers of the traces, and the ends of the range."""

    numbers: tuple[Fraction, ...]

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, index: int) -> Fraction:
        return self.numbers[index]


Candidates = Lattice | Values


def places(candidates: Candidates) -> int:
    """The number of values to try: the candidates, and one between any two of them."""
    return 2 * len(candidates) - 1


def value_at(candidates: Candidates, place: int) -> Fraction:
    """A candidate for an even place, and the middle between two for an odd one."""
    if place % 2 == 0:
        return candidates[place // 2]
    return (candidates[place // 2] + candidates[place // 2 + 1]) / 2


def common_step(tick: Fraction, slopes: Sequence[Fraction]) -> Fraction:
    """A step of which every difference of instants, divided by a sum of slopes of bounds, is a multiple.

    Args:
        tick: of which all instants and other bounds are multiples.
        slopes: by how much each bound grows with the parameter; nested ones add up, and parts of a formula that are
            shifted by different bounds meet each other.
    """
    sums = (sum(sign * slope for sign, slope in zip(signs, slopes, strict=True)) for signs in _signs(len(slopes)))
    return tick / lcm(*{abs(Fraction(each).numerator) for each in sums if each})


def _signs(count: int) -> Iterator[tuple[int, ...]]:
    return product((-1, 0, 1), repeat=count)


def values_within(found: Sequence[NDArray[np.float64]], low: Fraction, high: Fraction) -> Values:
    """The distinct values of arrays in a range, and its ends."""
    numbers = np.unique(np.concatenate([np.unique(values) for values in found]))
    inside = numbers[(numbers > float(low)) & (numbers < float(high))]
    return Values((low, *(Fraction(value) for value in inside.tolist()), high))


def evaluate(code: Sequence[ValueInstruction], columns: Sequence[str], trace: Trace) -> NDArray[np.float64]:
    """The values of an expression in all rows, in the arithmetic of the monitors."""
    stack: list[NDArray[np.float64]] = []
    for instruction in code:
        match instruction.operator:
            case ValueOperator.CONSTANT:
                stack.append(np.full(trace.rows, instruction.operand))
            case ValueOperator.COLUMN:
                stack.append(trace.columns[columns[int(instruction.operand)]].astype(np.float64))
            case ValueOperator.NEGATE:
                stack.append(-stack.pop())
            case ValueOperator.ABSOLUTE:
                stack.append(abs(stack.pop()))
            case (
                ValueOperator.ADD
                | ValueOperator.SUBTRACT
                | ValueOperator.MULTIPLY
                | ValueOperator.DIVIDE
                | ValueOperator.MODULO
                | ValueOperator.MINIMUM
                | ValueOperator.MAXIMUM
            ):
                right, left = stack.pop(), stack.pop()
                with np.errstate(all="ignore"):
                    stack.append(_BINARY[instruction.operator](left, right))
    return stack[0][np.isfinite(stack[0])]


_BINARY = {
    ValueOperator.ADD: np.add,
    ValueOperator.SUBTRACT: np.subtract,
    ValueOperator.MULTIPLY: np.multiply,
    ValueOperator.DIVIDE: np.divide,
    ValueOperator.MODULO: np.fmod,
    ValueOperator.MINIMUM: np.minimum,
    ValueOperator.MAXIMUM: np.maximum,
}
