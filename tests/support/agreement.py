"""Runs all engines on one network and reports where they differ."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import InternalError, UnsupportedError
from tachk.base.job import Job, limited, under_way
from tachk.base.words import QueryKind
from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.exact.concretise import concretise
from tachk.engine.options import BoundScope, Extrapolation, Limits, LocalTimes, Options, SearchOrder
from tachk.engine.outcome import TIME_LIMIT, Outcome, Status
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.model.query import Query
from tachk.model.random_networks import RandomCase
from tachk.model.traversal import asks_deadlock
from tachk.verify.verdict import Answer
from tachk.verify.verify import verify
from tests.support.oracles import digitised, reference

VARIANTS = (
    Options().off("alu"),
    Options().off("merging"),
    Options().off("pruning"),
    Options(order=SearchOrder.BFS),
    Options(order=SearchOrder.PROGRESS),
    Options(order=SearchOrder.PROGRESS, reclaim=False),
    Options(order=SearchOrder.DFS),
    Options(order=SearchOrder.RANDOM_DFS, seed=7),
    Options(extrapolation=Extrapolation.MAX),
    Options(extrapolation=Extrapolation.NONE),
    Options(bounds=BoundScope.GLOBAL),
    Options(bounds=BoundScope.GLOBAL, extrapolation=Extrapolation.MAX),
    Options(subsumption=False),
    Options(width=32),
    Options(width=64),
    Options(scale=False),
    Options(vector=False),
    Options(width=32, vector=False),
    Options(width=64, vector=False),
    Options(chunk_words=1, rows_after=0),
    Options(shortest=True),
    Options(shortest=True, extrapolation=Extrapolation.MAX, bounds=BoundScope.GLOBAL),
    Options(reclaim=False, rows_after=1),
    Options(pack_clocks=0, rows_after=1),
    Options(pack_clocks=0, order=SearchOrder.DFS, extrapolation=Extrapolation.MAX, width=32),
    Options(pack_clocks=0, subsumption=False, rows_after=0),
    Options(order=SearchOrder.DFS, reclaim=False),
    Options(local_times=LocalTimes.ALWAYS),
)
"""Each option switched away from its default: none may change a verdict."""

ZONE_LIMITS = Limits(states=20_000)
_LONGEST = 20.0
"""In seconds. Few states can take long, too: up to a constant of millions, zones that are larger by a time unit replace
each other. Such a case is left out."""
UNWIDENED_LIMITS = Limits(states=2000, depth=25)
"""Without extrapolation a search need not end, even with a bounded number of stored states: ever larger zones replace
each other."""


@dataclass(frozen=True, slots=True)
class Effort:
    """How many states the oracles may store before they give up, and how many steps the second engine may unroll;
    None: it is not asked."""

    reference: int = 600
    sampled: int = 1500
    unrolled: int | None = None


@dataclass(frozen=True, slots=True)
class Agreement:
    """Attributes:
    outcomes: what each engine found, by name.
    problems: what cannot be right; empty if all is well.
    """

    outcomes: dict[str, Outcome]
    problems: tuple[str, ...]


def compare(case: RandomCase, variants: Sequence[Options] = VARIANTS, effort: Effort = Effort()) -> Agreement:
    """Runs the zone engine, with all variants of its options, and the oracles, and turns what they find into runs."""
    outcomes = {"reference": reference.explore(case.network, case.predicates, Limits(states=effort.reference))}
    sampled = Limits(states=effort.sampled)
    stopwatches = any(location.rates for process in case.network.processes for location in process.locations)
    if stopwatches:
        outcomes["grid"] = digitised.explore_grid(case.network, case.predicates, Fraction(1, 2), sampled)
    else:
        outcomes["regions"] = digitised.explore_regions(case.network, case.predicates, sampled)
    outcomes |= _zone_outcomes(case, variants)
    if effort.unrolled is not None:
        outcomes |= _smt_outcomes(case, Limits(depth=effort.unrolled))
    problems = _over_approximation(outcomes) if stopwatches else _contradictions(outcomes)
    answers = _answers(case, outcomes, stopwatches) if "zone" in outcomes else ()
    return Agreement(outcomes, (*problems, *_lengths(outcomes), *_runs(case, outcomes, stopwatches), *answers))


def _zone_outcomes(case: RandomCase, variants: Sequence[Options]) -> dict[str, Outcome]:
    try:
        program, goals = lower(case.network, case.predicates)
    except UnsupportedError:
        return {}
    with limited(_LONGEST):
        outcomes = {"zone": zone.explore(program, goals, Options(), ZONE_LIMITS)}
    if outcomes["zone"].reason == TIME_LIMIT:
        return {}
    stored = outcomes["zone"].statistics.states_stored
    for name, limits in (
        ("states", Limits(states=stored // 2)),
        ("depth", Limits(depth=2)),
    ):
        outcomes[f"zone limited in {name}"] = zone.explore(program, goals, Options(), limits)
    with under_way(Job(ends=0.0)):
        outcomes["zone limited in seconds"] = zone.explore(program, goals)
    for options in variants:
        limits = UNWIDENED_LIMITS if options.extrapolation is Extrapolation.NONE else ZONE_LIMITS
        outcomes[option_name(options)] = zone.explore(program, goals, options, limits)
    return outcomes


def _smt_outcomes(case: RandomCase, limits: Limits) -> dict[str, Outcome]:
    """What the second engine finds, if it encodes the network."""
    from tachk.engine.smt.search import explore

    try:
        return {"smt": explore(case.network, case.predicates, limits)}
    except UnsupportedError:
        return {}


def _answers(case: RandomCase, outcomes: dict[str, Outcome], stopwatches: bool) -> Iterator[str]:
    """What is wrong with the verdicts: processes are left out, paths get their runs, errors their explanation."""
    queries = [Query(f"q{number}", QueryKind.POSSIBLY, goal) for number, goal in enumerate(case.predicates)]
    for limits in (ZONE_LIMITS, Limits(states=outcomes["zone"].statistics.states_stored // 2)):
        try:
            verdicts = verify(case.network, queries, limits=limits)
        except InternalError as error:
            yield f"verify: {error}"
            return
        for number, verdict in enumerate(verdicts):
            # Processes that were held still may meet a run-time error in the very state in which a goal was noted.
            compared = {name: o for name, o in outcomes.items() if not (verdict.unexamined and o.fault)}
            unreachable, reached = (
                {name for name, outcome in compared.items() if outcome.goals[number].status is status}
                for status in (Status.UNREACHABLE, Status.REACHED)
            )
            if verdict.answer is Answer.HOLDS and unreachable - {"grid"}:
                yield f"goal {number}: unreachable, verify finds it"
            if verdict.answer is Answer.FAILS and verdict.exact and reached & (set(_TRUE) if stopwatches else reached):
                yield f"goal {number}: reachable, verify does not find it"


def option_name(options: Options) -> str:
    """``zone`` and what differs from the default options."""
    different = ((f.name, getattr(options, f.name)) for f in fields(Options) if getattr(options, f.name) != f.default)
    return " ".join(["zone", *(f"{name}={value}" for name, value in different)])


def _contradictions(outcomes: dict[str, Outcome]) -> Iterator[str]:
    for goal, statuses in _by_goal(outcomes):
        reached = [name for name, status in statuses.items() if status is Status.REACHED]
        unreachable = [name for name, status in statuses.items() if status is Status.UNREACHABLE]
        if reached and unreachable:
            yield f"goal {goal}: reached by {reached}, unreachable for {unreachable}"
    yield from _missed_faults(outcomes, [name for name, outcome in outcomes.items() if outcome.fault is not None])


def _missed_faults(outcomes: dict[str, Outcome], met: Sequence[str]) -> Iterator[str]:
    """Whoever explored everything has met the run-time errors that others have met."""
    missed = [
        name
        for name, outcome in outcomes.items()
        if outcome.fault is None and any(goal.status is Status.UNREACHABLE for goal in outcome.goals) and name != "grid"
    ]
    if met and missed:
        fault = outcomes[met[0]].fault
        assert fault is not None
        yield f"run-time error ({fault.kind.name}) met by {met}, not by {missed}"


def _lengths(outcomes: dict[str, Outcome]) -> Iterator[str]:
    """The oracle that samples regions goes from layer to layer: its paths are shortest."""
    oracle = outcomes.get("regions")
    if oracle is None:
        return
    for name, outcome in outcomes.items():
        if "shortest=True" not in name:
            continue
        for number, (least, found) in enumerate(zip(oracle.goals, outcome.goals, strict=True)):
            if least.path is not None and found.path is not None and len(least.path) != len(found.path):
                yield f"goal {number}: {name} finds a path of {len(found.path)} steps, the oracle of {len(least.path)}"


_TRUE = ("grid", "smt")
"""What these reach is reachable, though clocks stop."""


def _over_approximation(outcomes: dict[str, Outcome]) -> Iterator[str]:
    for goal, statuses in _by_goal(outcomes):
        missed = [name for name, status in statuses.items() if status is Status.UNREACHABLE and name != "grid"]
        reached = [name for name in _TRUE if statuses.get(name) is Status.REACHED]
        if reached and missed:
            yield f"goal {goal}: truly reachable by {reached}, missed by {missed}"
    yield from _missed_faults(outcomes, [name for name in _TRUE if name in outcomes and outcomes[name].fault])


def _by_goal(outcomes: dict[str, Outcome]) -> Iterator[tuple[int, dict[str, Status]]]:
    for goal in range(len(next(iter(outcomes.values())).goals)):
        yield goal, {name: outcome.goals[goal].status for name, outcome in outcomes.items()}


_ORACLES = ("reference", "regions")


def _runs(case: RandomCase, outcomes: dict[str, Outcome], stopwatches: bool) -> Iterator[str]:
    model = prepare(case.network)
    for name, outcome in outcomes.items():
        for number, goal in enumerate(outcome.goals):
            # The oracles note goals before they evaluate what else the state asks for.
            if goal.path is None or (name in _ORACLES and outcome.fault is not None):
                continue
            trace = concretise(model, goal.path, case.predicates[number])
            if trace is None:
                if not stopwatches or name in _TRUE:
                    yield f"goal {number}: the path found by {name} has no run"
                continue
            try:
                replay(model, trace, case.predicates[number])
            except ReplayError as error:
                # Where clocks stop, zones say of too many states that they are dead.
                if stopwatches and asks_deadlock(case.predicates[number]):
                    continue
                yield f"goal {number}: the run for the path found by {name} does not replay: {error}"
