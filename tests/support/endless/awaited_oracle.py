"""An oracle for formulas without deadline, in the graph of regions: docs/logic.md, "Without a deadline".

It knows neither observers nor zones. A value *lasts* where time passes while it is there. Where a run can go no
further, those of its last state last; where it takes steps for ever at one instant, those that it comes to again and
again do. What is awaited (``F q``) has come as soon as it is true in any state.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction

from tachk.base.records import dataclass
from tachk.engine.options import Limits
from tachk.engine.outcome import RunEnd
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.step import initial_state, satisfies, successors
from tachk.model.expressions import Expression
from tachk.model.network import Network
from tachk.model.run import TimedState, Transition
from tests.support.oracles.avoiding_runs import Budget, LimitError, avoiding_run, build
from tests.support.oracles.digitised import delayed, region_steps

State = tuple[TimedState, bool]
"""A point of a region, and whether the first condition was true when time last passed."""

Steps = list[tuple[Transition | None, State]]

Condition = Callable[[State], bool]

FORMS = (
    "F b",
    "G F b",
    "G (a -> F b)",
    "a -> F b",
    "F G b",
    "G (a -> F G b)",
    "G F a -> G F b",
    "F a -> F b",
    "G a -> F b",
    "G (rise(a) -> F b)",
    "G (a -> (a U b))",
    "G (a -> (c U b))",
    "G F a && G (b -> F c)",
    "F b || F G a",
)


def violated(network: Network, form: str, a: Expression, b: Expression, c: Expression, states: int) -> bool | None:
    """Whether some run violates a formula; None where the limit on states was hit. Raises EvaluationFault."""
    try:
        return _violated(_regions(network, a, Limits(states=states)), form, a, b, c)
    except LimitError:
        return None


def _violated(regions: Regions, form: str, a: Expression, b: Expression, c: Expression) -> bool:
    at = regions.at
    anywhere, start = regions.states, regions.states[:1]
    match form:
        case "F b":
            return regions.stays(start, at(b, False))
        case "G F b":
            return regions.stays(anywhere, at(b, False))
        case "G (a -> F b)":
            return regions.stays_after(anywhere, at(a), at(b, False))
        case "a -> F b":
            return regions.stays_after(regions.at_first(), at(a), at(b, False))
        case "F G b":
            return regions.recurs(anywhere, at(b, False))
        case "G (a -> F G b)":
            return regions.recurs_after(at(a), at(b, False))
        case "G F a -> G F b":
            return regions.recurs(anywhere, at(a), within=at(b, False))
        case "F a -> F b":
            without = at(b, False)
            return without(start[0]) and regions.stays_after(regions.reached(start, without), at(a), without)
        case "G a -> F b":
            return regions.lasts_throughout(start, at(a), at(b, False))
        case "G (rise(a) -> F b)":
            holds = at(a)
            return regions.stays_after(anywhere, lambda s: holds(s) and not s[1], at(b, False))
        case "G (a -> (a U b))" | "G (a -> (c U b))":
            kept = at(a if form == "G (a -> (a U b))" else c)
            absent = at(b, False)
            failing = _both(lambda s: not kept(s), absent)
            return regions.stays_after(anywhere, at(a), absent) or regions.fails_after(at(a), absent, failing)
        case "G F a && G (b -> F c)":
            answered = regions.stays_after(anywhere, at(b), at(c, False))
            return answered or regions.stays(anywhere, at(a, False))
        case "F b || F G a":
            return regions.recurs(regions.reached(start, at(b, False)), at(a, False), within=at(b, False))
        case _:
            raise AssertionError(form)


def _both(one: Condition, other: Condition) -> Condition:
    return lambda state: one(state) and other(state)


@dataclass(frozen=True, slots=True)
class Regions:
    """All reachable states, the initial one first.

    Attributes:
        steps: what follows each: by a transition, or (None) by time, which also may pass within a region.
        dwells: where time can pass within a region.
        ends: where a run can go no further.
    """

    model: PreparedNetwork
    states: tuple[State, ...]
    steps: dict[State, Steps]
    dwells: frozenset[State]
    ends: frozenset[State]
    budget: Budget

    def at(self, condition: Expression, value: bool = True) -> Condition:
        known = {state: satisfies(self.model, state[0], condition) is value for state in self.states}
        return lambda state: known[state]

    # ---- runs that stay where a condition holds ----------------------------------------------------------------------

    def stays(self, begun: Iterable[State], kept: Condition) -> bool:
        """Whether some run keeps a condition in every state, from one of these on."""
        return self._exists([state for state in begun if kept(state)], self._within(kept), self.ends)

    def stays_after(self, begun: Iterable[State], first: Condition, kept: Condition) -> bool:
        """Whether in some run a condition lasts, from one of these states on, and another one is kept from there on."""
        both = [state for state in begun if first(state) and kept(state)]
        after = [state for state in both if state in self.dwells]
        after += [later for state in both for transition, later in self.steps[state] if transition is None]
        last = any(state in self.ends for state in both)
        return last or self.stays(after, kept) or self._at_one_instant(both, kept, [first])

    def reached(self, begun: Iterable[State], kept: Condition) -> list[State]:
        """The states that are reached through such, these included."""
        return list(build([state for state in begun if kept(state)], self._within(kept), self.budget).came)

    def at_first(self) -> list[State]:
        """The states in which no time has passed."""
        return list(build(self.states[:1], self._instant(lambda _: True), self.budget).came)

    # ---- runs in which something lasts again and again ---------------------------------------------------------------

    def recurs(self, begun: Iterable[State], again: Condition, within: Condition = lambda _: True) -> bool:
        """Whether in some run a condition lasts again and again, while another one is kept."""
        begun = [state for state in begun if within(state)]
        last = frozenset(state for state in self.ends if again(state))
        lasts = [lambda state, transition, _: again(state) and (transition is None or state in self.dwells)]
        return self._exists(begun, self._within(within), last, lasts) or self._at_one_instant(begun, within, [again])

    def recurs_after(self, first: Condition, again: Condition) -> bool:
        """Whether in some run a condition lasts, and another one lasts again and again from there on."""
        begun = [state for state in self.states if first(state)]
        after = [state for state in begun if state in self.dwells]
        after += [later for state in begun for transition, later in self.steps[state] if transition is None]
        last = any(state in self.ends and again(state) for state in begun)
        return last or self.recurs(after, again) or self._at_one_instant(begun, lambda _: True, [first, again])

    def lasts_throughout(self, begun: Iterable[State], first: Condition, kept: Condition) -> bool:
        """Whether in some run no time passes without a condition, and another one is kept in every state."""

        def follow(state: State) -> Steps:
            return [step for step in self.steps[state] if kept(step[1]) and (step[0] is not None or first(state))]

        last = frozenset(state for state in self.ends if first(state))
        some = [lambda state, _, __: first(state)]
        return self._exists([state for state in begun if kept(state)], follow, last, some)

    def fails_after(self, first: Condition, absent: Condition, failing: Condition) -> bool:
        """Whether in some run a condition lasts, and later another one, while no time passes without a third."""
        begun = [state for state in self.states if first(state) and absent(state)]
        after = [state for state in begun if state in self.dwells]
        after += [later for state in begun for transition, later in self.steps[state] if transition is None]

        def follow(state: State) -> Steps:
            return [step for step in self.steps[state] if step[0] is not None or absent(state)]

        return any(
            failing(state) and (state in self.dwells or any(step[0] is None for step in self.steps[state]))
            for state in build(after, follow, self.budget).came
        )

    # ---- how they are looked for -------------------------------------------------------------------------------------

    def _within(self, kept: Condition) -> Callable[[State], Steps]:
        return lambda state: [step for step in self.steps[state] if kept(step[1])] if kept(state) else []

    def _instant(self, kept: Condition) -> Callable[[State], Steps]:
        return lambda state: [step for step in self.steps[state] if step[0] is not None and kept(step[1])]

    def _at_one_instant(self, begun: Iterable[State], kept: Condition, again: list[Condition]) -> bool:
        conditions = [lambda state, _, __, one=one: one(state) for one in again]
        begun = [state for state in begun if kept(state)]
        return self._exists(begun, self._instant(kept), frozenset(), conditions)

    def _exists(
        self,
        begun: Iterable[State],
        follow: Callable[[State], Steps],
        last: frozenset[State],
        conditions: Iterable[Callable[[State, Transition | None, State], bool]] = (),
    ) -> bool:
        def end(state: State) -> RunEnd | None:
            return RunEnd.STUCK if state in last else None

        return avoiding_run(dict.fromkeys(begun, ()), follow, end, self.budget, list(conditions)) is not None


def _regions(network: Network, a: Expression, limits: Limits) -> Regions:
    """Raises LimitError and EvaluationFault."""
    model = prepare(network)
    normalised, next_delay = region_steps(network, [])
    budget = Budget(limits)

    def normal(state: TimedState) -> TimedState:
        return TimedState(state.discrete, normalised(state.clocks), Fraction(0))

    def moves(state: State) -> Iterator[tuple[Transition | None, State]]:
        here, before = state
        for transition, after in successors(model, here):
            yield transition, (normal(after), before)
        duration = next_delay(here.clocks)
        later = delayed(model, here, Fraction(1) if duration is None else duration)
        if later is not None:
            yield None, (normal(later), satisfies(model, here, a))

    def dwells(here: TimedState) -> bool:
        """Whether the region has inner points, and time passes there."""
        duration = next_delay(here.clocks)
        if duration is None:
            return delayed(model, here, Fraction(1)) is not None
        return normalised(here.clocks) == normalised(tuple(c + duration / 2 for c in here.clocks)) and (
            delayed(model, here, duration / 2) is not None
        )

    ends: set[State] = set()

    def follow(state: State) -> Steps:
        found = list(moves(state))
        if not found:
            ends.add(state)
        behind = (state[0], satisfies(model, state[0], a))
        return [*found, (None, behind)] if behind != state and dwells(state[0]) else found

    graph = build([(normal(initial_state(model)), False)], follow, budget)
    inner = frozenset(state for state in graph.came if dwells(state[0]))
    return Regions(model, tuple(graph.came), graph.steps, inner, frozenset(ends), budget)
