"""Invariants in Munta's words: a conjunction of comparisons of clocks with constants, the same in all states."""

from __future__ import annotations

from tachk.base.span import Span
from tachk.formats.munta.actions import clock_conjunctions, refused
from tachk.formats.munta.cases import CaseFinder, KnownContents, TooManyCasesError
from tachk.meaning.constraints import Conjunction, Disjunction, conditional_constraints
from tachk.model.evaluate import Environment
from tachk.model.expressions import Expression


def constant_invariant(invariant: Expression | None, span: Span, finder: CaseFinder) -> Conjunction:
    """The constraints of an invariant of the location at a place. Raises UnsupportedError."""
    place = span if invariant is None else invariant.span

    def outcome(environment: Environment, contents: KnownContents) -> Disjunction:
        return clock_conjunctions(conditional_constraints(invariant, environment), place)

    try:
        cases = finder.find(outcome)
    except TooManyCasesError:
        cases = []
    if len(cases) != 1 or cases[0].conditions:
        raise refused("invariants that depend on variables", place, "make several locations of it")
    if len(cases[0].outcome) != 1:
        raise refused("invariants with alternatives", place, "make several locations of it")
    return cases[0].outcome[0]
