"""A run as text: what happens, when, and what it changes. Repeated rounds are shown once."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from fractions import Fraction

from rich.console import Console
from rich.text import Text

from tachk.base.records import dataclass
from tachk.base.words import Direction
from tachk.meaning.run_view import ProcessMove, Snapshot, TraceView, TransitionView, ViewStep
from tachk.model.quantity import duration, grouped
from tachk.model.run import Ending
from tachk.report.run.display import Ends, RunDisplay

_SAVED = 4
"""The report folds a repetition if that saves at least this many steps (or rounds, in rounds of rounds)."""

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
        """The repeated blocks of a length: the first item and the number of times; from left to right, disjoint."""
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


_ARRAY_TOGETHER = 3

_COLUMNS = 120
"""A line is not made longer than that by putting more into it."""


def print_trace(trace: TraceView, console: Console, time_unit: str = "", display: RunDisplay = RunDisplay()) -> None:
    """Prints a run."""
    shown = trace if display.every_step else trace.without_hidden()
    writer = _RunWriter(shown, time_unit, display.clocks, min(_COLUMNS, console.width))
    start = len(shown.steps) if shown.loop_start is None else shown.loop_start
    stem, loop = (_items(shown, a, b, display.every_step) for a, b in ((0, start), (start, len(shown.steps))))
    ends = Ends(len(stem) + len(loop) + 1, 0) if display.every_step else display.ends
    console.print(writer.text(stem, loop, ends), end="", soft_wrap=True)


def _items(trace: TraceView, begin: int, end: int, every_step: bool) -> Sequence[Single | Round]:
    """Some steps of a run: a loop at its end is not joined with the steps before it."""
    if every_step:
        return [Single(number) for number in range(begin, end)]
    return [_later(item, begin) for item in fold_rounds(trace.steps[begin:end])]


def _later(item: Single | Round, steps: int) -> Single | Round:
    if isinstance(item, Single):
        return Single(item.number + steps)
    return Round(tuple(_later(inner, steps) for inner in item.block), item.times, item.length)


def event_lines(event: TransitionView, room: int = 0) -> Iterator[Text]:
    """The moves of processes, with the documentation of the edge or else of the location it leads to.

    Args:
        room: columns of a line; what the documentation says stands in the same line where it fits.
    """
    for move in event.moves:
        line = _move_line(event.channel, move)
        words = Text(" ".join((move.doc or move.arrival).split()), style="italic")
        if words and line.cell_len + 3 + words.cell_len <= room:
            yield line.append(" · ").append_text(words)
            continue
        yield line
        if words:
            yield Text("  ").append_text(words)


_LOOP_BEGINNING = 20
"""The least number of steps and rounds of a loop that are shown."""

_ENDINGS = {
    Ending.IDLE: "∞ from here on time passes for ever, and nothing else need happen",
    Ending.STUCK: "⊣ from here on nothing can happen any more",
}


@dataclass(frozen=True, slots=True)
class _FoldedItems:
    """The items that are shown: those at both ends, and the number of steps left out between them."""

    beginning: Sequence[Single | Round]
    left_out: int
    end: Sequence[Single | Round]

    @staticmethod
    def of(items: Sequence[Single | Round], ends: Ends) -> _FoldedItems:
        if len(items) <= ends.beginning + ends.end + 1:
            return _FoldedItems(items, 0, ())  # saying that one is left out would save nothing
        between = items[ends.beginning : len(items) - ends.end]
        return _FoldedItems(
            items[: ends.beginning], sum(item.length for item in between), items[len(items) - ends.end :]
        )


class _RunWriter:
    """Writes the lines of one run."""

    def __init__(self, trace: TraceView, time_unit: str, clocks: bool, columns: int) -> None:
        self._trace = trace
        self._unit = time_unit
        self._clocks = clocks
        self._columns = columns
        self._lines = Text()
        self._width = 0

    def text(self, stem: Sequence[Single | Round], loop: Sequence[Single | Round], ends: Ends) -> Text:
        parts = [_FoldedItems.of(stem, ends)]
        if loop:
            parts.append(_FoldedItems.of(loop, Ends(max(ends.beginning, _LOOP_BEGINNING), ends.end)))
        numbers = [number for part in parts for number in _numbers([*part.beginning, *part.end])]
        self._width = max(len(self._when(number)) for number in (0, *(n + 1 for n in numbers)))
        if ends.beginning or not parts[0].left_out:
            self._step(0, list(_start_lines(self._trace.initial, self._clocks)))
        for number, part in enumerate(parts):
            if number == 1:
                self._note(self._loop_words())
            for item in part.beginning:
                self._item(item)
            if part.left_out:
                self._lines.append(f"  ...  ({grouped(part.left_out)} steps)\n", style="dim")
            for item in part.end:
                self._item(item)
        if self._trace.ending in _ENDINGS:
            self._note(_ENDINGS[self._trace.ending])
        return self._lines

    def _loop_words(self) -> str:
        if self._trace.ending is Ending.RECURRENT:
            return "↻ from here on this repeats for ever, with delays that differ from round to round:"
        steps = self._trace.steps[self._trace.loop_start :]
        period = sum((step.delay for step in steps if step.delay is not None), Fraction(0))
        if not period:
            return "↻ from here on this repeats for ever, and no time passes:"
        return f"↻ from here on this repeats for ever, every {duration(period, self._unit)}:"

    def _item(self, item: Single | Round) -> None:
        if isinstance(item, Single):
            self._single(item.number)
            return
        for inner in item.block:
            self._item(inner)
        self._repetition(item)

    def _single(self, number: int) -> None:
        step = self._trace.steps[number]
        details = (
            [Text("time passes")]
            if step.event is None
            else list(event_lines(step.event, self._columns - self._width - 9))
        )
        details += change_lines(self._state(number), step.state)
        if self._clocks and step.state.clocks:
            details.append(_clock_line(step.state.clocks))
        self._step(number + 1, details)

    def _repetition(self, item: Round) -> None:
        first, last = item.number + 1, item.number + item.round_length
        end = item.number + item.length
        steps = f"step {first} happens" if first == last else f"steps {first} to {last} happen"
        words = f"↻ {steps} {item.times} times in a row"
        delays = [step.delay for step in self._trace.steps[item.number : last]]
        period = sum((delay for delay in delays if delay is not None), Fraction(0))
        if period:
            words += f", every {duration(period, self._unit)}"
        time = self._trace.steps[end - 1].state.time
        words += f", to step {end}" + (f" at {duration(time, self._unit)}" if period and time is not None else "")
        self._note(words)
        for line in change_lines(self._state(last), self._state(end)):
            self._lines.append(" " * (self._width + 9)).append_text(line).append("\n")

    def _state(self, number: int) -> Snapshot:
        """The state after that many steps."""
        return self._trace.initial if number == 0 else self._trace.steps[number - 1].state

    def _when(self, number: int) -> str:
        """The time after that many steps, with the delay of the last one."""
        time = self._state(number).time
        if time is None:
            return ""
        delay = self._trace.steps[number - 1].delay if number else None
        waited = f" (+{duration(delay, self._unit)})" if delay else ""
        return duration(time, self._unit) + waited

    def _note(self, words: str) -> None:
        self._lines.append(" " * (self._width + 9)).append(words, style="cyan").append("\n")

    def _step(self, number: int, details: Sequence[Text]) -> None:
        margin = f"{number:5}  {self._when(number):<{self._width}}  "
        for detail in details:
            self._lines.append(margin, style="cyan").append_text(detail).append("\n")
            margin = " " * len(margin)


def _numbers(items: Sequence[Single | Round]) -> Iterator[int]:
    for item in items:
        if isinstance(item, Single):
            yield item.number
        else:
            yield from _numbers(item.block)


def _start_lines(state: Snapshot, clocks: bool) -> Iterator[Text]:
    yield Text("start in " + ", ".join(f"{process}.{location}" for process, location in state.locations))
    variables = [f"{name} = {_value(value)}" for name, value in state.variables if value]
    if variables:
        rest = ", all other variables 0" if len(variables) < len(state.variables) else ""
        yield Text("  " + ", ".join(variables) + rest)
    if clocks and state.clocks:
        yield _clock_line(state.clocks)


def _move_line(channel: str, move: ProcessMove) -> Text:
    line = Text()
    if move.direction is not None:
        mark = "!" if move.direction is Direction.SEND else "?"
        line.append(f"{channel}{mark}  ", style="bold")
    line.append(f"{move.process}: {move.source} → {move.target}")
    selects = [f"{name} = {value}" for name, value in move.selects if name not in move.named_by_channel]
    if selects:
        line.append("  [" + ", ".join(selects) + "]")
    return line


def change_lines(before: Snapshot, after: Snapshot) -> list[Text]:
    """The variables that a step has changed, with their old and new values."""
    groups: list[list[tuple[str, int | bool, int | bool]]] = []
    last = ("", -1)
    pairs = zip(before.variables, after.variables, strict=True)
    for position, ((name, old), (_, new)) in enumerate(pairs):
        if old != new:
            array = name.rpartition("[")[0] if name.endswith("]") else ""
            if array and last == (array, position - 1):
                groups[-1].append((name, old, new))
            else:
                groups.append([(name, old, new)])
            last = (array, position)
    return [Text("  " + ", ".join(map(_group, groups)))] if groups else []


def _group(changes: list[tuple[str, int | bool, int | bool]]) -> str:
    """Changes of one variable, or of neighbouring slots of one array: ``a[0..2]: 1 2 0 → 2 0 0``."""
    if len(changes) < _ARRAY_TOGETHER:
        return ", ".join(f"{name}: {_value(old)} → {_value(new)}" for name, old, new in changes)
    name = f"{changes[0][0][:-1]}..{changes[-1][0].rpartition('[')[2]}"
    olds = " ".join(_value(old) for _, old, _ in changes)
    news = " ".join(_value(new) for _, _, new in changes)
    return f"{name}: {olds} → {news}"


def _clock_line(clocks: tuple[tuple[str, Fraction], ...]) -> Text:
    return Text("  " + ", ".join(f"{name} = {value}" for name, value in clocks), style="dim")


def _value(value: int | bool) -> str:
    return str(value).lower()
