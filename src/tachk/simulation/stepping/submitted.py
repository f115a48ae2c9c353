"""A submitted run: the run in a file before it is replayed."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from tachk.base.records import dataclass, field
from tachk.base.span import Span
from tachk.base.words import Direction


@dataclass(frozen=True, slots=True)
class SubmittedMove:
    """The submitted step of a process.

    Attributes:
        number: the number of the edge among those from the source to the target, from 1 in the order of the text;
            None: not given.
        selects: the values of select variables that are given.
        direction: of the synchronisation; None if the edge is internal, or it is not given.
    """

    process: str
    source: str
    target: str
    number: int | None = None
    selects: Mapping[str, int] = field(default_factory=dict)
    direction: Direction | None = None


@dataclass(frozen=True, slots=True)
class SubmittedState:
    """A submitted state, by names; whatever is not named may have any value."""

    locations: Mapping[str, str]
    variables: Mapping[str, int | bool]
    clocks: Mapping[str, Fraction]
    time: Fraction | None = None


@dataclass(frozen=True, slots=True)
class SubmittedStep:
    """A step: first time passes, then processes move.

    Attributes:
        time: since the start of the run, or, with ``relative``, since the step before.
        moves: empty where time passes and nothing else happens.
        channel: as the view of runs names it; empty: none, or it is not given.
        partial: whether what hidden processes do may be left out.
        after: the state after the step, as far as it is given.
        span: the line that says so; of a report none.
    """

    time: Fraction
    relative: bool
    moves: tuple[SubmittedMove, ...]
    channel: str = ""
    partial: bool = False
    after: SubmittedState | None = None
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class SubmittedRun:
    """Attributes:
    name: of the file.
    constants: the values of constants of the model with which the run was made, as far as they are given.
    initial: the first state, as far as it is given.
    """

    name: str
    constants: Mapping[str, int]
    steps: tuple[SubmittedStep, ...]
    initial: SubmittedState | None = None
