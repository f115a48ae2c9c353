"""Runs the search for runs that avoid a goal, and its oracles, on one network and reports where they differ."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.job import Job, under_way
from tachk.engine.compiler.lower import lower_obligation
from tachk.engine.lasso import lasso
from tachk.engine.liveness import find_avoiding_run
from tachk.engine.options import Extrapolation, Limits, Options
from tachk.engine.outcome import LivenessOutcome, LivenessStatus, Obligation
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import ReplayError
from tachk.meaning.judge.replay_lasso import replay_lasso
from tachk.model.random_networks import RandomCase
from tachk.model.traversal import asks_deadlock
from tests.support.agreement import UNWIDENED_LIMITS, ZONE_LIMITS, Effort, option_name
from tests.support.oracles.liveness_reference import check_by_zones
from tests.support.oracles.liveness_regions import check_by_regions

_ZONES, _REGIONS = "zones", "regions"
_ORACLES = (_ZONES, _REGIONS)

_EFFORT = Effort()


@dataclass(frozen=True, slots=True)
class LivenessAgreement:
    """Attributes:
    outcomes: what each engine found, by name.
    problems: what cannot be right; empty if all is well.
    """

    outcomes: dict[str, LivenessOutcome]
    problems: tuple[str, ...]


def compare_obligation(
    case: RandomCase, obligation: Obligation, variants: Sequence[Options], effort: Effort = _EFFORT
) -> LivenessAgreement:
    """Looks for a run that avoids the goal: with the search, all variants of its options, and both oracles; what is
    found must become a run with delays that the judge accepts. Networks with stopwatches have no oracle."""
    outcomes: dict[str, LivenessOutcome] = {}
    if not any(location.rates for process in case.network.processes for location in process.locations):
        outcomes[_ZONES] = check_by_zones(case.network, obligation, Limits(states=effort.reference))
        outcomes[_REGIONS] = check_by_regions(case.network, obligation, Limits(states=effort.sampled))
    outcomes |= _searched(case, obligation, variants)
    return LivenessAgreement(
        outcomes, (*_contradictions(outcomes), *_missed_faults(outcomes), *_runs(case, obligation, outcomes))
    )


def _searched(case: RandomCase, obligation: Obligation, variants: Sequence[Options]) -> dict[str, LivenessOutcome]:
    stopwatches = any(location.rates for process in case.network.processes for location in process.locations)
    if stopwatches and any(asks_deadlock(e) for e in (obligation.goal, obligation.trigger) if e is not None):
        return {}  # which is refused
    try:
        program, goal, trigger = lower_obligation(case.network, obligation.goal, obligation.trigger)
    except UnsupportedError:
        return {}
    outcomes = {}
    for options in (Options(), *variants):
        limits = UNWIDENED_LIMITS if options.extrapolation is Extrapolation.NONE else ZONE_LIMITS
        outcomes[option_name(options)] = find_avoiding_run(program, goal, trigger, options, limits)
    stored = outcomes["zone"].statistics.states_stored
    limits = Limits(states=stored // 2)
    outcomes["zone limited in states"] = find_avoiding_run(program, goal, trigger, Options(), limits)
    with under_way(Job(ends=0.0)):
        outcomes["zone limited in seconds"] = find_avoiding_run(program, goal, trigger)
    return outcomes


def _contradictions(outcomes: dict[str, LivenessOutcome]) -> Iterator[str]:
    exact = {name: outcome for name, outcome in outcomes.items() if outcome.exact or outcome.run is None}
    found = [name for name, outcome in exact.items() if outcome.status is LivenessStatus.FOUND]
    none = [name for name, outcome in exact.items() if outcome.status is LivenessStatus.NONE]
    if found and none:
        yield f"a run is found by {found}, there is none for {none}"


def _missed_faults(outcomes: dict[str, LivenessOutcome]) -> Iterator[str]:
    """A search that says that there is no run has met the run-time errors that others have met.

    An oracle may have met less: it does not look at a state in which the goal is met, nor at both sides of a condition
    of which one decides.
    """
    met = [name for name, outcome in outcomes.items() if outcome.fault is not None]
    searches = {name: outcome for name, outcome in outcomes.items() if name not in _ORACLES}
    none = [name for name, outcome in searches.items() if outcome.status is LivenessStatus.NONE]
    if met and none:
        yield f"a run-time error is met by {met}, not by {none}"


def _runs(case: RandomCase, obligation: Obligation, outcomes: dict[str, LivenessOutcome]) -> Iterator[str]:
    model = prepare(case.network)
    tried = set()
    for name, outcome in outcomes.items():
        if outcome.run is None or outcome.run in tried:
            continue
        tried.add(outcome.run)
        trace = lasso(model, outcome.run, obligation)
        if trace is None:
            if outcome.exact:
                yield f"what {name} found has no run: {outcome.run}"
            continue
        try:
            replay_lasso(model, trace, obligation.goal, obligation.trigger)
        except ReplayError as error:
            if outcome.exact:
                yield f"the run for what {name} found does not replay: {error}"
