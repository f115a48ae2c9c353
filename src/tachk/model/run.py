"""Runs of a network as values: which edges fire, and, for timed traces, when."""

from __future__ import annotations

from enum import StrEnum
from fractions import Fraction

from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.model.fault import RuntimeErrorKind


@dataclass(frozen=True, slots=True)
class Participant:
    """A process that takes part in a transition, and how.

    Attributes:
        process: process number.
        edge: number of the edge in the process.
        selects: the values of the edge's select variables.
    """

    process: int
    edge: int
    selects: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Transition:
    """One internal edge, a sender and a receiver, or a broadcast sender and its receivers in process order."""

    participants: tuple[Participant, ...]


@dataclass(frozen=True, slots=True)
class DiscreteState:
    """Attributes:
    locations: one location number for each process.
    values: one value for each slot of `Network.all_variables` in order; slots of clocks (numbered from 1) and channels
        (numbered from 0) hold their numbers.
    """

    locations: tuple[int, ...]
    values: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class TimedState:
    """Attributes:
    clocks: the value of every clock; entry i belongs to clock number i + 1.
    time: time since the start of the run.
    """

    discrete: DiscreteState
    clocks: tuple[Fraction, ...]
    time: Fraction


@dataclass(frozen=True, slots=True)
class TimedStep:
    """First ``delay`` passes, then the transition fires (None: the trace ends after the delay); ``state`` is after."""

    delay: Fraction
    transition: Transition | None
    state: TimedState


class Ending(StrEnum):
    """The end of a run after its last step."""

    OPEN = "open"
    """Anything: the run has shown what it has to show."""
    IDLE = "idle"
    """Time passes for ever, and nothing else need happen."""
    STUCK = "stuck"
    """Nothing can happen any more, at whatever time."""
    PERIODIC = "periodic"
    """The steps from `TimedTrace.loop_start` on are taken again and again, with the same delays."""
    RECURRENT = "recurrent"
    """The transitions from `TimedTrace.loop_start` on can be taken again and again, with delays that differ."""


@dataclass(frozen=True, slots=True)
class Due:
    """A moment of a run, from which on something is awaited.

    Attributes:
        steps: how many steps come before it; it may lie within the delay of the next one.
        time: since the start of the run.
    """

    steps: int
    time: Fraction


@dataclass(frozen=True, slots=True)
class TimedTrace:
    """Attributes:
    loop_start: with a PERIODIC or RECURRENT ending, how many steps come before the loop; else None.
    due: in a run against ``-->``, from where on the right side is awaited and never comes; else None.
    """

    initial: TimedState
    steps: tuple[TimedStep, ...]
    ending: Ending = Ending.OPEN
    loop_start: int | None = None
    due: Due | None = None

    @property
    def path(self) -> tuple[Transition, ...]:
        """The transitions of the steps, without the delays between them."""
        return tuple(step.transition for step in self.steps if step.transition is not None)

    @property
    def states(self) -> tuple[TimedState, ...]:
        return (self.initial, *(step.state for step in self.steps))


@dataclass(frozen=True, slots=True)
class RunTimeFault:
    """The model went wrong: ``path`` leads to the state, ``transition`` (None: a guard, an invariant or a predicate) is
    what was being evaluated at ``span``.

    Attributes:
        detail: the values involved: ``"4 is not in [0, 3]"``; empty where they are not known.
        run: the path with its delays; an engine leaves it None.
        of_query: it is an error of the query, and not of the model.
    """

    kind: RuntimeErrorKind
    span: Span
    path: tuple[Transition, ...]
    transition: Transition | None
    detail: str = ""
    run: TimedTrace | None = None
    of_query: bool = False
