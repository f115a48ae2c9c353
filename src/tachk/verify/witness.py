"""The witness of an answer: a timed run along the path that a search has found, judged before anybody sees it."""

from __future__ import annotations

from collections.abc import Sequence

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.job import unhurried
from tachk.engine.exact.concretise import concretise
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.model.expressions import Expression
from tachk.model.run import TimedTrace, Transition
from tachk.transform.transformation import Transformation


@unhurried()
def witness(
    reduced: Transformation, path: Sequence[Transition], target: Expression, exact: bool, what: str
) -> tuple[TimedTrace | None, bool]:
    """A replayed run to the target, in the network from which the searched one was made; None if there is none.

    Args:
        path: in the searched network.
        exact: whether each path that the search finds has a run.
        what: the path leads to, for messages.

    Returns:
        The run, and False where a process that was frozen meets a run-time error on the way.

    Raises InternalError if there is no run, or none that replays, although the search is exact.
    """
    run = concretise(prepare(reduced.network), path, target)
    if run is None:
        if exact:
            raise InternalError(f"the path found for {what} has no timed run")
        return None, True
    whole = reduced.lift(run)
    if whole is None:
        return None, False
    try:
        replay(prepare(reduced.original), whole, target)
    except ReplayError as error:
        if exact:
            raise InternalError(f"the run found for {what} does not replay: {error}") from error
        return None, True
    return whole, True
