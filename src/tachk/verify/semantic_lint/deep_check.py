"""One exploration and the findings from it, then the findings from the model alone."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence

from tachk.analysis.fold import Known, known_values
from tachk.analysis.recurrent_edges import all_runs_end, lasting_edges
from tachk.base.diagnostics.diagnostic import Diagnostic, InternalError, UnsupportedError
from tachk.base.job import StoppedError, limited, unhurried
from tachk.base.records import dataclass, replace
from tachk.base.words import QueryKind
from tachk.engine.compiler.features import check_supported
from tachk.engine.compiler.lower import lower
from tachk.engine.exact.concretise import concretise
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import TIME_LIMIT, GoalOutcome, Outcome, Statistics, Status
from tachk.engine.reduced_statistics import members_in_words
from tachk.engine.symmetry.detection import Difference, find_symmetry
from tachk.engine.symmetry.index_types import AsymmetryReason
from tachk.engine.symmetry.tables import tables_of
from tachk.engine.zone import explore_everything
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.initial_state import check_initial_state
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.model.expressions import BOOL, Constant, Expression
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.run import TimedTrace
from tachk.model.selections import check_selections
from tachk.verify.fault_explanation import diagnostic_of, explain
from tachk.verify.semantic_lint.findings import DeepCheck, LintAnswer, LintEvidence, counted
from tachk.verify.semantic_lint.guards import GuardGoal, always_true_findings, guard_goals, never_true
from tachk.verify.semantic_lint.reached import (
    in_some_process,
    switched_off,
    unreached_findings,
    unreached_locations,
    untaken_edges,
    untaken_findings,
)
from tachk.verify.semantic_lint.stuck import (
    TimeBoundedLocation,
    bounds_on_time,
    deadlock_finding,
    every_run_ends,
    plain_deadlocks,
    time_lock_finding,
    time_locks,
    time_passes,
    unlimited,
    urgent_lock_finding,
)
from tachk.verify.semantic_lint.zeno import ZenoRun, find_zeno_run, zeno_finding, zeno_findings

_QUESTION = "interchangeable processes"


def interchange_parts(network: Network) -> tuple[LintAnswer, ...]:
    """Nothing about a network in which no two processes have the same text up to numbers and variables.

    A query that names processes leaves only the others interchangeable.
    """
    if not _repeats(network):
        return ()
    symmetry = find_symmetry(network, [])
    lines: list[str] = []
    differences = list(symmetry.differences)
    for each, table in tables_of(network, symmetry):
        if isinstance(table, AsymmetryReason):
            first, second = (network.processes[block[0]] for block in each.members[:2])
            differences.append(Difference(first.template, first.name, second.name, table))
        else:
            lines.append(members_in_words(table.slots, table.cyclic, [process.name for process in network.processes]))
    lines += _differences(differences)
    return (LintAnswer(_QUESTION, "; ".join(lines)),) if lines else ()


def _repeats(network: Network) -> bool:
    """True if two processes may have the same text: a quick look."""
    shapes = [(len(p.locations), len(p.edges), len(p.variables), p.initial) for p in network.processes if p.edges]
    return len(set(shapes)) < len(shapes)


def _differences(differences: Sequence[Difference]) -> Iterable[str]:
    for each in differences:
        place = f" ({each.reason.span})" if each.reason.span.text else ""
        yield f"not all {each.template}: {each.reason.reason}{place}"


_STOPPED = "clocks stop in this model, so the states that were found may not all be real"


@dataclass(frozen=True, slots=True)
class Explored:
    """The result of the exploration.

    Attributes:
        bounds: the locations that limit time; None where clocks stop.
        guards: the questions about guards; ``unmet``: those that were not reached.
        ends: whether a time-lock and whether a plain deadlock is reached, in this order.
        flows: whether a state is reached in which time may pass for ever.
    """

    model: PreparedNetwork
    known: Known
    outcome: Outcome
    taken: frozenset[tuple[int, int]]
    bounds: list[TimeBoundedLocation] | None
    guards: list[GuardGoal]
    ends: tuple[GoalOutcome, ...]
    targets: tuple[Expression, ...]
    flows: GoalOutcome
    started: float

    @property
    def unmet(self) -> list[GuardGoal]:
        outcomes = self.outcome.goals[len(self.ends) + 1 :]
        return [goal for goal, found in zip(self.guards, outcomes, strict=True) if found.status is not Status.REACHED]

    @property
    def never(self) -> frozenset[tuple[int, int]]:
        """The edges that are certainly never taken."""
        if self.outcome.reason:
            return frozenset()
        processes = enumerate(self.model.network.processes)
        return frozenset((n, e) for n, process in processes for e in range(len(process.edges))) - self.taken


def deep_check(
    network: Network,
    warnings: Sequence[Diagnostic] = (),
    unused: Sequence[Diagnostic] | None = None,
    options: Options = Options(),
    limits: Limits = Limits(),
) -> DeepCheck:
    """Looks for what is odd about a network although no property asks for it.

    Args:
        warnings: the known findings about it, which are not reported again.
        unused: the names of its text that nothing uses; None where there is no text.

    A limit that is hit, a run-time error and a construct that cannot be checked leave questions undecided; each says
    why. Raises InputError where the initial state violates an invariant.
    """
    try:
        with limited(limits.seconds):
            explored = _explore(network, options, limits)
            with unhurried():
                found = [*_reached_parts(explored, warnings), *_stuck_parts(explored)]
            found.append(_zeno_part(explored, options, limits))
    except StoppedError:
        return _nothing(TIME_LIMIT)
    except UnsupportedError as error:
        return _nothing(error.diagnostic.message)
    found += _fault_parts(explored.outcome)
    found += interchange_parts(network)
    if unused is not None:
        found.append(LintAnswer("names never used or read", counted(tuple(unused)), tuple(unused)))
    return DeepCheck(tuple(found), explored.outcome.statistics, explored.outcome.reason)


def _explore(network: Network, options: Options, limits: Limits) -> Explored:
    started = time.monotonic()
    check_selections(network)
    check_supported(network, Query("", QueryKind.POSSIBLY, Constant(1, BOOL)))
    model = prepare(network)
    check_initial_state(model)
    known = known_values(network, [])
    stops = any(location.rates for process in network.processes for location in process.locations)
    bounds = None if stops else list(bounds_on_time(network, known))
    ends = (Constant(0, BOOL), plain_deadlocks([])) if bounds is None else (time_locks(bounds), plain_deadlocks(bounds))
    guards = list(guard_goals(network, known))
    program, goals = lower(network, [*ends, unlimited(bounds or []), *(goal.target for goal in guards)])
    goals = (*goals[: len(ends)], *(replace(goal, decides=False) for goal in goals[len(ends) :]))
    outcome, taken = explore_everything(program, goals, options, limits)
    if outcome.fault is not None:
        outcome = replace(outcome, fault=explain(model, outcome.fault))
    found = outcome.goals[: len(ends)], ends, outcome.goals[len(ends)]
    return Explored(model, known, outcome, taken, bounds, guards, *found, started)


def _nothing(reason: str) -> DeepCheck:
    parts = tuple(
        LintAnswer(question, "not decided", undecided=reason)
        for question in (_LOCATIONS, _EDGES, _GUARDS, *_ENDS, _ZENO)
    )
    return DeepCheck(parts, Statistics(), reason)


_LOCATIONS, _EDGES, _GUARDS = "locations never reached", "edges never taken", "guards always true"
_ZENO = "Zeno loops"
_ENDS = ("time-locks", "deadlocks in which time passes")


# ---- reached states -------------------------------------------------------------------------------------------------


def _reached_parts(explored: Explored, warnings: Sequence[Diagnostic]) -> tuple[LintAnswer, ...]:
    network, taken, outcome = explored.model.network, explored.taken, explored.outcome
    off = switched_off(network, explored.known)
    locations, edges = set(unreached_locations(network, taken)), set(untaken_edges(network, taken | off))
    if outcome.reason:
        edge_count = sum(len(process.edges) for process in network.processes)
        return (
            _so_far(_LOCATIONS, len(locations), sum(len(p.locations) for p in network.processes), outcome.reason),
            _so_far(_EDGES, edge_count - len(taken | off), edge_count, outcome.reason),
            LintAnswer(_GUARDS, "not decided", undecided=outcome.reason),
        )
    unmet = explored.unmet
    never = never_true(unmet)
    unreached = unreached_findings(network, taken, warnings)
    untaken = untaken_findings(network, taken | off, never, warnings)
    always = always_true_findings(network, unmet, explored.guards)
    return (
        LintAnswer(_LOCATIONS, _counted(unreached, in_some_process(network, locations)), unreached),
        LintAnswer(_EDGES, _counted(untaken, in_some_process(network, edges)), untaken),
        LintAnswer(_GUARDS, counted(always), always),
    )


def _so_far(question: str, missing: int, all_: int, reason: str) -> LintAnswer:
    """The answer to a question where the exploration ended early."""
    if not missing:
        return LintAnswer(question, "none")
    return LintAnswer(question, f"not decided: {missing} of {all_} not met so far", undecided=reason)


def _counted(findings: tuple[Diagnostic, ...], single: int) -> str:
    return f"{counted(findings)}, and {single} only in some processes of a template" if single else counted(findings)


# ---- where nothing follows ------------------------------------------------------------------------------------------


def _stuck_parts(explored: Explored) -> tuple[LintAnswer, ...]:
    parts = []
    for question, goal, target in zip(_ENDS, explored.ends, explored.targets, strict=True):
        parts.append(_stuck_part(explored, question, goal, target))
    if explored.bounds is None and explored.ends[1].status is not Status.UNREACHABLE:
        # Without knowing which invariants limit time, a deadlock may be of either kind.
        reason = _STOPPED if explored.ends[1].status is Status.REACHED else explored.outcome.reason
        return tuple(LintAnswer(question, "not decided", undecided=reason) for question in _ENDS)
    if parts[1].evidence and not time_passes(explored.model, parts[1].evidence[0].run):
        run = parts[1].evidence[0].run
        finding = urgent_lock_finding(explored.model.network, run)
        locked = LintAnswer(_ENDS[0], "reached", (finding,), (LintEvidence(finding, run),))
        return (parts[0] if parts[0].evidence else locked, LintAnswer(_ENDS[1], "not decided", undecided=_URGENT))
    return tuple(parts)


_URGENT = "an urgent channel stops time in the deadlock that was found; no other one was looked for"


def _stuck_part(explored: Explored, question: str, goal: GoalOutcome, target: Expression) -> LintAnswer:
    if goal.status is Status.UNREACHABLE:
        return LintAnswer(question, "none")
    if goal.status is Status.UNDECIDED:
        return LintAnswer(question, "not decided", undecided=explored.outcome.reason or TIME_LIMIT)
    if explored.bounds is None:
        return LintAnswer(question, "not decided", undecided=_STOPPED)
    run = _run(explored.model, goal, target)
    if question == _ENDS[1]:
        finding = deadlock_finding(explored.model.network, run)
        return LintAnswer(question, "reached", (finding,), (LintEvidence(finding, run),))
    finding = time_lock_finding(explored.model, explored.bounds, run)
    shown = (LintEvidence(finding, run),)
    if explored.flows.status is Status.UNREACHABLE and all_runs_end(
        explored.model.network, explored.known, explored.never
    ):
        return LintAnswer(question, "reached by every run", (finding, every_run_ends(finding)), shown)
    return LintAnswer(question, "reached", (finding,), shown)


def _run(model: PreparedNetwork, goal: GoalOutcome, target: Expression) -> TimedTrace:
    run = concretise(model, goal.path or (), target)
    if run is None:
        raise InternalError("the path found to a state without actions has no timed run")
    try:
        replay(model, run, target)
    except ReplayError as error:
        raise InternalError(f"the run found to a state without actions does not replay: {error}") from error
    return run


def _zeno_part(explored: Explored, options: Options, limits: Limits) -> LintAnswer:
    """The findings from the model alone, and where that is not enough, from a search of limited size."""
    network, known, never = explored.model.network, explored.known, explored.never
    try:
        with unhurried(_LEAST_SECONDS):
            findings = zeno_findings(network, known, never)
            lasting = lasting_edges(network, known, never)
    except StoppedError:
        return LintAnswer(_ZENO, "not decided", undecided=TIME_LIMIT)
    if not findings:
        return LintAnswer(_ZENO, "none possible")
    most = max(_LEAST_STATES, _TIMES_AS_MANY * explored.outcome.statistics.states_stored)
    bounded = replace(limits, states=most if limits.states is None else min(limits.states, most))
    try:
        found = find_zeno_run(explored.model, lasting, options, bounded)
    except StoppedError:
        found = True
    if isinstance(found, ZenoRun):
        finding = zeno_finding(network, found.loop)
        return LintAnswer(_ZENO, "found", (finding,), () if found.run is None else (LintEvidence(finding, found.run),))
    return LintAnswer(_ZENO, f"{len(findings)} may be", findings) if found else LintAnswer(_ZENO, "none")


_LEAST_STATES, _TIMES_AS_MANY = 20_000, 4
"""The limit on states of the search for a Zeno run: this number, or this multiple of the states of the model."""

_LEAST_SECONDS = 1.0
"""For the checks that need no search, and come after the search has used all the time."""


def _fault_parts(outcome: Outcome) -> tuple[LintAnswer, ...]:
    """The run-time error that ended the exploration, if one did."""
    if outcome.fault is None:
        return ()
    finding = diagnostic_of(outcome.fault)
    evidence = () if outcome.fault.run is None else (LintEvidence(finding, outcome.fault.run),)
    return (LintAnswer("run-time errors", "reached", (finding,), evidence),)
