"""The runs of a network, one step after the other: bounded model checking."""

from __future__ import annotations

from collections.abc import Sequence

import z3

from tachk.engine.outcome import GoalOutcome, Status
from tachk.engine.smt.frame import StateFrame
from tachk.engine.smt.machine import PossibleFault
from tachk.engine.smt.solving import SolverOptions
from tachk.engine.smt.targets import Targets
from tachk.engine.smt.terms import Formula, any_of, conj
from tachk.model.run import RunTimeFault, Transition


class Unrolled:
    """All runs of a number of steps.

    Attributes:
        depth: how many steps.
        status: the goals that are decided, or go wrong.
    """

    def __init__(self, targets: Targets, settings: SolverOptions) -> None:
        self.targets = targets
        self.relation = targets.relation
        self.settings = settings
        self.depth = 0
        self.status: dict[int, GoalOutcome] = {}
        self._solver = settings.solver()
        first = self.relation.frame("f0")
        self._frames = [first]
        self._solver.add(self.relation.initial(first), self.relation.any_frame(first))

    @property
    def open(self) -> list[int]:
        """The goals that are still looked for."""
        return [number for number in range(len(self.targets.goals)) if number not in self.status]

    def stay(self) -> None:
        """Says that the runs keep the invariants where they have come to, and wait there for a while."""
        self._solver.add(self.relation.at(self.relation.stay, self._frames[-1]))

    def note_reached_goals(self) -> None:
        """Notes the goals that are reached in the last frame."""
        for number in self.open:
            if self._is_possible(self.relation.at(self.targets.goals[number], self._frames[-1])):
                self.status[number] = GoalOutcome(Status.REACHED, self._path())

    def go_on(self) -> bool:
        """Makes the runs one step longer; whether there are any then."""
        there = self.relation.frame(f"f{self.depth + 1}")
        self._solver.add(self.relation.at(self.relation.step, self._frames[-1], there), self.relation.any_frame(there))
        self._frames.append(there)
        self.depth += 1
        return self._is_possible(self.relation.at(self.relation.stay, there))

    def fail(self) -> None:
        """Notes the goals whose evaluation may go wrong in the last frame."""
        for number in self.open:
            if self._is_possible(self.relation.at(self.targets.undecided[number], self._frames[-1])):
                found = self._first_of(self.targets.wrong[number])
                fault = RunTimeFault(found.kind, found.span, self._path(), None, of_query=True)
                self.status[number] = GoalOutcome(Status.UNDECIDED, fault=fault)

    def fault(self) -> RunTimeFault | None:
        """The run-time errors where the runs have come to, or in the updates of the next step."""
        first_fault = self._possible_of(self.relation.state_faults)
        if first_fault is not None:
            return RunTimeFault(first_fault.kind, first_fault.span, self._path(), None)
        updated = self._possible_of(self.relation.step_faults, self.relation.step_possible)
        if updated is not None:
            return RunTimeFault(updated.kind, updated.span, self._path(), self._transition(self._frames[-1]))
        return None

    def entry_fault(self) -> RunTimeFault | None:
        """The run-time errors in the invariants after the last step, which were not evaluated before."""
        found = self._possible_of(self.relation.entry_faults)
        if found is None:
            return None
        path = self._path()
        return RunTimeFault(found.kind, found.span, path[:-1], path[-1] if path else None)

    def _is_possible(self, formula: Formula) -> bool:
        return self.settings.is_satisfiable(self._solver, formula)

    def _possible_of(self, faults: Sequence[PossibleFault], also: Formula = True) -> PossibleFault | None:
        happens = conj(any_of(fault.condition for fault in faults), also)
        if not self._is_possible(self.relation.at(happens, self._frames[-1])):
            return None
        return self._first_of(faults)

    def _first_of(self, faults: Sequence[PossibleFault]) -> PossibleFault:
        """The first of some faults that happens in the run that z3 has found."""
        model = self._solver.model()
        return next(fault for fault in faults if _is_true(model, self.relation.at(fault.condition, self._frames[-1])))

    def _path(self) -> tuple[Transition, ...]:
        return tuple(self._transition(frame) for frame in self._frames[: self.depth])

    def _transition(self, frame: StateFrame) -> Transition:
        model = self._solver.model()
        fired = [number for number, fires in enumerate(frame.fires) if _is_true(model, fires)]
        first = [self.relation.instances[n] for n in fired if self.relation.initiators[n]]
        others = [self.relation.instances[n] for n in fired if not self.relation.initiators[n]]
        return Transition((*first, *others))


def _is_true(model: z3.ModelRef, formula: Formula) -> bool:
    return formula if isinstance(formula, bool) else bool(z3.is_true(model.eval(formula, model_completion=True)))
