"""Requirements as rules, which say for every finite run how it may go on.

An observer guesses how a requirement is violated. Whether a run can still be saved is a question about all guesses, so
here a requirement becomes a deterministic rule: with a trigger, something has to hold at once, or to come by a
deadline, or to stay for a time. Requirements of other shapes are not followed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum

from tachk.logic.observer.violation import condition_of
from tachk.syntax import ast
from tachk.syntax import formula as f
from tachk.syntax.formula import Formula, Interval
from tachk.verify.requirements.signals import NotFollowed


@dataclass(frozen=True, slots=True)
class RequirementTrigger:
    """All of these at an instant.

    Attributes:
        once: conditions that hold or have held before.
        initially: the run begins.
    """

    conditions: tuple[ast.Expression, ...] = ()
    rises: tuple[ast.Expression, ...] = ()
    falls: tuple[ast.Expression, ...] = ()
    once: tuple[ast.Expression, ...] = ()
    initially: bool = False

    @property
    def is_instant(self) -> bool:
        """True if it is there at single instants only."""
        return bool(self.rises or self.falls or self.initially)

    def and_also(self, other: RequirementTrigger) -> RequirementTrigger:
        return RequirementTrigger(
            self.conditions + other.conditions,
            self.rises + other.rises,
            self.falls + other.falls,
            self.once + other.once,
            self.initially or other.initially,
        )


class Demand(StrEnum):
    NOW = "now"
    """The condition holds at every instant of the trigger."""
    COME = "come"
    """The condition comes at most ``length`` later."""
    STAY = "stay"
    """The condition holds for ``length`` from the trigger on."""


@dataclass(frozen=True, slots=True)
class RequirementRule:
    """``closed``: what has to stay has to do so at its end, too."""

    trigger: RequirementTrigger
    demand: Demand
    condition: ast.Expression
    length: int = 0
    closed: bool = True


def rules_of(formula: Formula) -> tuple[RequirementRule, ...]:
    """The rules that together are equivalent to the requirement. Durations have to be whole numbers.

    Raises:
        NotFollowed: naming the part that no rule says.
    """
    return tuple(_whole(formula))


def _whole(formula: Formula) -> Iterator[RequirementRule]:
    match formula:
        case f.And(operands=parts):
            for part in parts:
                yield from _whole(part)
        case f.Always(interval=interval, operand=operand) if _is_ever(interval):
            yield from _each(operand, RequirementTrigger())
        case _:
            yield from _each(formula, RequirementTrigger(initially=True))


def _each(formula: Formula, trigger: RequirementTrigger) -> Iterator[RequirementRule]:
    """The demand at every instant of a trigger."""
    condition = condition_of(formula)
    match formula:
        case f.Implies(left=left, right=right):
            yield from _each(right, trigger.and_also(_trigger(left)))
        case _ if condition is not None:
            yield RequirementRule(trigger, Demand.NOW, condition)
        case f.And(operands=parts):
            for part in parts:
                yield from _each(part, trigger)
        case f.Eventually(interval=interval, operand=operand):
            length = _from_now(formula, interval)
            if length == 0 or not interval.upper_closed:
                raise NotFollowed(formula.span, "its deadline is not a last instant at which the answer may come")
            yield RequirementRule(trigger, Demand.COME, _condition(operand), length)
        case f.Always(interval=interval, operand=operand):
            length = _from_now(formula, interval)
            yield replace(_stay(trigger, _condition(operand), length), closed=interval.upper_closed)
        case _:
            raise NotFollowed(formula.span, "only conditions, F and G may be demanded")


def _stay(trigger: RequirementTrigger, condition: ast.Expression, length: int) -> RequirementRule:
    return RequirementRule(trigger, Demand.STAY if length else Demand.NOW, condition, length)


def _trigger(formula: Formula) -> RequirementTrigger:
    condition = condition_of(formula)
    match formula:
        case _ if condition is not None:
            return RequirementTrigger((condition,))
        case f.And(operands=parts):
            found = RequirementTrigger()
            for part in parts:
                found = found.and_also(_trigger(part))
            return found
        case f.Rise(operand=operand):
            return RequirementTrigger(rises=(_condition(operand),))
        case f.Fall(operand=operand):
            return RequirementTrigger(falls=(_condition(operand),))
        case f.Once(interval=interval, operand=operand) if _is_ever(interval):
            return RequirementTrigger(once=(_condition(operand),))
        case _:
            raise NotFollowed(formula.span, "a trigger consists of conditions, edges, and `O` without a window")


def _condition(formula: Formula) -> ast.Expression:
    condition = condition_of(formula)
    if condition is None:
        raise NotFollowed(formula.span, "a condition on one instant is missing here")
    return condition


def _from_now(formula: Formula, interval: Interval) -> int:
    """The length of a window that begins now."""
    if interval.upper is None:
        raise NotFollowed(formula.span, "it sets no deadline")
    if interval.lower.value != 0:
        raise NotFollowed(formula.span, "its window does not begin at the trigger")
    assert not isinstance(interval.upper.value, ast.Node)
    return int(interval.upper.value)


def _is_ever(interval: Interval) -> bool:
    return interval.upper is None and interval.lower.value == 0 and interval.lower_closed
