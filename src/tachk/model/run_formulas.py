"""Formulas over runs with their names resolved: the conditions of statistical queries with several operators."""

from __future__ import annotations

from enum import StrEnum
from fractions import Fraction

from tachk.base.records import dataclass
from tachk.model.expressions import Expression


class RunOperator(StrEnum):
    """Operators as docs/logic.md defines them; CHANGE watches the value of an expression."""

    NOT = "not"
    AND = "and"
    OR = "or"
    RISE = "rise"
    FALL = "fall"
    CHANGE = "change"
    EVENTUALLY = "eventually"
    ALWAYS = "always"
    ONCE = "once"
    HISTORICALLY = "historically"
    UNTIL = "until"
    SINCE = "since"


@dataclass(frozen=True, slots=True)
class RunWindow:
    """The window of an operator: distances from now, in time units of the model; without an end if ``upper`` is
    None."""

    lower: Fraction = Fraction(0)
    upper: Fraction | None = None
    lower_closed: bool = True
    upper_closed: bool = True


@dataclass(frozen=True, slots=True)
class RunFormula:
    """An operator with its operands: formulas, or conditions on one state."""

    operator: RunOperator
    operands: tuple[RunFormula | Expression, ...]
    window: RunWindow = RunWindow()
