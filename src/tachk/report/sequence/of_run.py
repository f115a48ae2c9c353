"""The sequence chart of a run of a model.

A process that synchronises sends a message that takes no time. What goes through a link of models/lib, into it on
``send[link][kind]`` and out of it on ``deliver[link][kind]``, is one message that takes the time in between; it may be
lost. Locations stand on the lifelines where they say why the property holds or fails: of processes that it names the
first one, those that they enter alone and those that it names; of the others the last one. Where no process sends
anything, all locations that processes enter are drawn. Repeated blocks of steps are drawn once.
"""

from __future__ import annotations

import re
from collections.abc import Container, Iterator, Mapping, Sequence
from fractions import Fraction

from tachk.base.records import dataclass, replace
from tachk.base.time_units import unit_in_text
from tachk.model.quantity import duration, ranges
from tachk.report.drawing.sequence.chart import (
    Category,
    Chart,
    EnteredLocation,
    Event,
    Message,
    Moment,
    Note,
    Phase,
    begun,
    lifelines_of,
)
from tachk.report.sequence.named_processes import named_members
from tachk.report.sequence.run_steps import RunStep, RunSteps

_THROUGH_A_LINK = re.compile(r"(send|deliver)\[(\w+)\]\[(\w+)\]")
_CATEGORIES = {
    "DATA": Category.DATA,
    "ACKNACK": Category.ANSWER,
    "ACCEPT": Category.ANSWER,
    "HEARTBEAT": Category.HEARTBEAT,
}
_ASLEEP = re.compile("asleep|deaf|sleeping", re.IGNORECASE)
_LONGEST_BLOCK = 24
_ORDERS = 3
"""Of moments in a step: its message, the locations that it enters, and the note that it is repeated."""

_SAVED = 6
"""A repetition is drawn once if that leaves out so many steps."""


def chart_of_run(run: RunSteps) -> Chart:
    """Processes from left to right as in the system line, without those that only listen; times of the model."""
    factor, unit = unit_in_text(run.unit)
    shown_steps, repeats = _folded(run)
    named = named_members(run.query, run.processes)
    lifelines = _lifelines(run, named)
    making = _Making(run, lifelines, named, factor)
    making.read()
    events: list[Event] = list(making.beginning())
    events += [event for number in shown_steps for event in making.events.get(number, ())]
    events += [
        _repetition(run, begin, steps, times, factor)
        for begin, steps, times in repeats
        if any(making.events.get(number) for number in range(begin, begin + steps))
    ]
    end = Moment(run.end * factor, _ORDERS * len(run.steps))
    events.sort(key=begun)
    events += making.ending(events, end)
    events.append(Note(None, Moment(end.time, end.order + 1), run.remark))
    phases = tuple(making.phases(end))
    description = f"{run.title}; a run of {len(run.steps)} steps, {sum(one.is_lost for one in run.steps)} messages lost"
    return Chart(run.title, description, unit, lifelines, tuple(events), phases)


def _lifelines(run: RunSteps, named: Container[str]) -> tuple[str, ...]:
    """Processes that send something, or receive from others than senders, and those that the property names and that
    move; those that move or that it names if no process sends."""
    moved = {process for step in run.steps for process in step.locations}
    if not run.has_messages:
        return tuple(process for process in run.processes if process in moved or process in named)
    carriers = {step.sender for step in run.steps if step.channel.startswith("deliver[")}
    active = {step.sender for step in run.steps if step.channel} - carriers
    chosen = set(active)
    for step in run.steps:
        receiving = [process for process in step.receivers if process not in carriers]
        if step.channel and not step.channel.startswith("send[") and not active.intersection(receiving):
            chosen.update(receiving[:1])
    chosen |= {process for step in run.steps for process, _ in step.news}
    chosen |= {process for process in moved if process in named}
    return tuple(process for process in run.processes if process in chosen)


@dataclass(frozen=True, slots=True)
class _UnderWay:
    """A message in a link: the number of its step, its kind and what it carries."""

    number: int
    kind: str
    payload: Mapping[str, int]


class _Making:
    """Makes messages of steps.

    Attributes:
        events: by the number of the step.
    """

    def __init__(
        self, run: RunSteps, lifelines: Sequence[str], named: Mapping[str, Container[str]], factor: Fraction
    ) -> None:
        self._run = run
        self._named = named
        self._lifeline = {process: number for number, process in enumerate(lifelines)}
        self._factor = factor
        self._draws_moves = not run.has_messages
        self._links: dict[str, list[_UnderWay]] = {}
        self._ends = self._far_ends()
        self._sent: set[tuple[str, int]] = set()
        self.events: dict[int, list[Event]] = {}

    def _far_ends(self) -> dict[str, tuple[int, ...]]:
        """The receivers at the end of each link."""
        found: dict[str, dict[int, None]] = {}
        for step in self._run.steps:
            link = _THROUGH_A_LINK.fullmatch(step.channel)
            if link is not None and link[1] == "deliver":
                for process in step.receivers:
                    if process in self._lifeline:
                        found.setdefault(link[2], {})[self._lifeline[process]] = None
        return {link: tuple(ends) for link, ends in found.items()}

    def read(self) -> None:
        for number, step in enumerate(self._run.steps):
            link = _THROUGH_A_LINK.fullmatch(step.channel)
            if link is not None and link[1] == "send":
                self._into(number, step, link[2], self._kind(link[3]))
            elif link is not None:
                self._out_of(number, step, link[2], self._kind(link[3]))
            elif step.channel:
                self._handshake(number, step)
            self._enter(number, step)
            for process, words in step.news:
                if process in self._lifeline:
                    note = Note(self._lifeline[process], self._moment(number), words)
                    self.events.setdefault(number, []).append(note)

    def _kind(self, index: str) -> str:
        """The name of a kind of messages, also where a run gives its number."""
        names = [name for name in (*_CATEGORIES, "READ", "PING") if str(self._run.constants.get(name)) == index]
        return names[0] if names else index

    def _moment(self, number: int) -> Moment:
        return Moment(self._run.steps[number].time * self._factor, _ORDERS * number)

    def _into(self, number: int, step: RunStep, link: str, kind: str) -> None:
        if step.sender not in self._lifeline:
            return
        sender = self._lifeline[step.sender]
        receivers = self._ends.get(link) or (sender + 1 if sender + 1 < len(self._lifeline) else sender - 1,)
        content = (link, step.payload.get("number", 0))
        again = kind == "DATA" and content in self._sent and "number" in step.payload
        if kind == "DATA":
            self._sent.add(content)
        category = _CATEGORIES.get(kind, Category.OTHER)
        label = _label(kind, step.payload)
        detail = f"{step.channel}, step {number + 1}"
        made = Message(sender, receivers, self._moment(number), (), label, detail, category, again, "", step.is_lost)
        self.events.setdefault(number, []).append(made)
        if not step.is_lost:
            self._links.setdefault(link, []).append(_UnderWay(number, kind, step.payload))

    def _out_of(self, number: int, step: RunStep, link: str, kind: str) -> None:
        waiting = self._links.get(link, [])
        arrived = next((one for one in waiting if one.kind == kind and _same(one.payload, step.payload)), None)
        if arrived is None:
            return
        if not step.is_copied:
            waiting.remove(arrived)
        made = self.events[arrived.number][0]
        assert isinstance(made, Message)
        receiving = tuple(self._lifeline[process] for process in step.receivers if process in self._lifeline)
        self.events[arrived.number][0] = replace(
            made, receivers=receiving or made.receivers, arrivals=(*made.arrivals, self._moment(number))
        )

    def _handshake(self, number: int, step: RunStep) -> None:
        receivers = tuple(self._lifeline[process] for process in step.receivers if process in self._lifeline)
        if step.sender in self._lifeline and receivers:
            moment = self._moment(number)
            detail = f"step {number + 1}"
            made = Message(self._lifeline[step.sender], receivers, moment, (moment,), step.channel, detail)
            self.events.setdefault(number, []).append(made)

    def _enter(self, number: int, step: RunStep) -> None:
        """The locations that matter among those that a step enters, below its message."""
        moment = self._moment(number)
        below = moment._replace(order=moment.order + 1)
        for process, place in step.locations.items():
            is_shown = self._draws_moves or (
                process in self._named and (not step.channel or place in self._named[process])
            )
            if process in self._lifeline and is_shown:
                entered = EnteredLocation(self._lifeline[process], below, place)
                self.events.setdefault(number, []).append(entered)

    def beginning(self) -> Iterator[EnteredLocation]:
        """The first locations of the processes that the property names, or of all where no process sends."""
        for process, lifeline in self._lifeline.items():
            if self._draws_moves or process in self._named:
                yield EnteredLocation(lifeline, Moment(Fraction(0), -1), self._run.initial[process])

    def ending(self, events: Sequence[Event], end: Moment) -> Iterator[EnteredLocation]:
        """The last locations of processes that have been in several, unless they are the last to stand there.

        Args:
            events: that are drawn, in order.
        """
        last = {lifeline: event for event in events for lifeline in lifelines_of(event)}
        for process, lifeline in self._lifeline.items():
            places = [step.locations[process] for step in self._run.steps if process in step.locations]
            initial, final = self._run.initial[process], (places or [""])[-1]
            if (process in self._named and places) or any(place != initial for place in places):
                before = last.get(lifeline)
                if not (isinstance(before, EnteredLocation) and before.text == final):
                    yield EnteredLocation(lifeline, end, final)

    def phases(self, end: Moment) -> Iterator[Phase]:
        """The phases in which processes are in locations whose names mean sleep."""
        since: dict[str, Moment] = {
            process: Moment(Fraction(0), -1) for process, place in self._run.initial.items() if _ASLEEP.search(place)
        }
        for number, step in enumerate(self._run.steps):
            for process, place in step.locations.items():
                if _ASLEEP.search(place):
                    since.setdefault(process, self._moment(number))
                elif process in since:
                    yield from self._phase(process, since.pop(process), self._moment(number))
        for process, begin in since.items():
            yield from self._phase(process, begin, end)

    def _phase(self, process: str, begin: Moment, end: Moment) -> Iterator[Phase]:
        if process in self._lifeline:
            yield Phase(self._lifeline[process], begin, end, "asleep")


def _same(sent: Mapping[str, int], come: Mapping[str, int]) -> bool:
    return all(sent.get(name) == come.get(name) for name in ("number", "detail"))


def _label(kind: str, payload: Mapping[str, int]) -> str:
    """A message of the protocol in its words; numbers count from 0."""
    if "number" not in payload:
        return kind
    number, detail = payload["number"], payload.get("detail", 0)
    match kind:
        case "ACKNACK":
            missing = [number + bit for bit in range(16) if detail >> bit & 1]
            return f"ACKNACK {number}{f' missing {ranges(missing)}' if missing else ''}"
        case "HEARTBEAT":
            return f"HEARTBEAT {number}..{detail - 1}"
        case "PING":
            return kind
        case _:
            return f"{kind} {number}"


def _folded(run: RunSteps) -> tuple[list[int], list[tuple[int, int, int]]]:
    """The steps that are drawn, and repetitions: from which step on, of how many steps, how many times in all."""
    keys = [_key(run.steps, number) for number in range(len(run.steps))]
    if not run.has_messages:
        keys = [(key, *sorted(step.locations.items())) for key, step in zip(keys, run.steps, strict=True)]
    shown_steps: list[int] = []
    repeats: list[tuple[int, int, int]] = []
    at = 0
    while at < len(keys):
        block, times = _block(keys, at)
        shown_steps += range(at, at + block)
        if times > 1:
            repeats.append((at, block, times))
        at += block * times
    return shown_steps, repeats


def _block(keys: Sequence[object], at: int) -> tuple[int, int]:
    """The block that begins at a step and is repeated so that most steps are saved; a single step if none is."""
    best = (1, 1)
    for block in range(1, min(_LONGEST_BLOCK, (len(keys) - at) // 2) + 1):
        times = 1
        while keys[at : at + block] == keys[at + times * block : at + (times + 1) * block]:
            times += 1
        if (times - 1) * block >= max(_SAVED, (best[1] - 1) * best[0] + 1):
            best = (block, times)
    return best


def _key(steps: Sequence[RunStep], number: int) -> tuple[object, ...]:
    step = steps[number]
    delay = step.time - (steps[number - 1].time if number else 0)
    payload = tuple(sorted(step.payload.items()))
    return delay, step.channel, step.sender, step.receivers, payload, step.is_lost, step.news


def _repetition(run: RunSteps, begin: int, block: int, times: int, factor: Fraction) -> Note:
    first, last = run.steps[begin + block - 1], run.steps[begin + block * times - 1]
    text = f"↻ {times} times"
    if last.time > first.time:
        period = (last.time - first.time) / (times - 1)
        text += f", every {duration(period, run.unit)}, until {duration(last.time, run.unit)}"
    return Note(None, Moment(first.time * factor, _ORDERS * (begin + block) - 1), text)
