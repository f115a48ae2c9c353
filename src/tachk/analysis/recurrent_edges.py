"""Zeno runs, excluded by the model alone: the answer is that there is none, or that there may be one.

In a run in which time does not diverge, each process that moves for ever stays in cycles of its edges. Take a clock x
that is only ever set to 0: if edges that reset x and edges that need x >= 1 were both taken for ever, at least one time
unit would pass between one of the first and the next of the second, again and again. So from some time on either the
first or the second are not taken. What is left when this is tried for every clock, when edges outside cycles are left
out, those whose partners are, and those that change a variable in a way that nothing undoes, are edges that such a run
may take for ever. If none is left, there is no such run.

Strong non-Zenoness: Tripakis 1999; in networks: Bowman and Gómez 2006.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Iterator
from typing import TypeVar

from tachk.analysis.edge_steps import EdgeStep, steps_of
from tachk.analysis.fold import Known
from tachk.base.job import check_job
from tachk.model.expressions import Expression, Variable
from tachk.model.network import Network

MOST_TRIES = 500
"""Ways of saying for the clocks what is not taken any more. There are more only where many clocks are intertwined."""

Steps = frozenset[EdgeStep]
Node = TypeVar("Node", bound=Hashable)


def lasting_edges(network: Network, known: Known, never: Collection[tuple[int, int]]) -> frozenset[tuple[int, int]]:
    """The edges, by process and number, that some run may take infinitely often.

    Args:
        never: edges that are known never to be taken.
    """
    return frozenset((step.process, step.number) for step in _recurrent(steps_but(network, known, never)))


def all_runs_end(network: Network, known: Known, never: Collection[tuple[int, int]]) -> bool:
    """True if certainly no run takes infinitely many transitions.

    Args:
        never: edges that are known never to be taken.
    """
    return not _recurrent(steps_but(network, known, never))


def steps_but(network: Network, known: Known, never: Collection[tuple[int, int]]) -> Steps:
    """The edges of a network that are not known never to be taken."""
    return frozenset(step for step in steps_of(network, known) if (step.process, step.number) not in never)


def suspicious(steps: Steps) -> Steps:
    """Edges that a run in which time does not diverge may take for ever; empty if there is no such run.

    Where more is to be tried than `MOST_TRIES`, the answer is what was left then.
    """
    tried: set[Steps] = set()
    waiting = [_recurrent(steps)]
    while waiting:
        check_job()
        rest = waiting.pop()
        if not rest or rest in tried:
            continue
        tried.add(rest)
        clock = _contested(rest)
        if clock is None or len(tried) > MOST_TRIES:
            return rest
        one = _recurrent(frozenset(step for step in rest if clock not in step.waits))
        other = _recurrent(frozenset(step for step in rest if clock not in step.resets))
        # An edge that can be taken for ever among some edges can be among more of them.
        waiting += [one] if other <= one else [other] if one <= other else [one, other]
    return frozenset()


def _contested(steps: Steps) -> Expression | None:
    """A clock that is both reset and waited for."""
    ordered = sorted(steps, key=lambda step: (step.process, step.number))
    waited = {clock for step in ordered for clock in step.waits}
    return next((clock for step in ordered for clock in sorted(step.resets, key=str) if clock in waited), None)


def _recurrent(steps: Steps) -> Steps:
    """The edges that are left when those go that can be taken only finitely often for what is left."""
    while True:
        check_job()
        remaining = _on_cycles(_answered(_undone(steps)))
        if remaining == steps:
            return steps
        steps = remaining


def _on_cycles(steps: Iterable[EdgeStep]) -> Steps:
    """The steps that lie on a cycle of their process."""
    by_process: dict[int, list[EdgeStep]] = {}
    for step in steps:
        by_process.setdefault(step.process, []).append(step)
    inner_steps: list[EdgeStep] = []
    for own in by_process.values():
        component = components((step.source, step.target) for step in own)
        inner_steps += (step for step in own if component[step.source] == component[step.target])
    return frozenset(inner_steps)


def _answered(steps: Steps) -> Steps:
    """The steps that have a partner; a broadcast needs none."""
    senders = [step for step in steps if step.channels and step.sends]
    receivers = [step for step in steps if step.channels and not step.sends]

    def may_meet(step: EdgeStep, others: list[EdgeStep]) -> bool:
        return any(
            other.process != step.process
            and other.channels & step.channels
            and (other.place is None or step.place is None or other.place == step.place)
            for other in others
        )

    def stays(step: EdgeStep) -> bool:
        if not step.channels or (step.sends and step.broadcast):
            return True
        return may_meet(step, receivers if step.sends else senders)

    return frozenset(filter(stays, steps))


def _undone(steps: Steps) -> Steps:
    """The steps all of whose changes of variables are undone by others."""
    writers: dict[Variable, list[EdgeStep]] = {}
    for step in steps:
        for variable in step.changes:
            writers.setdefault(variable, []).append(step)
    gone: set[EdgeStep] = set()
    for variable, own in writers.items():
        changes = [step.changes[variable] for step in own]
        if any(change is None for change in changes):
            continue
        component = components(pair for change in changes if change is not None for pair in change)
        for step, change in zip(own, changes, strict=True):
            if change is not None and not any(component[before] == component[after] for before, after in change):
                gone.add(step)
    return steps - gone


def components(arcs: Iterable[tuple[Node, Node]]) -> dict[Node, int]:
    """The number of the strongly connected component of each node (Kosaraju)."""
    after: dict[Node, list[Node]] = {}
    before: dict[Node, list[Node]] = {}
    for one, other in arcs:
        after.setdefault(one, []).append(other)
        before.setdefault(other, []).append(one)
        after.setdefault(other, [])
        before.setdefault(one, [])
    finished: list[Node] = []
    seen: set[Node] = set()
    for node in after:
        finished += _finishing(node, after.__getitem__, seen)
    number: dict[Node, int] = {}
    seen = set()
    for count, node in enumerate(reversed(finished)):
        for member in _finishing(node, before.__getitem__, seen):
            number[member] = count
    return number


def _finishing(start: Node, following: Callable[[Node], list[Node]], seen: set[Node]) -> Iterator[Node]:
    """The nodes not yet seen that are reached from one, each when all behind it are done."""
    if start in seen:
        return
    seen.add(start)
    stack = [(start, iter(following(start)))]
    while stack:
        node, rest = stack[-1]
        for other in rest:
            if other not in seen:
                seen.add(other)
                stack.append((other, iter(following(other))))
                break
        else:
            stack.pop()
            yield node
