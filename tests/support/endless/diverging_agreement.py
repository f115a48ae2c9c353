"""Obligations of which only runs count in which time diverges: verdicts with every option, and the oracles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from tachk.base.diagnostics.diagnostic import InternalError, UnsupportedError
from tachk.base.records import dataclass
from tachk.base.words import QueryKind
from tachk.engine.options import Extrapolation, Limits, Options
from tachk.engine.outcome import LivenessStatus, Obligation
from tachk.meaning.clock_constants import clock_constants
from tachk.meaning.discrete import prepare
from tachk.model.query import Query
from tachk.model.random_networks import RandomCase
from tachk.model.traversal import asks_deadlock
from tachk.verify.plan import Analysis, Search, Task
from tachk.verify.strategies import avoidable
from tachk.verify.verdict import Answer
from tests.support.agreement import UNWIDENED_LIMITS, ZONE_LIMITS, Effort, option_name
from tests.support.oracles.liveness_reference import check_by_zones
from tests.support.oracles.liveness_regions import check_by_regions


@dataclass(frozen=True, slots=True)
class DivergingAgreement:
    """Attributes:
    answers: to whether every run that counts meets its obligation, by engine; UNKNOWN where one has given up.
    problems: what cannot be right; empty if all is well.
    """

    answers: dict[str, Answer]
    problems: tuple[str, ...]


def compare_diverging(
    case: RandomCase, obligation: Obligation, variants: Sequence[Options], effort: Effort
) -> DivergingAgreement:
    """The verdicts contain runs, which their making has judged. Networks with stopwatches have no oracle."""
    network = case.network
    stopwatches = any(location.rates for process in network.processes for location in process.locations)
    asked = [e for e in (obligation.goal, obligation.trigger) if e is not None]
    answers: dict[str, Answer] = {}
    if not stopwatches:
        diverging = replace(obligation, diverges=True)
        found = {"zones": check_by_zones(network, diverging, Limits(states=effort.reference))}
        if not clock_constants(network, asked).diagonals:
            found["regions"] = check_by_regions(network, diverging, Limits(states=effort.sampled))
        answers = {name: _ANSWERS[outcome.status] for name, outcome in found.items()}
    elif any(map(asks_deadlock, asked)):
        return DivergingAgreement({}, ())
    problems = []
    for options in (Options(), *variants):
        limits = UNWIDENED_LIMITS if options.extrapolation is Extrapolation.NONE else ZONE_LIMITS
        try:
            answers[option_name(options)] = verdict(case, obligation, options, limits)
        except UnsupportedError:
            break
        except InternalError as error:
            problems.append(f"{option_name(options)}: {error}")
    holds = [name for name, answer in answers.items() if answer is Answer.HOLDS]
    fails = [name for name, answer in answers.items() if answer is Answer.FAILS]
    if holds and fails:
        problems.append(f"a diverging run is found by {fails}, there is none for {holds}")
    return DivergingAgreement(answers, tuple(problems))


_ANSWERS = {
    LivenessStatus.FOUND: Answer.FAILS,
    LivenessStatus.NONE: Answer.HOLDS,
    LivenessStatus.UNDECIDED: Answer.UNKNOWN,
}


def verdict(case: RandomCase, obligation: Obligation, options: Options, limits: Limits) -> Answer:
    """What `tachk verify --non-zeno` answers. Raises InternalError for a run that is none."""
    if obligation.trigger is None:
        query = Query("q", QueryKind.EVENTUALLY, obligation.goal, non_zeno=True)
    else:
        query = Query("q", QueryKind.LEADS_TO, obligation.trigger, (obligation.goal,), non_zeno=True)
    search = Search(Analysis.LIVENESS, (Task(0, query),))
    return avoidable(prepare(case.network), search, options, limits, True)[0].answer
