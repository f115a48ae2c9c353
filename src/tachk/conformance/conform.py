"""Is a recording a run of a model? The search for that run, by the zone engine."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from tachk.certify.replay import replay
from tachk.compiler.features import check_selections
from tachk.compiler.lower import Measured, lower, lower_measures
from tachk.conformance.edits import Edit
from tachk.conformance.events import Recording
from tachk.conformance.followers import Following, follow
from tachk.conformance.queues import Constants, Queues, make_queues
from tachk.conformance.refusal import Offer, end_of, offers, state_text
from tachk.diagnostics.diagnostic import InternalError
from tachk.engines.concretise import concretise
from tachk.engines.measuring import measure
from tachk.engines.options import Limits, Options, SearchOrder
from tachk.engines.outcome import Outcome, Statistics, Status
from tachk.engines.zone import explore
from tachk.model.expressions import BOOL, Constant
from tachk.model.network import Network
from tachk.model.recording import RecordingMap
from tachk.records import dataclass
from tachk.semantics.discrete import prepare
from tachk.semantics.timed_trace import TimedTrace, Transition

_TRUE = Constant(1, BOOL)


@dataclass(frozen=True, slots=True)
class Refusal:
    """Where the recording leaves the model, as far as any run goes along with it.

    Attributes:
        path: of a run that has as many events of the recording as possible.
        happened: how many of them, in each queue.
        event: the number of the event that cannot come next; None if all have come and the model would not be silent.
        state: the locations of the model there.
        offers: what it could do there.
    """

    path: tuple[Transition, ...]
    happened: tuple[int, ...]
    event: int | None
    state: str
    offers: tuple[Offer, ...]


@dataclass(frozen=True, slots=True)
class Conformance:
    """Attributes:
    accepted: the recording is a run of the model; None where a limit was hit first.
    tolerance, late: with which this was found, in units of the model.
    run: a run of the followed network that shows it; None where none was asked for.
    path: its transitions.
    refusal: where the recording leaves the model; None where it does not, or that was not found in the limits.
    reason: why there is no answer; empty if there is one.
    edit: of the recording, with which it would be a run; None where it is one, or none was found.
    """

    accepted: bool | None
    tolerance: Fraction
    late: Fraction
    recording: Recording
    following: Following
    queues: Queues
    statistics: Statistics
    run: TimedTrace | None = None
    path: tuple[Transition, ...] = ()
    refusal: Refusal | None = None
    reason: str = ""
    edit: Edit | None = None


def conform(
    network: Network,
    mapping: RecordingMap,
    recording: Recording,
    constants: Constants,
    tolerance: Fraction | None = None,
    late: Fraction | None = None,
    options: Options = Options(order=SearchOrder.DFS),
    limits: Limits = Limits(),
    run: bool = True,
    explain: bool = True,
) -> Conformance:
    """Whether a recording is a run of a model.

    Args:
        tolerance, late: in units of the model; None: as the model says.
        run: make a run that shows it, and replay it.
        explain: find where the recording leaves the model, by a second search.

    Raises UsageError for a recording that does not fit the model, UnsupportedError.
    """
    tolerance = mapping.tolerance if tolerance is None else tolerance
    late = mapping.late if late is None else late
    late = tolerance if late is None else late
    queues = make_queues(network, mapping, recording, constants, tolerance, late)
    following = follow(network, mapping, queues)
    check_selections(following.network)
    program, goals = lower(following.network, [following.done], following.tables)
    outcome = explore(program, goals, options, limits)
    found = outcome.goals[0]
    base = Conformance(None, tolerance, late, recording, following, queues, outcome.statistics)

    def refusal() -> Refusal | None:
        return _furthest(following, queues, options, limits) if explain else None

    match found.status:
        case Status.REACHED:
            path = found.path or ()
            return _with(base, accepted=True, path=path, run=_run(following, path) if run else None)
        case Status.UNREACHABLE if not outcome.reason:
            return _with(base, accepted=False, refusal=refusal())
        case _:
            return _with(base, reason=_reason(outcome), refusal=refusal())


def _reason(outcome: Outcome) -> str:
    return outcome.reason or "unknown"


def _with(base: Conformance, **changes: object) -> Conformance:
    from dataclasses import replace

    return replace(base, **changes)  # type: ignore[arg-type]


def _run(following: Following, path: tuple[Transition, ...]) -> TimedTrace:
    """The run along a path, judged by other code than what found it."""
    model = prepare(following.network)
    trace = concretise(model, path, following.done)
    if trace is None:
        raise InternalError("the run that was found cannot be made")
    replay(model, trace, following.done)
    return trace


def _furthest(following: Following, queues: Queues, options: Options, limits: Limits) -> Refusal | None:
    """A run that goes along with the recording as far as any."""
    measured = Measured(_TRUE, following.progress, largest=True)
    program, goals, measures = lower_measures(following.network, [measured], following.tables)
    _, (found,) = measure(program, goals, measures, options, limits)
    if found is None:
        return None
    happened = tuple(_happened(following, queues, found.path))
    waiting = [
        (queue.latest[count], queue.events[count])
        for queue, count in zip(queues.queues, happened, strict=True)
        if count < len(queue.events)
    ]
    event = min(waiting)[1] if waiting else None
    state = state_text(following, end_of(following, found.path))
    return Refusal(found.path, happened, event, state, offers(following, queues, found.path))


def _happened(following: Following, queues: Queues, path: Sequence[Transition]) -> list[int]:
    counts = [0] * len(queues.queues)
    for transition in path:
        queue = following.queue_of(transition)
        if queue is not None and counts[queue] < len(queues.queues[queue].events):
            counts[queue] += 1
    return counts
