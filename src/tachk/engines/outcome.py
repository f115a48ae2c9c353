"""What every exploration engine gives, and tells on the way."""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum

from tachk.diagnostics.span import Span
from tachk.model.fault import RuntimeErrorKind
from tachk.records import dataclass
from tachk.semantics.timed_trace import TimedTrace, Transition


@dataclass(frozen=True, slots=True)
class Statistics:
    """Attributes:
    states_explored: states whose successors were computed.
    states_stored: states in the passed list at the end.
    transitions: successors computed.
    seconds: wall-clock time of the search.
    peak_bytes: largest size of the engine's data structures.
    user_seconds: CPU time that the process spent in user mode during the search.
    """

    states_explored: int = 0
    states_stored: int = 0
    transitions: int = 0
    seconds: float = 0.0
    peak_bytes: int = 0
    user_seconds: float = 0.0


class Status(StrEnum):
    REACHED = "reached"
    UNREACHABLE = "unreachable"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True)
class GoalOutcome:
    """``path``: the transitions from the initial state to a state of the goal, where it was REACHED."""

    status: Status
    path: tuple[Transition, ...] | None = None


@dataclass(frozen=True, slots=True)
class RunTimeFault:
    """The model went wrong: ``path`` leads to the state, ``transition`` (None: a guard, an invariant or a predicate) is
    what was being evaluated at ``span``.

    Attributes:
        detail: the values involved: ``"4 is not in [0, 3]"``; empty where they are not known.
        run: the path with its delays; an engine leaves it None.
    """

    kind: RuntimeErrorKind
    span: Span
    path: tuple[Transition, ...]
    transition: Transition | None
    detail: str = ""
    run: TimedTrace | None = None


@dataclass(frozen=True, slots=True)
class Outcome:
    """Attributes:
    goals: one for each goal, in order.
    reason: why some goal is UNDECIDED: ``"state limit"``, ``"time limit"``, ``"memory limit"``, ``"depth limit"``,
        ``"interrupted"``, ``"run-time error"``; empty otherwise.
    exact: False if the set of states was over-approximated (stopwatches): then REACHED needs a replayed trace.
    """

    goals: tuple[GoalOutcome, ...]
    statistics: Statistics
    reason: str = ""
    fault: RunTimeFault | None = None
    exact: bool = True


INTERRUPTED = "interrupted"
"""The reason of a search that Ctrl-C ended."""

TIME_LIMIT = "time limit"
"""The reason where the time was over, in a search or before it began."""

Progress = Callable[[Statistics], None]
"""Called now and then during long searches."""
