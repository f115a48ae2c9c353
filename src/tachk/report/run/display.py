"""Display options of runs. Imports nothing heavy: options of commands are made of it."""

from __future__ import annotations

from tachk.base.records import dataclass


@dataclass(frozen=True, slots=True)
class Ends:
    """The number of steps that are shown at both ends of a long run.

    Attributes:
        beginning, end: steps and rounds; without a beginning the initial state is not shown either.
    """

    beginning: int = 200
    end: int = 100


@dataclass(frozen=True, slots=True)
class RunDisplay:
    """Display options of a run.

    Attributes:
        clocks: the value of every clock after each step.
        every_step: each step of repeated rounds and of long runs, and what the model hides.
        ends: the steps that are shown of a run that is still longer after its rounds are folded.
    """

    clocks: bool = False
    every_step: bool = False
    ends: Ends = Ends()
