"""A run of a model with some values of its constants as a run with others: the same transitions at other times."""

from __future__ import annotations

from collections.abc import Sequence

from tachk.engine.exact.concretise import concretise
from tachk.engine.outcome import Statistics
from tachk.meaning.discrete import prepare
from tachk.meaning.initial_state import check_initial_state
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.run import Participant, Transition
from tachk.model.types import BoolType, IntType, ScalarType, bounds
from tachk.transform.observed import observed
from tachk.verify.verdict import Verdict, answers_of


def retimed(network: Network, query: Query, path: Sequence[Transition]) -> Verdict | None:
    """The verdict that the states the query looks for are reached, if these transitions lead there; else None.

    The run has been replayed. Raises InputError where the initial state violates an invariant.

    Args:
        path: transitions of the network with the observer of the query.
    """
    watched = observed(network, query.observer)
    whole = watched.network
    if not all(_exists(whole, participant) for transition in path for participant in transition.participants):
        return None
    check_initial_state(prepare(network))
    model = prepare(whole)
    try:
        run = concretise(model, path, query.target)
        if run is None:
            return None
        replay(model, run, query.target)
    except (ValueError, ReplayError):
        return None
    moves = watched.moves(run)
    return Verdict(
        query, answers_of(query)[0], True, "", Statistics(), watched.lift(run), moves=moves, path=tuple(path)
    )


def _exists(network: Network, participant: Participant) -> bool:
    """Whether the network has such an edge with such values of its select variables."""
    if participant.process >= len(network.processes):
        return False
    edges = network.processes[participant.process].edges
    if participant.edge >= len(edges) or len(edges[participant.edge].selects) != len(participant.selects):
        return False
    for variable, value in zip(edges[participant.edge].selects, participant.selects, strict=True):
        assert isinstance(variable.type, IntType | BoolType | ScalarType)
        low, high = bounds(variable.type)
        if not low <= value <= high:
            return False
    return True
