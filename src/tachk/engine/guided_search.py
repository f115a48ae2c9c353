"""Carrying a run over: a path that some processes of a network take, with what the others do meanwhile.

The path comes from a search in which the others were left out. A search of the whole network in which the processes of
the path follow it (`tachk.transform.guided`) is small, as they have nothing to choose. What it finds is followed once
more in the whole network as it is, without extrapolation: that decides.
"""

from __future__ import annotations

from collections.abc import Sequence

from tachk.base.records import replace
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import ProgramEdge
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.engine.outcome import INTERRUPTED, GoalOutcome, Outcome, Statistics, Status
from tachk.engine.zone import explore, leads_to
from tachk.model.expressions import Expression
from tachk.model.network import Network
from tachk.model.run import Participant, Transition
from tachk.transform.guided import GuidedNetwork

_ORDERS = (SearchOrder.BFS, SearchOrder.DFS)
"""Breadth first finds a shorter path, depth first finds one with fewer states."""


def states_along(path: Sequence[Transition], stored: int) -> int:
    """The limit on states of a search along a path, if ``stored`` were stored when the path was found."""
    return 10_000 + 20 * len(path) + 2 * stored


def explore_along(
    along: GuidedNetwork,
    network: Network,
    target: Expression,
    options: Options,
    limits: Limits,
) -> Outcome:
    """Search the guided form of a network for a path to the target that is one of the network.

    The goal is REACHED with a path of the network, or UNDECIDED: other paths were not looked for.
    """
    program, goals = lower(along.network, [target], along.tables)
    whole, whole_goals = lower(network, [target])
    statistics = Statistics()
    reason = ""
    for order in _ORDERS:
        searching = replace(options.off("local-times"), order=order)
        outcome = explore(program, goals, searching, limits)
        statistics = statistics.then(outcome.statistics)
        reason = outcome.reason
        (goal,) = outcome.goals
        if goal.status is Status.REACHED and goal.path is not None and outcome.exact:
            actions = _actions(whole.edges, goal.path)
            if leads_to(whole, whole_goals, options, actions, 0):
                return Outcome((goal,), statistics)
        if goal.status is Status.UNREACHABLE or reason == INTERRUPTED:
            break
    return Outcome((GoalOutcome(Status.UNDECIDED),), statistics, reason)


def _actions(edges: Sequence[ProgramEdge], path: Sequence[Transition]) -> list[list[int]]:
    """The transitions of a path by the numbers of edges of a program."""
    numbers = {Participant(edge.process, edge.edge, edge.selects): number for number, edge in enumerate(edges)}
    return [[numbers[participant] for participant in transition.participants] for transition in path]
