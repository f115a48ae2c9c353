"""How much of a run is told, and what of it. Imports nothing heavy: command lines are made of it."""

from __future__ import annotations

from tachk.base.records import dataclass


@dataclass(frozen=True, slots=True)
class Ends:
    """How much of a long run is told.

    Attributes:
        beginning, end: steps and rounds; without a beginning the initial state is not told either.
    """

    beginning: int = 200
    end: int = 100


@dataclass(frozen=True, slots=True)
class Telling:
    """How a run is told.

    Attributes:
        clocks: the value of every clock after each step.
        every_step: each step of repeated rounds and of long runs, and what the model hides.
        ends: what is told of a run that stays longer when rounds are put together.
    """

    clocks: bool = False
    every_step: bool = False
    ends: Ends = Ends()
