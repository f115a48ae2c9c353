"""The result of an expression in all discrete states, case by case: only the slots that it reads distinguish cases."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, SupportsIndex, TypeVar

from tachk.api.plugin import (
    Environment,
    EvaluationFault,
    Network,
    PreparedNetwork,
    VariableLayout,
    process_expressions,
    slot_count,
    written_variables,
)

LARGEST_RANGE = 4096
"""So many values may a variable have that decides between cases."""
MOST_CASES = 20_000


T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class SlotCondition:
    """The content of a slot is in ``[low, high]``; a negative slot ``-1 - p`` is the location of process p."""

    slot: int
    low: int
    high: int


@dataclass(frozen=True, slots=True)
class MuntaCase(Generic[T]):
    """The result where all conditions hold."""

    conditions: tuple[SlotCondition, ...]
    outcome: T


class TooManyCasesError(Exception):
    """An expression reads too many slots for a list of cases.

    Attributes:
        slot: one that it reads.
    """

    def __init__(self, slot: int) -> None:
        super().__init__(slot)
        self.slot = slot


class _UnreadError(Exception):
    """The content of a slot is needed."""

    def __init__(self, slot: int) -> None:
        super().__init__(slot)
        self.slot = slot


class KnownContents(list[int]):
    """The contents of slots as far as they are known.

    Attributes:
        read: the slots that were read since this was last emptied, unless they had been written before.
        written: the slots that were written.
    """

    def __init__(self, contents: Sequence[int], unknown: frozenset[int], offset: int = 0) -> None:
        super().__init__(contents)
        self._unknown = unknown
        self._offset = offset
        self.read: set[int] = set()
        self.written: set[int] = set()

    def __getitem__(self, position: SupportsIndex | slice) -> Any:
        for slot in self._slots(position):
            if slot not in self.written:
                self.read.add(slot)
                if slot in self._unknown:
                    raise _UnreadError(slot if not self._offset else self._offset - slot)
        return super().__getitem__(position)

    def __setitem__(self, position: SupportsIndex | slice, value: Any) -> None:
        self.written.update(self._slots(position))
        super().__setitem__(position, value)

    def settle(self, slot: int, value: int) -> None:
        """Sets the content of a slot from now on; that counts neither as read nor as written."""
        super().__setitem__(slot, value)
        self._unknown -= {slot}

    def _slots(self, position: SupportsIndex | slice) -> Sequence[int]:
        return range(*position.indices(len(self))) if isinstance(position, slice) else (position.__index__(),)


@dataclass(frozen=True, slots=True)
class CaseFinder:
    """Attributes:
    unknown: the slots whose content differs between states; all others always have what they begin with.
    sizes: how many locations each process has.
    ranges: of each slot, what it may hold.
    """

    layout: VariableLayout
    unknown: frozenset[int]
    sizes: tuple[int, ...]
    ranges: tuple[tuple[int, int], ...]

    def range_of(self, slot: int) -> tuple[int, int]:
        """A slot, or the location of a process: the subject of a condition."""
        return self.ranges[slot] if slot >= 0 else (0, self.sizes[-1 - slot] - 1)

    def find(self, outcome: Callable[[Environment, KnownContents], T | None]) -> list[MuntaCase[T]]:
        """The cases that have an outcome. Where the expression has a run-time error there is none.

        Neighbouring values of a slot that make no difference are one case. Raises TooManyCasesError.
        """
        budget = iter(range(MOST_CASES))
        return list(self._cases(outcome, {}, budget))

    def _cases(
        self,
        outcome: Callable[[Environment, KnownContents], T | None],
        chosen: Mapping[int, int],
        budget: Iterator[int],
    ) -> tuple[MuntaCase[T], ...]:
        try:
            found = outcome(*self._environment(chosen))
        except EvaluationFault:
            return ()
        except _UnreadError as unread:
            slot = unread.slot
        else:
            return () if found is None else (MuntaCase((), found),)
        low, high = self.range_of(slot)
        if high - low >= LARGEST_RANGE:
            raise TooManyCasesError(slot)
        groups: list[tuple[int, int, tuple[MuntaCase[T], ...]]] = []
        for value in range(low, high + 1):
            if next(budget, None) is None:
                raise TooManyCasesError(slot)
            inner = self._cases(outcome, {**chosen, slot: value}, budget)
            if groups and groups[-1][2] == inner:
                groups[-1] = (groups[-1][0], value, inner)
            else:
                groups.append((value, value, inner))
        if len(groups) == 1:
            return groups[0][2]
        return tuple(
            MuntaCase((SlotCondition(slot, first, last), *case.conditions), case.outcome)
            for first, last, cases in groups
            for case in cases
        )

    def _environment(self, chosen: Mapping[int, int]) -> tuple[Environment, KnownContents]:
        contents = [chosen.get(slot, value) for slot, value in enumerate(self.layout.initial)]
        values = KnownContents(contents, self.unknown - chosen.keys())
        processes = range(len(self.sizes))
        locations = KnownContents(
            [chosen.get(-1 - p, 0) for p in processes], frozenset(p for p in processes if -1 - p not in chosen), -1
        )
        return Environment(self.layout, values, locations), values


def case_finder(model: PreparedNetwork, ranges: Mapping[int, tuple[int, int]] | None = None) -> CaseFinder:
    """A finder of cases for a network. What no edge writes, and meta variables, have what they begin with.

    Args:
        ranges: smaller ones than those declared.
    """
    layout = model.layout
    smaller = ranges or {}
    unknown = {
        slot
        for variable in _written(model.network)
        for slot in range(layout.first[variable], layout.first[variable] + slot_count(variable.type))
        if not layout.meta[slot] and layout.ranges[slot][0] != layout.ranges[slot][1]
    }
    return CaseFinder(
        layout,
        frozenset(unknown),
        tuple(len(p.locations) for p in model.network.processes),
        tuple(smaller.get(slot, declared) for slot, declared in enumerate(layout.ranges)),
    )


def _written(network: Network) -> set[Any]:
    written = written_variables([e for process in network.processes for e in process_expressions(process)])
    return {variable for variable in network.all_variables() if variable in written}
