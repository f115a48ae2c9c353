"""Targets in the terms of an encoding."""

from __future__ import annotations

from collections.abc import Sequence

from tachk.base.records import dataclass
from tachk.engine.smt.machine import PossibleFault
from tachk.engine.smt.relation import TransitionRelation
from tachk.engine.smt.terms import Formula, any_of, conj
from tachk.model.expressions import Expression


@dataclass(frozen=True, slots=True)
class Targets:
    """Attributes:
    goals: where each of them is reached.
    wrong: for each goal what may go wrong in it.
    undecided: where that leaves it open whether the goal is reached.
    """

    relation: TransitionRelation
    goals: tuple[Formula, ...]
    undecided: tuple[Formula, ...]
    wrong: tuple[tuple[PossibleFault, ...], ...]

    @staticmethod
    def of(encoded: TransitionRelation, predicates: Sequence[Expression]) -> Targets:
        found = [encoded.where(predicate) for predicate in predicates]
        return Targets(
            encoded,
            tuple(yes for yes, _, _ in found),
            tuple(undecided for _, undecided, _ in found),
            tuple(tuple(wrong) for _, _, wrong in found),
        )

    def bad(self, goal: Formula) -> Formula:
        """The formula that a goal is reached or something goes wrong, except in invariants after the step."""
        encoded = self.relation
        return any_of(
            [
                goal,
                *self.undecided,
                *(fault.condition for fault in encoded.state_faults),
                conj(encoded.step_possible, any_of(fault.condition for fault in encoded.step_faults)),
            ]
        )
