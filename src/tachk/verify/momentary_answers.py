"""Answers that come for no time only: in a run that violates a formula although it passes through what is awaited.

Temporal properties speak of what lasts. A run may violate `G (p -> F[0,5] q)` and pass through a state with q in time,
in which it lets no time pass; the verdict then says so. Only the run is looked at, so nothing is searched.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from fractions import Fraction

from tachk.analysis.fold import cannot_fail
from tachk.meaning.discrete import PreparedNetwork
from tachk.meaning.step import satisfies
from tachk.model.expressions import Expression
from tachk.model.quantity import duration
from tachk.model.query import Observer
from tachk.model.run import DiscreteState, TimedTrace
from tachk.transform.observed import ObserverMove
from tachk.verify.verdict import Answer, Verdict


def with_momentary_answers(model: PreparedNetwork, verdict: Verdict) -> Verdict:
    """The verdict, with a note for each condition that its run awaits in vain and has for no time only."""
    observer, run = verdict.query.observer, verdict.trace
    if observer is None or run is None or verdict.answer is not Answer.FAILS:
        return verdict
    since = _window_begins(observer, verdict.moves)
    for text, condition in observer.awaited:
        if cannot_fail(condition):
            moment = next((time for time in moments(model, run, condition) if time >= since), None)
            if moment is not None:
                when = duration(moment, model.network.time_unit)
                verdict = verdict.noted(
                    f"in its run, `{text}` is true for no time at {when}; that does not count (`-->` counts it)"
                )
    return verdict


def moments(model: PreparedNetwork, run: TimedTrace, condition: Expression) -> Iterator[Fraction]:
    """The times at which a condition without clocks is true in some state, but neither for some time before nor after.

    The last state of the run counts as one that lasts.
    """
    truths: dict[DiscreteState, bool] = {}
    for state in run.states:
        if state.discrete not in truths:
            truths[state.discrete] = satisfies(model, state, condition)
    states = [(state.time, truths[state.discrete]) for state in run.states]
    ends = [*(time for time, _ in states[1:]), None]
    true = [(begin, end) for (begin, truth), end in zip(states, ends, strict=True) if truth]
    lasting = [(begin, end) for begin, end in true if begin != end]
    begins = [begin for begin, _ in lasting]
    for moment, _ in true:
        before = bisect_right(begins, moment)
        end = lasting[before - 1][1] if before else moment - 1
        if end is not None and end < moment:
            yield moment


def _window_begins(observer: Observer, moves: Sequence[ObserverMove]) -> Fraction:
    """The moment from which on the observer awaits what does not come: where it last leaves its initial location, or
    the start of the run if it goes from there to the violation."""
    home = observer.process.locations[observer.process.initial].name
    left = max((number for number, move in enumerate(moves) if move.location == home), default=-1) + 1
    return moves[left].time if left < len(moves) - 1 else Fraction(0)
