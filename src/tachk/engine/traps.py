"""Traps in which a goal is out of reach, as the core finds them; `tachk.meaning.judge.trap_proof` judges them."""

from __future__ import annotations

from tachk import _core
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.program_image import encode
from tachk.meaning.judge.trap import FOR_EVER, Trap

_NO_END = -1


def find_traps(program: Program, goal: Goal) -> list[Trap]:
    """The traps that pruning uses for a goal; none where it drops nothing."""
    found = _core.traps_of(encode(program, [goal]))
    return [Trap(slot, clock, tuple(map(_part, outside))) for slot, clock, outside in found]


def _part(given: tuple[int, int, int]) -> tuple[int, int, int]:
    value, first, last = given
    return value, first, FOR_EVER if last == _NO_END else last


def image_of_trap(trap: Trap) -> _core.Trap:
    """A trap as the core reads it."""
    outside = [(value, first, _NO_END if last == FOR_EVER else last) for value, first, last in trap.outside]
    return trap.slot, trap.clock, outside
