"""The answers of `tachk step` to the lines that are typed: text in, text out."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from pathlib import Path
from random import Random

from tachk.base.diagnostics.diagnostic import TachkError
from tachk.base.exact_numbers import DIGITS, exact_number, is_whole
from tachk.base.job import check_job
from tachk.base.whole_files import write_whole
from tachk.meaning.run_view import RunNames, Snapshot
from tachk.meaning.step import StepError
from tachk.model.fault import EvaluationFault
from tachk.model.quantity import decimal, duration
from tachk.report.run.trace_text import change_lines, event_lines
from tachk.simulation.stepping.enabled import EnabledTransition
from tachk.simulation.stepping.files import constants_of, read_submitted
from tachk.simulation.stepping.reasons import why_no_delay
from tachk.simulation.stepping.rejections import rejection_diagnostic
from tachk.simulation.stepping.run_file import SUFFIX, run_text
from tachk.simulation.stepping.session import NotPossibleError, Session

HELP = """\
A number takes a transition of the list, as soon as it is possible: 2
With @ it is taken after a delay of the interval in front of it:    2 @ 7.5

  delay D      lets D time units pass                    d 3.5
  random [N]   takes N random steps, 1 without a number  r 20
  undo [N]     takes steps back                          u
  redo [N]     goes forward again                        red
  goto N       goes to the state after step N            g 4
  list         lists the possible steps again            l
  show [NAME]  values of variables and clocks; with a    s x
               name only those it begins
  history      the run up to here                        h
  save FILE    writes the run for tachk replay           save my.run
  load FILE    takes a run from a file
  restart      goes back to the initial state
  help         this text                                 ?
  quit         ends                                      q

Commands may be shortened. The list shows after which delays, counted from now, each
transition is possible: [3, 5] is from 3 to 5, (3, 5] not at 3 itself, [3, ∞) from 3 on."""

_TAKE = re.compile(rf"({DIGITS})\s*(?:@\s*(\S+)|(?:after|in)\s+(\S+))?")
_SHORT = {
    "?": "help",
    "r": "random",
    "u": "undo",
    "g": "goto",
    "l": "list",
    "s": "show",
    "h": "history",
    "q": "quit",
    "exit": "quit",
}
_MOST_RANDOM = 10_000


class QuitError(Exception):
    """The command `quit` was given."""


class NotUnderstoodError(ValueError):
    """A line that cannot be obeyed; the message says why."""


class Stepper:
    """Answers lines.

    Attributes:
        session: the run under way.
    """

    def __init__(self, session: Session, model: str, constants: Mapping[str, int], seed: int = 0) -> None:
        """Args:
        constants: those that were given another value.
        """
        self.session = session
        self._model = model
        self._constants = constants
        self._random = Random(seed)
        self._commands: dict[str, Callable[[str], Iterator[str]]] = {
            "delay": self._delay,
            "random": self._take_random,
            "undo": self._undo,
            "redo": self._redo,
            "goto": self._goto,
            "list": lambda _: self._possibilities(),
            "show": self._show,
            "history": lambda _: self._history(),
            "save": self._save,
            "load": self._load,
            "restart": lambda _: self._moved(self.session.at(0)),
            "help": lambda _: iter(HELP.splitlines()),
            "quit": self._quit,
        }

    def greeting(self) -> Iterator[str]:
        yield from self._where()
        yield from self._possibilities()

    def answer(self, line: str) -> Iterator[str]:
        """The lines that answer a command. Raises NotUnderstoodError, and QuitError."""
        words = line.strip()
        if not words or words.startswith("#"):
            return
        taken = _TAKE.fullmatch(words)
        try:
            if taken is not None:
                yield from self._take(int(taken[1]), taken[2] or taken[3])
                return
            name, _, rest = words.partition(" ")
            yield from self._commands[self._command(name)](rest.strip())
        except (NotPossibleError, StepError, TachkError, OSError) as error:
            raise NotUnderstoodError(str(error)) from None
        except EvaluationFault as fault:
            raise NotUnderstoodError(f"a run-time error of the model: {fault} ({fault.span})") from None

    def _command(self, name: str) -> str:
        lower = _SHORT.get(name.lower(), name.lower())
        fitting = [command for command in self._commands if command.startswith(lower)]
        if lower in self._commands:
            return lower
        if not fitting:
            raise NotUnderstoodError(f"there is no command {name!r}; help lists them")
        if len(fitting) > 1:
            raise NotUnderstoodError(f"{name!r} may be {' or '.join(fitting)}")
        return fitting[0]

    # ---- transitions ------------------------------------------------------------------------------------------------

    def _take(self, number: int, waited: str | None) -> Iterator[str]:
        enabled = self.session.enabled().transitions
        if not 1 <= number <= len(enabled):
            known = f"the list has 1 to {len(enabled)}" if enabled else "nothing can happen"
            raise NotUnderstoodError(f"there is no transition {number}; {known}")
        yield from self._moved(self.session.take(enabled[number - 1], None if waited is None else _time(waited)))

    def _delay(self, rest: str) -> Iterator[str]:
        waited = _time(rest)
        try:
            yield from self._moved(self.session.wait(waited))
        except StepError:
            reason = why_no_delay(self.session.names, self.session.state, waited)
            places = [f"  {label.span}: {label.text}" for label in reason.labels]
            raise NotUnderstoodError("\n".join([reason.message, *places])) from None

    def _take_random(self, rest: str) -> Iterator[str]:
        for _ in range(min(_count(rest), _MOST_RANDOM)):
            check_job()
            self.session = self.session.random(self._random)
            yield from self._step_taken()
        yield from self._possibilities()

    def _undo(self, rest: str) -> Iterator[str]:
        return self._moved(self.session.at(self.session.position - _count(rest)))

    def _redo(self, rest: str) -> Iterator[str]:
        return self._moved(self.session.at(self.session.position + _count(rest)))

    def _goto(self, rest: str) -> Iterator[str]:
        return self._moved(self.session.at(_count(rest, None)))

    def _moved(self, session: Session) -> Iterator[str]:
        forward = session.position == self.session.position + 1
        self.session = session
        yield from self._step_taken() if forward else self._where()
        yield from self._possibilities()

    # ---- files ------------------------------------------------------------------------------------------------------

    def _save(self, rest: str) -> Iterator[str]:
        if not rest:
            raise NotUnderstoodError("save needs the name of a file, such as my.run")
        yield from self.save(Path(rest))

    def save(self, path: Path) -> Iterator[str]:
        """Writes the run up to here; the line says where it is."""
        path = path if path.suffix else path.with_suffix(SUFFIX)
        text = run_text(self.session.names, self.session.trace, [f"a run of {self._model}"], self._constants)
        write_whole(path, text)
        steps = "1 step" if self.session.position == 1 else f"{self.session.position} steps"
        yield f"saved {steps} to {path}; to show them: tachk replay {self._model} {path}"

    def _load(self, rest: str) -> Iterator[str]:
        if not rest:
            raise NotUnderstoodError("load needs the name of a file")
        submitted = read_submitted(Path(rest))
        other = constants_of(submitted, dict(self.session.names.network.constants), {})
        if other:
            options = " ".join(f"-D {name}={value}" for name, value in other.items())
            raise NotUnderstoodError(f"{rest} is a run of another model; start with {options}")
        session, rejection = self.session.loaded(submitted)
        if rejection is not None:
            yield f"not all of it is a run: {rejection_diagnostic(rejection).message}"
        yield from self._moved(session.at(session.position))

    def _quit(self, rest: str) -> Iterator[str]:
        raise QuitError

    # ---- display ----------------------------------------------------------------------------------------------------

    @property
    def _names(self) -> RunNames:
        return self.session.names

    def _snapshot(self, position: int) -> Snapshot:
        return self._names.timed_snapshot(self.session.at(position).state)

    def _where(self) -> Iterator[str]:
        """The state: where processes are, and the variables that are not 0."""
        session = self.session
        state = self._snapshot(session.position)
        unit = self._names.network.time_unit
        after = f"after step {session.position} of {len(session.steps)}" if session.steps else "start"
        yield f"{after}, time {duration(session.state.time, unit)}"
        yield from _wrapped([f"{process}.{location}" for process, location in state.locations])
        yield from _wrapped([f"{name} = {_shown(value)}" for name, value in state.variables if value])
        yield from _wrapped([f"{name} = {decimal(value)}" for name, value in state.clocks or ()])

    def _step_taken(self) -> Iterator[str]:
        """The last step: what happened, and what it changed."""
        session = self.session
        step = session.steps[session.position - 1]
        unit = self._names.network.time_unit
        waited = f" (+{duration(step.delay, unit)})" if step.delay else ""
        yield f"step {session.position}, time {duration(step.state.time, unit)}{waited}"
        before = session.at(session.position - 1).state
        if step.transition is None:
            yield "  time passes"
        else:
            for line in event_lines(self._names.event(before.discrete, step.transition), 100):
                yield f"  {line.plain}"
        for changed in change_lines(self._snapshot(session.position - 1), self._snapshot(session.position)):
            yield f"  {changed.plain}"

    def _possibilities(self) -> Iterator[str]:
        enabled = self.session.enabled()
        for fault in enabled.faults:
            yield f"a run-time error is possible: {fault} ({fault.span})"
        if not enabled.transitions:
            yield "nothing can happen any more" + (", time passes for ever" if enabled.delays.last is None else "")
            return
        yield "possible steps, after a delay in"
        rows = [(" or ".join(map(str, choice.windows)), self._lines_of(choice)) for choice in enabled.transitions]
        width = max(len(when) for when, _ in rows)
        for number, (when, lines) in enumerate(rows, start=1):
            first, *others = lines
            yield f"{number:4}  {when:<{width}}  {first}"
            yield from (f"{'':4}  {'':<{width}}  {line}" for line in others)
        if enabled.delays.last is not None:
            bound = "at most" if enabled.delays.last_belongs else "less than"
            yield (
                f"time can pass for {bound} {decimal(enabled.delays.last)}"
                if enabled.delays.last
                else "no time can pass"
            )

    def _lines_of(self, choice: EnabledTransition) -> list[str]:
        event = self._names.event(self.session.state.discrete, choice.transition)
        return [line.plain for line in event_lines(event, 100)]

    def _show(self, rest: str) -> Iterator[str]:
        state = self._snapshot(self.session.position)
        values = [
            *((process, location) for process, location in state.locations),
            *((name, _shown(value)) for name, value in state.variables),
            *((name, decimal(value)) for name, value in state.clocks or ()),
        ]
        found = [(name, value) for name, value in values if name.startswith(rest) or name.endswith(f".{rest}")]
        if not found:
            raise NotUnderstoodError(f"no process, variable or clock begins with {rest}")
        width = max(len(name) for name, _ in found)
        yield from (f"  {name:<{width}}  {value}" for name, value in found)

    def _history(self) -> Iterator[str]:
        here = self.session
        yield f"{' ' if here.position else '→'}    0  start"
        for position in range(1, len(here.steps) + 1):
            step = here.steps[position - 1]
            text = "time passes"
            if step.transition is not None:
                text = str(self._names.event(here.at(position - 1).state.discrete, step.transition))
            mark = "→" if position == here.position else " "
            yield f"{mark}{position:5}  {decimal(step.state.time)}  {text}"


def _shown(value: int | bool) -> str:
    return str(value).lower()


def _wrapped(parts: list[str], width: int = 100) -> Iterator[str]:
    line = ""
    for part in parts:
        if line and len(line) + len(part) + 2 > width:
            yield f"  {line},"
            line = part
        else:
            line = f"{line}, {part}" if line else part
    if line:
        yield f"  {line}"


def _time(text: str) -> Fraction:
    try:
        return exact_number(text)
    except ValueError:
        raise NotUnderstoodError(
            f"{text[:40] or 'nothing'} is not a number of time units, such as 2.5 or 7/3"
        ) from None


def _count(text: str, default: int | None = 1) -> int:
    if not text and default is not None:
        return default
    if not is_whole(text):
        raise NotUnderstoodError(f"{text or 'nothing'} is not a number of steps")
    return int(text)
