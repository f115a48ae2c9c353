"""The goal of a test that a property gives: a state that decides it, and a run of the model that leads there."""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import replace
from tachk.engine.options import Limits
from tachk.frontend.loaded import LoadedModel
from tachk.model.query import Query
from tachk.model.traversal import asks_deadlock
from tachk.recordings.conformance.location_columns import with_location_variables
from tachk.simulation.testing.property_goal import PropertyGoal
from tachk.verify.questions import Questions
from tachk.verify.verdict import Answer, answers_of
from tachk.verify.verify import verify

_STATES = 300_000
"""Where no limit is given, a run is looked for among so many states."""


def property_goal(loaded: LoadedModel, path: str, name: str, limits: Limits) -> PropertyGoal:
    """The goal that a property of a model names.

    Args:
        path: what messages call the model.
        limits: of the search for a run.

    Raises:
        InputError: something in the property is wrong.
        UsageError: there is no property of that name, no single state decides it, or no run of the model leads to one.
    """
    (query,) = Questions(path, names=(name,)).about(loaded)
    if not isinstance(query, Query) or query.target is None or asks_deadlock(query.target):
        raise UsageError(
            f"`{name}` is decided by no single state, so a test cannot go there",
            "name a property with A[] or E<> that does not contain `deadlock`, or a formula with bounds",
        )
    network = loaded.network
    if loaded.recording is not None:
        network, _ = with_location_variables(network, loaded.recording)
    (verdict,) = verify(network, [query], limits=replace(limits, states=limits.states or _STATES))
    if verdict.answer is answers_of(query)[1]:
        word = "holds" if verdict.answer is Answer.HOLDS else "fails"
        raise UsageError(
            f"`{name}` {word} in the model: no run of it leads to a state that a test could go to",
            "name a property whose answer is the other one",
        )
    return PropertyGoal(query, verdict.trace)
