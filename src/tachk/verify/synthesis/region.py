"""The values of constants for which a property holds, with the evidence for each answer."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import product
from math import prod

from tachk.base.words import QueryKind
from tachk.model.query import Query
from tachk.verify.certificates import Proof
from tachk.verify.synthesis.bounds_of_parameters import NoBound, ParameterBound
from tachk.verify.synthesis.inequalities import Description
from tachk.verify.synthesis.parameters import VariedConstant
from tachk.verify.verdict import Answer, Verdict


class CellEvidence(StrEnum):
    """The evidence for the answer of a cell."""

    SEARCH = "search"
    """A search of its own: a replayed run, or all states explored."""
    RUN = "run of another cell"
    """The transitions of a run of another cell are possible here too, at other times: a replayed run."""
    CERTIFICATE = "certificate of another cell"
    """The set of states that was closed there is closed here too, as a checker that knows no engine has seen."""
    IMPLIED = "implied"
    """By another cell with more or with less behaviour."""
    NONE = "none"
    """It is not known."""


def shown_by_a_run(query: Query) -> Answer:
    """The answer for which one run is the evidence; the other one takes the exploration of all states."""
    existential = query.kind in (QueryKind.POSSIBLY, QueryKind.POTENTIALLY_ALWAYS)
    return Answer.HOLDS if existential else Answer.FAILS


@dataclass(frozen=True, slots=True)
class RegionCell:
    """One combination of values.

    Attributes:
        values: in the order of the parameters.
        reason: why the answer is unknown, else empty.
        verdict: of the search, or with the run; None where the answer is implied or not known.
        certificate: a proof that was checked, if proofs were requested and there is one.
    """

    values: tuple[int, ...]
    answer: Answer
    evidence: CellEvidence
    reason: str = ""
    verdict: Verdict | None = field(default=None, repr=False)
    certificate: Proof | None = field(default=None, repr=False)


@dataclass(frozen=True, slots=True)
class Region:
    """The cells of a box of values in which a property has the wanted answer.

    Attributes:
        model: the path of the model.
        query: as it is with the first values.
        wanted: the answer whose region this is.
        parameters: the constants that are varied.
        bounds: the proved direction of each of them, in their order.
        cells: all of them, the values of the last parameter changing fastest.
        description: inequalities that agree with all decided cells, where there are some.
        interrupted: Ctrl-C ended the work.
        constants: the other constants of the model with their values.
    """

    model: str
    query: Query = field(repr=False)
    wanted: Answer
    parameters: tuple[VariedConstant, ...]
    bounds: tuple[ParameterBound | NoBound, ...] = field(repr=False)
    cells: tuple[RegionCell, ...] = field(repr=False)
    description: Description | None
    interrupted: bool = False
    constants: tuple[tuple[str, int], ...] = field(default=(), repr=False)
    seconds: float = 0.0

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of values of each parameter."""
        return tuple(len(parameter.values) for parameter in self.parameters)

    @property
    def holding(self) -> tuple[tuple[int, ...], ...]:
        """The values with the wanted answer."""
        return tuple(cell.values for cell in self.cells if cell.answer is self.wanted)

    @property
    def unknown(self) -> tuple[RegionCell, ...]:
        return tuple(cell for cell in self.cells if cell.answer is Answer.UNKNOWN)

    @property
    def searched(self) -> int:
        """The number of cells that were searched."""
        return sum(cell.evidence is CellEvidence.SEARCH for cell in self.cells)

    def at(self, **values: int) -> RegionCell:
        """The cell with these values. Raises KeyError if it is none of the region."""
        numbers = []
        for parameter in self.parameters:
            if values.get(parameter.name) not in parameter.values:
                raise KeyError(f"{parameter} does not contain {parameter.name}={values.get(parameter.name)}")
            numbers.append(parameter.values.index(values[parameter.name]))
        return self.cells[self._place(numbers)]

    def _place(self, numbers: list[int] | tuple[int, ...]) -> int:
        place = 0
        for number, size in zip(numbers, self.shape, strict=True):
            place = place * size + number
        return place

    @property
    def corners(self) -> tuple[RegionCell, ...]:
        """The cells at which the border turns, of both sides: each was decided itself.

        A cell is one if a neighbour has another answer, and along each parameter the answer changes beside it or it is
        at the edge of the box. Along a monotone parameter only the side counts on which the answer is not implied.
        """
        return tuple(self._corners())

    def _corners(self) -> Iterator[RegionCell]:
        assert prod(self.shape) == len(self.cells)
        for place, numbers in enumerate(product(*map(range, self.shape))):
            cell = self.cells[place]
            if cell.evidence is CellEvidence.NONE or cell.evidence is CellEvidence.IMPLIED:
                continue
            differs = [self._changes(cell, numbers, axis) for axis in range(len(numbers))]
            if None not in differs and any(differs):
                yield cell

    def _changes(self, cell: RegionCell, numbers: tuple[int, ...], axis: int) -> bool | None:
        """True if the answer changes along an axis; None if the cell is between others of the same answer, or one of
        them implies it."""
        edge = differs = False
        for step in self._sides(cell, axis):
            number = numbers[axis] + step
            if not 0 <= number < self.shape[axis]:
                edge = True
            elif self.cells[self._place((*numbers[:axis], number, *numbers[axis + 1 :]))].answer is not cell.answer:
                differs = True
        return differs if differs or edge else None

    def _sides(self, cell: RegionCell, axis: int) -> tuple[int, ...]:
        reached = cell.answer is shown_by_a_run(self.query)
        match self.bounds[axis]:
            case ParameterBound.UPPER:
                return (-1,) if reached else (1,)
            case ParameterBound.LOWER:
                return (1,) if reached else (-1,)
            case _:
                return -1, 1
