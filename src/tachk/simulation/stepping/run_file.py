"""Runs as text, a line for each step: what `tachk step` saves and people write.

    # comment
    constants N = 2, WAIT = 9
    0      P(1): idle -> request
    28/3   c[1]!  P(1): waiting -> critical #2 [i = 3] & Q: A -> B
    +2.5

A line begins with the time at which the step happens, or after ``+`` with the time since the step before. A line
without processes lets time pass. ``#2`` is the second of several edges between the same locations, brackets hold the
values of select variables. Both may be left out, as may the channel.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.exact_numbers import DIGITS
from tachk.base.span import Source, Span
from tachk.meaning.discrete import execute_updates, initial_discrete
from tachk.meaning.run_view import RunNames
from tachk.model.network import Network
from tachk.model.quantity import decimal
from tachk.model.run import DiscreteState, Participant, TimedTrace, Transition
from tachk.simulation.stepping.submitted import SubmittedMove, SubmittedRun, SubmittedStep

SUFFIX = ".run"
_DIGITS = 9
_TIME = re.compile(rf"(\+?)({DIGITS}(?:\.{DIGITS})?(?:/(?!0){DIGITS})?)(?=\s|$)")
_CHANNEL = re.compile(r"(\S+)[!?](?=\s|$)")
_MOVE = re.compile(
    r"(?P<process>.+?)\s*:\s*(?P<source>\w+)\s*(?:->|→)\s*(?P<target>\w+)"
    r"(?:\s*#(?P<number>[1-9]\d*))?(?:\s*\[(?P<selects>[^\]]*)\])?"
)
_VALUE = re.compile(r"(\w+)\s*=\s*(-?\d+)")


# ---- reading --------------------------------------------------------------------------------------------------------


def read_run_file(source: Source) -> SubmittedRun:
    """Raises InputError with every line that is not understood."""
    constants: dict[str, int] = {}
    steps: list[SubmittedStep] = []
    wrong: list[Diagnostic] = []
    begin = 0
    for line in source.text.splitlines(keepends=True):
        text = line.split("#", 1)[0] if line.lstrip().startswith("#") else line.rstrip("\n")
        span = Span(source, begin + len(text) - len(text.lstrip()), begin + len(text.rstrip()))
        begin += len(line)
        words = text.strip()
        if not words or words.startswith("model "):
            continue
        try:
            if words.startswith("constants "):
                constants.update(_values(words.removeprefix("constants ")))
            else:
                steps.append(_submitted_step(words, span))
        except ValueError as error:
            wrong.append(Diagnostic("E0922", str(error), span, "such as: 2.5 P: A -> B, or: +2.5"))
    if wrong:
        raise InputError(wrong)
    return SubmittedRun(source.name, constants, tuple(steps))


def _submitted_step(words: str, span: Span) -> SubmittedStep:
    time = _TIME.match(words)
    if time is None:
        raise ValueError("a step begins with the time at which it happens")
    whole, _, divisor = time[2].partition("/")
    rest = words[time.end() :].strip()
    channel = _CHANNEL.match(rest)
    rest = rest[channel.end() :].strip() if channel else rest
    if channel and not rest:
        raise ValueError("a step names the processes that move")
    moves = tuple(_move(part.strip()) for part in rest.split("&")) if rest and rest != "time passes" else ()
    return SubmittedStep(
        Fraction(whole) / int(divisor or 1), bool(time[1]), moves, channel[1] if channel else "", span=span
    )


def _move(text: str) -> SubmittedMove:
    match = _MOVE.fullmatch(text)
    if match is None:
        raise ValueError(f"{text!r} is not a process with its old and new location")
    number = int(match["number"]) if match["number"] else None
    return SubmittedMove(match["process"], match["source"], match["target"], number, _values(match["selects"] or ""))


def _values(text: str) -> dict[str, int]:
    found = {}
    for part in filter(None, (part.strip() for part in text.split(","))):
        match = _VALUE.fullmatch(part)
        if match is None:
            raise ValueError(f"{part!r} is not a name with a value")
        found[match[1]] = int(match[2])
    return found


# ---- writing --------------------------------------------------------------------------------------------------------


def run_text(names: RunNames, trace: TimedTrace, heading: Sequence[str] = (), constants: Mapping[str, int] = {}) -> str:
    """A run as text that is read as the same run.

    Args:
        heading: lines of comment.
        constants: those with which the model was loaded.
    """
    steps = ((step.state.time, step.transition) for step in trace.steps)
    return steps_text(names, steps, heading, constants)


def steps_text(
    names: RunNames,
    steps: Iterable[tuple[Fraction, Transition | None]],
    heading: Sequence[str] = (),
    constants: Mapping[str, int] = {},
) -> str:
    """The same of the steps from the initial state on, with their times."""
    return "".join(f"{line}\n" for line in (*_head(heading, constants), *_step_lines(names, steps)))


def _head(heading: Sequence[str], constants: Mapping[str, int]) -> Iterator[str]:
    yield from (f"# {line}" for line in heading)
    if constants:
        yield "constants " + ", ".join(f"{name} = {value}" for name, value in constants.items())


def _step_lines(names: RunNames, steps: Iterable[tuple[Fraction, Transition | None]]) -> Iterator[str]:
    discrete = initial_discrete(names.model)
    for time, transition in steps:
        yield step_line(names, discrete, exact_time(time), transition)
        if transition is not None:
            discrete, _ = execute_updates(names.model, discrete, transition)


def step_line(names: RunNames, before: DiscreteState, when: str, transition: Transition | None) -> str:
    """The line of one step.

    Args:
        when: its time, or ``+`` with the time since the step before.
    """
    if transition is None:
        return when
    channel = names.event(before, transition).channel
    moves = " & ".join(_move_text(names.network, each) for each in transition.participants)
    return f"{when:<8} {f'{channel}!  ' if channel else ''}{moves}"


def exact_time(time: Fraction) -> str:
    return decimal(time, _DIGITS)


def _move_text(network: Network, participant: Participant) -> str:
    process = network.processes[participant.process]
    edge = process.edges[participant.edge]
    alike = alike_edges(network, participant)
    number = f" #{alike.index(participant.edge) + 1}" if len(alike) > 1 else ""
    selects = ", ".join(
        f"{variable.name} = {value}" for variable, value in zip(edge.selects, participant.selects, strict=True)
    )
    places = f"{process.locations[edge.source].name} -> {process.locations[edge.target].name}"
    return f"{process.name}: {places}{number}{f' [{selects}]' if selects else ''}"


def alike_edges(network: Network, participant: Participant) -> list[int]:
    """The edges of its process between the same locations, in the order of the text."""
    edges = network.processes[participant.process].edges
    edge = edges[participant.edge]
    return [n for n, other in enumerate(edges) if (other.source, other.target) == (edge.source, edge.target)]
