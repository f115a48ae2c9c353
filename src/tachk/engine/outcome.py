"""Outcomes and progress of every exploration engine."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import StrEnum
from functools import cached_property
from typing import overload

from tachk.base.records import dataclass
from tachk.model.expressions import Expression
from tachk.model.run import RunTimeFault, Transition


@dataclass(frozen=True, slots=True)
class Statistics:
    """Attributes:
    states_explored: states whose successors were computed.
    states_stored: states in the passed list at the end.
    transitions: successors computed.
    seconds: wall-clock time of the search.
    peak_bytes: largest size of the engine's data structures.
    user_seconds: CPU time that the process spent in user mode during the search.
    interchangeable: processes that the search did not distinguish.
    exchanged: the same in words: ``P(1) to P(9) (9)``, for each orbit, cyclic or not.
    less_known: the variables of which a coarser network that was searched keeps less.
    asked_of_all: whether the symmetrised query was checked, about all interchangeable processes in place of some.
    local_times: whether each process had a time of its own.
    lost: successors that were dropped because the goals were out of reach from them.
    """

    states_explored: int = 0
    states_stored: int = 0
    transitions: int = 0
    seconds: float = 0.0
    peak_bytes: int = 0
    user_seconds: float = 0.0
    interchangeable: int = 0
    exchanged: tuple[str, ...] = ()
    less_known: tuple[str, ...] = ()
    asked_of_all: bool = False
    local_times: bool = False
    lost: int = 0

    def then(self, other: Statistics) -> Statistics:
        """The work of two searches, one after the other."""
        return Statistics(
            self.states_explored + other.states_explored,
            max(self.states_stored, other.states_stored),
            self.transitions + other.transitions,
            self.seconds + other.seconds,
            max(self.peak_bytes, other.peak_bytes),
            self.user_seconds + other.user_seconds,
            max(self.interchangeable, other.interchangeable),
            self.exchanged or other.exchanged,
            self.less_known or other.less_known,
            self.asked_of_all or other.asked_of_all,
            self.local_times or other.local_times,
            self.lost + other.lost,
        )


class Status(StrEnum):
    REACHED = "reached"
    UNREACHABLE = "unreachable"
    UNDECIDED = "undecided"


class FoundPath(Sequence[Transition]):
    """The transitions of a path, worked out when they are looked at: there may be millions, of which none is shown.

    Args:
        actions: finds the numbers of the edges of each transition.
        transitions: makes transitions of them.
    """

    def __init__(
        self,
        actions: Callable[[], Sequence[Sequence[int]]],
        transitions: Callable[[Sequence[Sequence[int]]], tuple[Transition, ...]],
    ) -> None:
        self._find, self._transitions_of = actions, transitions

    @cached_property
    def actions(self) -> Sequence[Sequence[int]]:
        return self._find()

    @cached_property
    def transitions(self) -> tuple[Transition, ...]:
        return self._transitions_of(self.actions)

    @overload
    def __getitem__(self, number: int) -> Transition: ...
    @overload
    def __getitem__(self, number: slice) -> tuple[Transition, ...]: ...
    def __getitem__(self, number: int | slice) -> Transition | tuple[Transition, ...]:
        return self.transitions[number]

    def __len__(self) -> int:
        return len(self.transitions)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and self.transitions == tuple(other)

    def __hash__(self) -> int:
        return hash(self.transitions)


@dataclass(frozen=True, slots=True)
class GoalOutcome:
    """Attributes:
    path: the transitions from the initial state to a state of the goal, where it was REACHED.
    fault: the run-time error in the predicate of the goal that has left it UNDECIDED, whatever became of others.
    """

    status: Status
    path: Sequence[Transition] | None = None
    fault: RunTimeFault | None = None

    @property
    def actions(self) -> Sequence[Sequence[int]] | None:
        """The path by the numbers of the edges of the program; None from engines that run no program."""
        return self.path.actions if isinstance(self.path, FoundPath) else None


@dataclass(frozen=True, slots=True)
class Outcome:
    """Attributes:
    goals: one for each goal, in order.
    reason: why some goal is UNDECIDED: ``"state limit"``, ``"time limit"``, ``"memory limit"``, ``"depth limit"``,
        ``"interrupted"``, ``"run-time error"``; empty otherwise.
    fault: what the run-time error was that ended the search; without such, that of the first goal that has one.
    exact: False if the set of states was over-approximated (stopwatches): then REACHED needs a replayed trace.
    found_by: the search of the portfolio that has found a run; empty: the one that explores all states.
    """

    goals: tuple[GoalOutcome, ...]
    statistics: Statistics
    reason: str = ""
    fault: RunTimeFault | None = None
    exact: bool = True
    found_by: str = ""


@dataclass(frozen=True, slots=True)
class Obligation:
    """The obligation that every run from certain states on meets a goal.

    Attributes:
        goal: what has to become true, at once or later, during a delay or behind a transition.
        trigger: from which of the reachable states on; None: from the initial state on.
        again: only runs count that meet each of these again and again, or end. They speak of locations and variables.
        ends: only runs count that end in such a state, or never; None: wherever they end. It is about the same.
        diverges: of the runs with infinitely many transitions only those count in which time diverges.
    """

    goal: Expression
    trigger: Expression | None = None
    again: tuple[Expression, ...] = ()
    ends: Expression | None = None
    diverges: bool = False


class RunEnd(StrEnum):
    """The ways in which a run goes on for ever, or cannot go on."""

    LOOP = "loop"
    """The same transitions are taken again and again."""
    IDLE = "idle"
    """Time passes for ever, and nothing else need happen."""
    STUCK = "stuck"
    """Nothing can happen any more, at whatever time, and time cannot pass for ever."""


@dataclass(frozen=True, slots=True)
class AvoidingRun:
    """A run that avoids a predicate for ever. It may have to wait before the first transition, and behind each.

    Attributes:
        stem: the transitions from the initial state to the loop, or to the last state.
        begins: how many transitions of the stem come before the state from which on the predicate is avoided.
        loop: the transitions of the loop; none where the run ends.
    """

    end: RunEnd
    stem: tuple[Transition, ...]
    begins: int
    loop: tuple[Transition, ...] = ()


class LivenessStatus(StrEnum):
    FOUND = "found"
    NONE = "none"
    """There is no such run."""
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True)
class LivenessOutcome:
    """Attributes:
    run: where one was FOUND.
    reason: why it is UNDECIDED, in the words of `Outcome`.
    exact: False if the set of states was over-approximated (stopwatches): then FOUND needs a replayed run.
    begins: False if the search has gone through everything and no state is one from which runs begin.
    """

    status: LivenessStatus
    statistics: Statistics
    run: AvoidingRun | None = None
    reason: str = ""
    fault: RunTimeFault | None = None
    exact: bool = True
    begins: bool = True


INTERRUPTED = "interrupted"
"""The reason of a search that Ctrl-C ended."""

TIME_LIMIT = "time limit"
"""The reason where the time was over, in a search or before it began."""

MACHINE_OUT_OF_MEMORY = "the machine is out of memory"
"""The reason where the system gave no more memory."""

STATE_LIMIT = "state limit"
"""The reason of a search that stored as many states as it might."""
