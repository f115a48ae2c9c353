"""Proofs that no run reaches a goal, by induction over the steps of a run."""

from __future__ import annotations

import time
from collections.abc import Sequence

import z3

from tachk.base.job import StoppedError, check_job, limited
from tachk.engine.smt.facts import ZonesAt, known_zones
from tachk.engine.smt.frame import StateFrame
from tachk.engine.smt.solving import GaveUpError, SolverOptions
from tachk.engine.smt.targets import Targets
from tachk.engine.smt.terms import Formula, any_of, conj, neg
from tachk.model.expressions import Expression
from tachk.model.network import Network

_PLAIN_INDUCTION = 3
"""Up to so many steps induction is tried without further facts."""

_TRY_SECONDS = 10.0
"""A proof that takes longer is given up."""

_ZONES_SECONDS = 120.0
"""As `_TRY_SECONDS`, for zones, where exploring them has shown that a proof will succeed; with a limit on time it
is half of what is left."""


class Proofs:
    """Proofs by induction that open goals are unreachable.

    Every proof also shows that nothing goes wrong in any reachable state, without which nothing would be proved.
    """

    def __init__(
        self, targets: Targets, settings: SolverOptions, network: Network, predicates: Sequence[Expression]
    ) -> None:
        self.targets = targets
        self.relation = targets.relation
        self.settings = settings
        self.network = network
        self.predicates = predicates
        self._frames: list[StateFrame] = []
        self._solver = settings.solver()
        self._tried_zones = False

    def proved(self, depth: int, goals: Sequence[int]) -> list[int]:
        """The goals, of those not reached in up to ``depth`` steps, that are proved to be unreachable."""
        try:
            deadline = time.monotonic() + _TRY_SECONDS
            if depth < _PLAIN_INDUCTION:
                return [goal for goal in goals if self._is_inductive(goal, depth, deadline)]
            if not self._tried_zones:
                self._tried_zones = True
                return self._with_zones(goals)
        except GaveUpError:
            if self.settings.deadline is not None and time.monotonic() >= self.settings.deadline:
                raise
        return []

    def _is_inductive(self, goal: int, depth: int, deadline: float) -> bool:
        """True if no run of ``depth + 1`` steps that avoids a goal, wherever it begins, is followed by the goal."""
        while len(self._frames) <= depth + 1:
            self._frames.append(self._add_frame(f"i{len(self._frames)}"))
            if len(self._frames) > 1:
                self._solver.add(self.relation.at(self.relation.step, *self._frames[-2:]))
        bad, last = self.targets.bad(self.targets.goals[goal]), self._frames[-1]
        before = [neg(self.relation.at(bad, frame)) for frame in self._frames[:-1]]
        if self._is_possible(deadline, *before, self.relation.at(bad, last)):
            return False
        return not self._enters_wrongly(last, deadline, *before)

    def _add_frame(self, name: str) -> StateFrame:
        frame = self.relation.frame(name)
        self._solver.add(self.relation.any_frame(frame), self.relation.at(self.relation.stay, frame))
        return frame

    def _enters_wrongly(self, frame: StateFrame, deadline: float, *assumptions: Formula) -> bool:
        """True if a step out of a frame leads to where an invariant goes wrong."""
        faults = any_of(fault.condition for fault in self.relation.entry_faults)
        if faults is False:
            return False
        behind = self.relation.frame("e")
        step = self.relation.at(self.relation.step, frame, behind)
        entered = conj(self.relation.any_frame(behind), self.relation.at(faults, behind))
        return self._is_possible(deadline, *assumptions, step, entered)

    def _with_zones(self, goals: Sequence[int]) -> list[int]:
        """The goals that no run reaches if every run is in one of the zones that Python finds, which is proved by
        induction over one step."""
        try:
            with limited(_TRY_SECONDS):
                zones = known_zones(self.network, self.predicates)
        except StoppedError:
            check_job()  # the limit of the whole search counts
            return []
        if not zones:
            return []
        now = time.monotonic()
        half = _ZONES_SECONDS if self.settings.deadline is None else (self.settings.deadline - now) / 2
        deadline = now + max(half, _TRY_SECONDS)
        self._solver = self.settings.solver()
        one, other = self._add_frame("z0"), self._add_frame("z1")
        before = ZonesAt(self.relation, one)
        # Said once: all questions but those about the goals are about leaving the zones.
        outside = z3.Bool("outside")
        self._solver.add(z3.Implies(outside, z3.Not(ZonesAt(self.relation, other).inside(zones))))
        if self._is_possible(deadline, self.relation.initial(other), outside):
            return []
        # A run that has waited is taken for one that has just come: what is stopped keeps its value then.
        self._solver.add(one.entered == one.left)
        step = self.relation.at(self.relation.step, one, other)
        bad = {goal: self.relation.at(self.targets.bad(self.targets.goals[goal]), one) for goal in goals}
        for state, of_state in zones.items():
            within = before.is_state(state), before.in_some(of_state)
            if self._is_possible(deadline, *within, step, outside) or self._enters_wrongly(one, deadline, *within):
                return []
            bad = {goal: formula for goal, formula in bad.items() if not self._is_possible(deadline, *within, formula)}
        return list(bad)

    def _is_possible(self, deadline: float, *formulas: Formula) -> bool:
        return self.settings.is_satisfiable(self._solver, *formulas, deadline=deadline)
