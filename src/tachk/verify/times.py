"""The least and the largest time between two events, over all runs."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from time import monotonic

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.job import limited, unhurried
from tachk.base.records import dataclass, replace
from tachk.base.words import QueryKind
from tachk.engine.options import Limits, Options
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.model.event import Event
from tachk.model.expressions import Expression
from tachk.model.network import Network
from tachk.model.quantity import duration
from tachk.model.query import Query
from tachk.transform.event_timer import EventTimer, with_event_timer
from tachk.verify.verdict import Answer, Extreme, Verdict
from tachk.verify.verify import verify

BEST, WORST, WAITING = "best", "worst", "waiting"
FOR_EVER = "for ever"


@dataclass(frozen=True, slots=True)
class Times:
    """The times from one event to the next occurrence of another one.

    Attributes:
        best: the least one; its run ends with the second event. None where the second event never follows, or where it
            was not requested.
        worst: the largest one, among the runs on which the second event follows; None as `best`. Without a value where
            there is no limit: it may come as late as one likes.
        waiting: how long the second event can fail to come, whether or not it comes at last; None where the first one
            never comes. Without a value: some runs wait for it for ever.
        reason: why a requested time is not known; empty if all are.
        fault: whether that is a run-time error of the model.
        states: stored by the largest search.
        seconds: of all searches.
    """

    best: Extreme | None
    worst: Extreme | None
    waiting: Extreme | None
    reason: str = ""
    fault: bool = False
    states: int = 0
    seconds: float = 0.0

    @property
    def never_begins(self) -> bool:
        """True if the first event never comes, or the second one always with it."""
        return not self.reason and self.waiting is None and self.worst is None and self.best is None

    @property
    def may_wait_for_ever(self) -> bool:
        """True if nothing bounds how long the second event fails to come."""
        return self.waiting is not None and self.waiting.value is None

    def in_words(self, unit: str = "") -> dict[str, str]:
        """Each time: ``< 9`` for one that is approached, ``-`` where there is none, ``?`` where it is not known."""
        found = {"best": self.best, "worst": self.worst, "waits": self.waiting}
        return {name: self._time(name, extreme, unit) for name, extreme in found.items()}

    def _time(self, name: str, extreme: Extreme | None, unit: str) -> str:
        if extreme is None:
            return "?" if self.reason else "-"
        if extreme.value is None:
            return FOR_EVER if name == "waits" else "no limit"
        sign = "" if not extreme.strict else "> " if name == "best" else "< "
        return f"{sign}{duration(Fraction(extreme.value), unit)}"

    def __str__(self) -> str:
        times = ", ".join(f"{name}: {time}" for name, time in self.in_words().items())
        return f"{times} ({self.reason})" if self.reason else times

    def __repr__(self) -> str:
        return f"<Times {self}>"


def times_between(
    network: Network,
    start: Event | None,
    end: Event,
    last: bool = False,
    options: Options = Options(),
    limits: Limits = Limits(),
    requested: Sequence[str] = (BEST, WORST),
    trace: bool = True,
) -> Times:
    """The time from one event to another on every run.

    Args:
        start: None for the start of the run.
        last: from the last occurrence of the first event before the second one, not from the first.
        requested: BEST, WORST or both.
        trace: make the runs that take these times.

    Raises:
        InputError: the initial state violates an invariant.
        UnsupportedError: the model has something that cannot be checked.
        UsageError: an event is about a channel that an edge computes.
    """
    timed = with_event_timer(network, start, end, last)
    wanted = {BEST: BEST in requested, WORST: WORST in requested, WAITING: WORST in requested}
    questions = [(name, query) for name, query in _questions(timed) if wanted[name]]
    began = monotonic()
    found: dict[str, Extreme | None] = {}
    reason, fault, states = "", False, 0
    with limited(limits.seconds):
        for name, query in questions:
            (verdict,) = verify(timed.network, [query], options, limits, trace=trace)
            states = max(states, verdict.statistics.states_stored)
            if verdict.answer is Answer.UNKNOWN:
                reason, fault = verdict.reason, verdict.fault is not None
                break
            found[name] = _extreme(timed, verdict)
    return Times(found.get(BEST), found.get(WORST), found.get(WAITING), reason, fault, states, monotonic() - began)


def _questions(timed: EventTimer) -> list[tuple[str, Query]]:
    def query(name: str, kind: QueryKind, where: Expression) -> tuple[str, Query]:
        return name, Query(name, kind, where, (timed.clock,), name)

    return [
        query(BEST, QueryKind.INFIMUM, timed.done),
        query(WORST, QueryKind.SUPREMUM, timed.done),
        query(WAITING, QueryKind.SUPREMUM, timed.running),
    ]


@unhurried()
def _extreme(timed: EventTimer, verdict: Verdict) -> Extreme | None:
    """The value that was found, with its run as one of the network alone, replayed; None where there is no value."""
    if not verdict.extremes:
        return None
    (found,) = verdict.extremes
    extreme = found.least or found.largest
    assert extreme is not None
    if extreme.run is None:
        return extreme
    run = timed.lift(extreme.run)
    try:
        replay(prepare(timed.original), run)
    except ReplayError as error:
        raise InternalError(f"the run found for {verdict.query.name} does not replay: {error}") from error
    return replace(extreme, run=run)
