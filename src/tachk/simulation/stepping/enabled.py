"""Enabled transitions of a run, and their times."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from tachk.base.records import dataclass
from tachk.meaning.run_view import RunNames
from tachk.meaning.step import StepError, delay, relevant_moments, successors
from tachk.model.fault import EvaluationFault
from tachk.model.quantity import decimal
from tachk.model.run import TimedState, Transition


@dataclass(frozen=True, slots=True)
class DelayWindow:
    """Delays, counted from now.

    Attributes:
        last: None: without end.
        first_belongs, last_belongs: whether the ends are among them.
    """

    first: Fraction
    last: Fraction | None
    first_belongs: bool = True
    last_belongs: bool = True

    def __contains__(self, waited: Fraction) -> bool:
        begun = waited > self.first or (self.first_belongs and waited == self.first)
        return begun and (self.last is None or waited < self.last or (self.last_belongs and waited == self.last))

    def __str__(self) -> str:
        if self.last is None:
            return f"{'[' if self.first_belongs else '('}{decimal(self.first)}, ∞)"
        if self.first == self.last:
            return decimal(self.first)
        left, right = "[" if self.first_belongs else "(", "]" if self.last_belongs else ")"
        return f"{left}{decimal(self.first)}, {decimal(self.last)}{right}"

    @property
    def some(self) -> Fraction:
        """The first delay; where there is none, a short one."""
        if self.first_belongs:
            return self.first
        return self.first + min(Fraction(1), Fraction(1) if self.last is None else (self.last - self.first) / 2)


@dataclass(frozen=True, slots=True)
class EnabledTransition:
    """A transition, and after which delays it is enabled, in order."""

    transition: Transition
    windows: tuple[DelayWindow, ...]


@dataclass(frozen=True, slots=True)
class EnabledSteps:
    """Attributes:
    delays: how long nothing need happen.
    faults: run-time errors that some transition would meet.
    """

    transitions: tuple[EnabledTransition, ...]
    delays: DelayWindow
    faults: tuple[EvaluationFault, ...] = ()


def enabled_steps(names: RunNames, state: TimedState) -> EnabledSteps:
    """The transitions and delays that are enabled in a state. Raises EvaluationFault if an invariant cannot be
    evaluated."""
    model = names.model
    moments = relevant_moments(model, state, before=None)
    possible: list[tuple[Fraction, set[Transition]]] = []
    order: dict[Transition, None] = {}
    faults: dict[str, EvaluationFault] = {}
    for moment in moments:
        try:
            later = delay(model, state, moment)
        except StepError:
            break
        try:
            found = [transition for transition, _ in successors(model, later)]
        except EvaluationFault as fault:
            faults.setdefault(str(fault), fault)
            found = []
        order.update(dict.fromkeys(found))
        possible.append((moment, set(found)))
    made = (EnabledTransition(t, tuple(_windows(moments, [t in found for _, found in possible]))) for t in order)
    (delays,) = _windows(moments, [True] * len(possible)) or (DelayWindow(Fraction(0), Fraction(0)),)
    return EnabledSteps(tuple(sorted(made, key=_key)), delays, tuple(faults.values()))


def _key(choice: EnabledTransition) -> tuple[tuple[int, int, tuple[int, ...]], ...]:
    return tuple((p.process, p.edge, p.selects) for p in choice.transition.participants)


def _windows(moments: list[Fraction], holds: Iterable[bool]) -> list[DelayWindow]:
    """The delays at which something holds that is known at the moments: ends of intervals and inner points, in turn."""
    found: list[DelayWindow] = []
    begun: tuple[Fraction, bool] | None = None
    known = [*holds, False]
    for place, held in enumerate(known):
        is_end = place % 2 == 0
        if held and begun is None:
            begun = (moments[place], True) if is_end else (moments[place - 1], False)
        elif not held and begun is not None:
            if place == len(moments):
                found.append(DelayWindow(begun[0], None, begun[1], False))
            elif is_end:  # it held up to this moment, but not at it
                found.append(DelayWindow(begun[0], moments[place], begun[1], False))
            else:
                found.append(DelayWindow(begun[0], moments[place - 1], begun[1], True))
            begun = None
    return found
