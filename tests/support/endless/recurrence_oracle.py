"""An oracle for what happens again and again: values that last, in the graph of regions.

It knows neither observers nor zones. What is asked is whether some run keeps a condition from somewhere on and
*answers* for ever: whenever ``needed`` holds for some time, ``answer`` holds for some time, then or later. In a run
that ends its last state lasts for ever, and in one that takes infinitely many steps without time each of its states.
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
from tests.support.oracles.avoiding_runs import Budget, Graph, LimitError, avoiding_run, build
from tests.support.oracles.digitised import delayed, region_steps

Node = tuple[TimedState, bool]
"""A point of a region, and whether an answer is awaited."""


@dataclass(frozen=True, slots=True)
class Answering:
    """Attributes:
    needed, answer: see above; needed None: always.
    kept: what holds from where the run is looked at on; None: anything.
    after: it is looked at from where this has held for some time; None: from anywhere, or from the start.
    """

    answer: Expression
    needed: Expression | None = None
    kept: Expression | None = None
    after: Expression | None = None
    from_start: bool = False


def answers_for_ever(network: Network, asked: Answering, states: int) -> bool | None:
    """Whether such a run exists; None where the limit on states was hit. Raises EvaluationFault."""
    graph = _Answers(prepare(network), asked, *region_steps(network, []))
    budget = Budget(Limits(states=states))
    try:
        reached = build([graph.normal(initial_state(graph.model))], lambda state: list(graph.everything(state)), budget)
        begun = graph.starts(reached)
        return (
            _exists(begun, graph.all_steps, graph.end, graph.is_answered, budget)
            or _exists(build(begun, graph.all_steps, budget).came, graph.instant_steps, _nowhere, graph.answers, budget)
            or (asked.after is not None and _exists_at_once(graph, asked.after, reached.came, budget))
        )
    except LimitError:
        return None


def _exists_at_once(graph: _Answers, after: Expression, reached: Iterable[TimedState], budget: Budget) -> bool:
    """Whether time need not go on where ``after`` holds, which then lasts for ever: always, or again and again."""

    def steps(node: Node) -> list[tuple[Transition | None, Node]]:
        return [step for step in graph.instant_steps(node) if graph.holds(step[1][0], after)]

    kept = [(state, False) for state in reached if graph.holds(state, graph.asked.kept)]
    begun = [node for node in kept if graph.holds(node[0], after)]
    again = [lambda node, _, __: graph.answers(node), lambda node, _, __: graph.holds(node[0], after)]
    return (
        _exists(begun, steps, graph.end, graph.answers, budget)
        or avoiding_run(dict.fromkeys(kept, ()), graph.instant_steps, _nowhere, budget, again) is not None
    )


def _exists(
    begun: Iterable[Node],
    steps: Callable[[Node], list[tuple[Transition | None, Node]]],
    end: Callable[[Node], RunEnd | None],
    again: Callable[[Node], bool],
    budget: Budget,
) -> bool:
    return avoiding_run(dict.fromkeys(begun, ()), steps, end, budget, [lambda node, _, __: again(node)]) is not None


def _nowhere(_: Node) -> None:
    return None


@dataclass(frozen=True, slots=True)
class _Answers:
    model: PreparedNetwork
    asked: Answering
    normalised: Callable[[tuple[Fraction, ...]], tuple[Fraction, ...]]
    next_delay: Callable[[tuple[Fraction, ...]], Fraction | None]

    def holds(self, state: TimedState, condition: Expression | None) -> bool:
        return condition is None or satisfies(self.model, state, condition)

    def normal(self, state: TimedState) -> TimedState:
        return TimedState(state.discrete, self.normalised(state.clocks), Fraction(0))

    def everything(self, state: TimedState) -> Iterator[tuple[Transition | None, TimedState]]:
        for transition, after in successors(self.model, state):
            yield transition, self.normal(after)
        duration = self.next_delay(state.clocks)
        later = delayed(self.model, state, Fraction(1) if duration is None else duration)
        if later is not None:
            yield None, self.normal(later)

    def starts(self, reached: Graph[TimedState]) -> list[Node]:
        begun = list(reached.came)[:1] if self.asked.from_start else list(reached.came)
        if self.asked.after is not None:
            begun = [
                after
                for state in reached.came
                if self.holds(state, self.asked.after)
                for transition, after in reached.steps[state]
                if transition is None
            ]
        return [(state, False) for state in begun if self.holds(state, self.asked.kept)]

    def all_steps(self, node: Node) -> list[tuple[Transition | None, Node]]:
        return list(self.steps(node))

    def instant_steps(self, node: Node) -> list[tuple[Transition | None, Node]]:
        return [step for step in self.steps(node) if step[0] is not None]

    def steps(self, node: Node) -> Iterator[tuple[Transition | None, Node]]:
        state, awaited = node
        for transition, after in self.everything(state):
            if not self.holds(after, self.asked.kept):
                continue
            if transition is None and self.holds(state, self.asked.answer):
                yield transition, (after, False)
            elif transition is None and self.holds(state, self.asked.needed):
                yield transition, (after, True)
            else:
                yield transition, (after, awaited)

    def answers(self, node: Node) -> bool:
        return satisfies(self.model, node[0], self.asked.answer)

    def satisfied(self, state: TimedState) -> bool:
        """Whether nothing is needed that is not there."""
        needed = self.asked.needed is None or satisfies(self.model, state, self.asked.needed)
        return not needed or satisfies(self.model, state, self.asked.answer)

    def is_answered(self, node: Node) -> bool:
        return not node[1] and self.satisfied(node[0])

    def end(self, node: Node) -> RunEnd | None:
        if next(self.everything(node[0]), None) is not None:
            return None
        return RunEnd.STUCK if self.is_answered(node) or self.answers(node) else None
