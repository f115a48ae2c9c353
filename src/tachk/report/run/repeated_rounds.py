"""Repeated rounds of a run, found and put together.

A round is a block of steps with the same delays and the same events; what the steps do to variables may differ. Rounds
of rounds are found too, shorter ones first. Where it is free to begin, a round begins by waiting.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence

from tachk.base.records import dataclass
from tachk.meaning.run_view import TransitionView, ViewStep

_SAVED = 4
"""A repetition is told as one if that saves at least as many steps (or rounds, in rounds of rounds)."""

_EFFORT = 4_000_000
"""Comparisons of one pass over the run; they limit the length of a round."""

_LONGEST = 400


@dataclass(frozen=True, slots=True)
class Single:
    """One step.

    Attributes:
        number: of the step in the run, from 0.
    """

    number: int

    @property
    def length(self) -> int:
        return 1


@dataclass(frozen=True, slots=True)
class Round:
    """A block that happens several times in a row.

    Attributes:
        block: its first time.
        length: steps of all times together.
    """

    block: tuple[Single | Round, ...]
    times: int
    length: int

    @property
    def number(self) -> int:
        """The first step of the first time."""
        return self.block[0].number

    @property
    def round_length(self) -> int:
        """Steps of one time."""
        return self.length // self.times


def fold_rounds(steps: Sequence[ViewStep]) -> tuple[Single | Round, ...]:
    """The steps of a run in order, rounds put together."""
    row = _RunItems(steps)
    while True:
        before = len(row.items)
        period = 1
        while period <= min(_LONGEST, len(row.items) // 2, max(8, _EFFORT // max(1, len(row.items)))):
            row.fold(period)
            period += 1
        if len(row.items) == before:
            return tuple(row.items)


class _RunItems:
    """The items of a run while rounds are put together.

    Attributes:
        keys: equal for items that are the same but for values of variables.
        waits: whether the item begins with a delay.
    """

    def __init__(self, steps: Sequence[ViewStep]) -> None:
        self._numbers: dict[Hashable, int] = {}
        self.items: list[Single | Round] = [Single(number) for number in range(len(steps))]
        self.keys = [self._numbers.setdefault(_key(step), len(self._numbers)) for step in steps]
        self.waits = [bool(step.delay) for step in steps]

    def fold(self, period: int) -> None:
        """Puts every block of that many items together that is repeated often enough."""
        for start, times in reversed(list(self._repetitions(period))):
            end = start + times * period
            items = self.items[start:end]
            key = (times, *self.keys[start : start + period])
            self.items[start:end] = [Round(tuple(items[:period]), times, sum(item.length for item in items))]
            self.keys[start:end] = [self._numbers.setdefault(key, len(self._numbers))]
            self.waits[start:end] = [self.waits[start]]

    def _repetitions(self, period: int) -> Iterator[tuple[int, int]]:
        """Where blocks of a length are repeated: the first item and how many times; from left to right, apart."""
        keys = self.keys
        free = equal = 0
        for position in range(period, len(keys) + 1):
            if position < len(keys) and keys[position] == keys[position - period]:
                equal += 1
                continue
            start = max(free, position - period - equal)
            times = (position - start) // period
            if (times - 1) * period >= _SAVED:
                slack = range(start, position - times * period + 1)
                start = next((begin for begin in slack if self.waits[begin]), start)
                yield start, times
                free = start + times * period
            equal = 0


def _key(step: ViewStep) -> Hashable:
    return step.delay, None if step.event is None else _event_key(step.event)


def _event_key(event: TransitionView) -> Hashable:
    moves = ((move.process, move.source, move.target, move.selects, move.doc) for move in event.moves)
    return event.channel, tuple(moves)
