"""The tables that decide verdicts: for each kind of question, the strategies in the order in which they are tried.

A new strategy is a row here. The module of its function describes what it does. The last strategy of a table always
answers, if the limits allow it; those before save states.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from typing import assert_never, cast

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import closest
from tachk.base.job import StoppedError, current_job, limited
from tachk.base.plugins import load_object
from tachk.engine.options import REDUCTIONS, Engine, Limits, Options
from tachk.engine.outcome import INTERRUPTED
from tachk.engine.portfolio import PORTFOLIO
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.transform.observed import observed
from tachk.transform.transformation import Exactness
from tachk.verify import sufficient_conditions
from tachk.verify.plan import Search
from tachk.verify.reachability import equal_parts
from tachk.verify.strategy import Findings, Problem, Strategy, agreed, decided
from tachk.verify.verdict import Answer, Verdict, none_begun

_FEW, _FEW_DIVERGING, _SOME, _MANY = 1_000, 2_000, 20_000, 1_000_000


def _named(row: str) -> Callable[[Problem], Findings]:
    """A function, ``module:function``, whose module is loaded when the strategy is tried first."""
    return lambda problem: cast("Findings", load_object(row)(problem))


def _along_path(problem: Problem) -> Findings:
    """As the function of this name, which has nothing to do where no over-approximation has found a path."""
    return _named("tachk.verify.along_path:along_path")(problem) if problem.reached else Findings({})


REACHABILITY = (
    Strategy(
        "unblocked",
        "search without the processes that can only block others",
        _named("tachk.verify.over_approximations:unblocked"),
        Exactness.UNREACHABLE,
        states=_MANY,
        share=0.5,
    ),
    Strategy(
        "along-path",
        "search along the path that was found without these processes",
        _along_path,
        Exactness.REACHABLE,
    ),
    Strategy(
        "first-runs",
        "look for a short run in few states, before it is known which processes are interchangeable",
        _named("tachk.verify.reachability:first_runs"),
        Exactness.REACHABLE,
        preliminary=True,
        plain=True,
    ),
    Strategy(
        "few-states",
        "search for few states with the symmetrised query, about all interchangeable processes",
        _named("tachk.verify.reachability:few_states"),
        states=_FEW,
        preliminary=True,
        plain=True,
    ),
    Strategy(
        "symmetrised",
        "search with the symmetrised query, about all interchangeable processes",
        _named("tachk.verify.over_approximations:symmetrised"),
        Exactness.UNREACHABLE,
        states=_MANY,
        share=0.5,
    ),
    Strategy(
        "first-states",
        "search for some states where variables can be abstracted",
        _named("tachk.verify.reachability:first_states"),
        states=_SOME,
        preliminary=True,
        plain=True,
        parts=equal_parts,
    ),
    Strategy(
        "abstracted",
        "search an abstraction of the variables that break the symmetry of processes",
        _named("tachk.verify.over_approximations:abstracted"),
        Exactness.UNREACHABLE,
        states=_MANY,
        share=0.5,
        parts=equal_parts,
    ),
    Strategy(
        "depth-first",
        "search depth first for some states where variables can be abstracted",
        _named("tachk.verify.reachability:depth_first"),
        Exactness.SAME_STATES,
        states=_SOME,
        preliminary=True,
        parts=equal_parts,
    ),
    Strategy("zones", "search all states", _named("tachk.verify.reachability:explored"), plain=True, parts=equal_parts),
)
"""For reachability of a set of states: `E<>`, `A[]`, and formulas with deadlines by their observers."""


SMT = (
    Strategy(
        "smt",
        "unroll runs step after step, and prove by induction what no longer one does",
        _named("tachk.verify.smt:induction"),
    ),
    Strategy(
        "bounded",
        "unroll runs step after step (bounded model checking)",
        _named("tachk.verify.smt:bounded"),
        Exactness.REACHABLE | Exactness.ERRORS,
    ),
)
"""The same, by z3."""

LIVENESS = (
    Strategy(
        "sliced",
        "search without what changes no run that goes on for ever",
        _named("tachk.verify.liveness:sliced"),
        Exactness.NO_RUN | Exactness.ERRORS,
    ),
    Strategy(
        "some-states",
        "search some states of the whole network where a run was found so",
        _named("tachk.verify.liveness:some_states"),
        Exactness.SAME_ANSWERS,
        states=_SOME,
        preliminary=True,
        plain=True,
    ),
    Strategy(
        "accompanied",
        "carry a run that was found so over to the whole network, where the others move only when they must",
        _named("tachk.verify.liveness:accompanied_run"),
        Exactness.RUN,
        share=0.5,
    ),
    Strategy(
        "decomposed",
        "leave out parts that have nothing to do with the goal, can always go on, and take their time",
        _named("tachk.verify.independent_parts:decomposed"),
        states=_MANY,
        share=0.5,
    ),
    Strategy(
        "any-run",
        "search for any run that avoids the goal, also one that does not count",
        _named("tachk.verify.liveness:any_run"),
        plain=True,
    ),
    Strategy(
        "recurring",
        "search for runs that meet something again and again",
        _named("tachk.verify.liveness:recurring"),
    ),
    Strategy(
        "short-delays",
        "search few states for runs in which a time unit passes again and again",
        _named("tachk.verify.liveness:short_delays"),
        states=_FEW_DIVERGING,
        preliminary=True,
        plain=True,
    ),
    Strategy(
        "long-delays",
        "search for runs in which the longest waiting time passes again and again",
        _named("tachk.verify.liveness:long_delays"),
        plain=True,
    ),
)
"""For runs that avoid a predicate for ever: `A<>`, `E[]`, `-->`, and formulas without deadlines."""

EXTREMES = (
    Strategy("measured", "measure integers in all states", _named("tachk.verify.extremes:measured"), plain=True),
    Strategy(
        "time-bound",
        "measure clocks up to a time bound, which is doubled until their values are below",
        _named("tachk.verify.extremes:time_bound"),
        plain=True,
    ),
    Strategy(
        "bisection",
        "search for states with a value beyond a number, and bisect",
        _named("tachk.verify.extremes:bisection"),
        plain=True,
    ),
)
"""For extreme values of expressions: `sup`, `inf`, `bounds`. Each strategy leaves open values to the next one."""


def every_strategy() -> tuple[Strategy, ...]:
    return (*REACHABILITY, *SMT, *LIVENESS, *EXTREMES)


def names() -> dict[str, str]:
    """All that can be switched off by name, with its meaning: strategies in their order, then reductions."""
    of_queries = {strategy.name: strategy.meaning for strategy in every_strategy()}
    portfolio = {strategy.name: strategy.meaning for strategy in PORTFOLIO}
    return of_queries | {sufficient_conditions.NAME: sufficient_conditions.MEANING} | portfolio | REDUCTIONS


def is_plain(name: str) -> bool:
    """True if a strategy searches as one expects."""
    return any(strategy.plain for strategy in every_strategy() if strategy.name == name)


def check_names(without: Collection[str]) -> None:
    """Raises UsageError for a name that nothing has."""
    known = names()
    for name in sorted(without):
        if name not in known:
            suggestion = closest(name, known)
            raise UsageError(
                f"there is no strategy `{name}` to be left out",
                f"did you mean `{suggestion}`?" if suggestion else ", ".join(known),
            )


def reachable(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, trace: bool
) -> dict[int, Verdict]:
    """Verdicts, by the numbers of the tasks, whether the targets of a search can be reached."""
    watched = observed(model.network, search.observer)
    problem = Problem(prepare(watched.network), watched, search.tasks, options, limits, trace)
    match options.engine:
        case Engine.ZONE:
            return decided(problem, REACHABILITY)
        case Engine.SMT:
            return decided(problem, SMT)
        case Engine.BOTH:
            return _by_both(problem)
        case never:
            assert_never(never)


def _by_both(problem: Problem) -> dict[int, Verdict]:
    """The verdicts of the zone engine, each compared with that of z3, which has the time that is left.

    Raises DisagreementError.
    """
    left = current_job().seconds_left
    try:
        with limited(None if left is None else left / 2):
            verdicts = decided(problem, REACHABILITY)
    except StoppedError as stopped:
        verdicts = none_begun(problem.tasks, stopped.reason)
    if any(verdict.reason == INTERRUPTED for verdict in verdicts.values()):
        return verdicts
    for number, smt in decided(problem, SMT).items():
        zone = verdicts[number]
        if smt.answer is Answer.UNKNOWN:
            verdicts[number] = zone.noted(f"only the zone engine has answered; smt: {smt.reason}")
        elif zone.answer is Answer.UNKNOWN:
            verdicts[number] = smt.noted(f"only the engine smt has answered; zone: {zone.reason}")
        else:
            verdicts[number] = agreed(problem.options, zone, smt)
    return verdicts


def avoidable(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, trace: bool
) -> dict[int, Verdict]:
    """Verdicts, by the numbers of the tasks, whether runs avoid the goals of a search for ever."""
    return _one_by_one(LIVENESS, model, search, options, limits, trace)


def extreme(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, trace: bool
) -> dict[int, Verdict]:
    """The extreme values that a search asks for, as verdicts by the numbers of its tasks."""
    return _one_by_one(EXTREMES, model, search, options, limits, trace)


def _one_by_one(
    table: Iterable[Strategy], model: PreparedNetwork, search: Search, options: Options, limits: Limits, trace: bool
) -> dict[int, Verdict]:
    unobserved = observed(model.network, None)
    verdicts: dict[int, Verdict] = {}
    for task in search.tasks:
        verdicts |= decided(Problem(model, unobserved, (task,), options, limits, trace), table)
    return verdicts
