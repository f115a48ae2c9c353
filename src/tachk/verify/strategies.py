"""How verdicts are decided: for each kind of question, the strategies in the order in which they are tried.

A new strategy is a row here. The module of its function describes what it does.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from types import ModuleType

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import closest
from tachk.engine.options import REDUCTIONS, Limits, Options
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.transform.observed import observed
from tachk.verify.over_approximations import abstracted, symmetrised, unblocked
from tachk.verify.plan import Search
from tachk.verify.reachability import along_path, depth_first, equal_parts, explored, few_states, first_states
from tachk.verify.strategy import Decides, Findings, Problem, Strategy, decided
from tachk.verify.verdict import Verdict

_FEW, _FEW_DIVERGING, _SOME, _MANY = 1_000, 2_000, 20_000, 1_000_000
_KNOWN = Decides.REACHED | Decides.UNREACHABLE

REACHABILITY = (
    Strategy(
        "unblocked",
        "search without the processes that can only block others",
        unblocked,
        Decides.UNREACHABLE,
        states=_MANY,
        share=0.5,
    ),
    Strategy("along-path", "search along the path that was found without these processes", along_path, Decides.REACHED),
    Strategy(
        "few-states",
        "search for few states where the question can be asked of all interchangeable processes",
        few_states,
        states=_FEW,
        preliminary=True,
        plain=True,
    ),
    Strategy(
        "symmetrised",
        "ask the question of all interchangeable processes",
        symmetrised,
        Decides.UNREACHABLE,
        states=_MANY,
        share=0.5,
    ),
    Strategy(
        "first-states",
        "search for some states where variables can be abstracted",
        first_states,
        states=_SOME,
        preliminary=True,
        plain=True,
        parts=equal_parts,
    ),
    Strategy(
        "abstracted",
        "search with less known of the variables that tell processes apart",
        abstracted,
        Decides.UNREACHABLE,
        states=_MANY,
        share=0.5,
        parts=equal_parts,
    ),
    Strategy(
        "depth-first",
        "search depth first for some states where variables can be abstracted",
        depth_first,
        _KNOWN,
        states=_SOME,
        preliminary=True,
        parts=equal_parts,
    ),
    Strategy("zones", "search all states", explored, plain=True, parts=equal_parts),
)
"""Whether some state of a set can be reached: `E<>`, `A[]`, and formulas with deadlines by their observers."""


def _of_liveness(strategy_of: Callable[[ModuleType], Callable[[Problem], Findings]]) -> Callable[[Problem], Findings]:
    """A function of `tachk.verify.liveness`, which is loaded when it is called first."""

    def run(problem: Problem) -> Findings:
        from tachk.verify import liveness

        return strategy_of(liveness)(problem)

    return run


LIVENESS = (
    Strategy(
        "sliced",
        "search without what changes no run that goes on for ever",
        _of_liveness(lambda liveness: liveness.sliced),
        Decides.UNREACHABLE | Decides.ERRORS,
    ),
    Strategy(
        "any-run",
        "search for any run that avoids the goal, also one that does not count",
        _of_liveness(lambda liveness: liveness.any_run),
        plain=True,
    ),
    Strategy(
        "recurring",
        "search for runs that meet something again and again",
        _of_liveness(lambda liveness: liveness.recurring),
    ),
    Strategy(
        "short-delays",
        "search few states for runs in which a time unit passes again and again",
        _of_liveness(lambda liveness: liveness.short_delays),
        states=_FEW_DIVERGING,
        preliminary=True,
        plain=True,
    ),
    Strategy(
        "long-delays",
        "search for runs in which the longest waiting time passes again and again",
        _of_liveness(lambda liveness: liveness.long_delays),
        plain=True,
    ),
)
"""Whether some run avoids a predicate for ever: `A<>`, `E[]`, `-->`, and formulas without deadlines."""


def names() -> dict[str, str]:
    """All that can be switched off by name, with its meaning: strategies in their order, then reductions."""
    return {strategy.name: strategy.meaning for strategy in (*REACHABILITY, *LIVENESS)} | REDUCTIONS


def is_plain(name: str) -> bool:
    """Whether a strategy searches as one expects."""
    return any(strategy.plain for strategy in (*REACHABILITY, *LIVENESS) if strategy.name == name)


def check_names(without: Collection[str]) -> None:
    """Raises UsageError for a name that nothing has."""
    known = names()
    for name in sorted(without):
        if name not in known:
            near = closest(name, known)
            raise UsageError(
                f"there is no strategy `{name}` to be left out", f"did you mean `{near}`?" if near else ", ".join(known)
            )


def reachable(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, trace: bool
) -> dict[int, Verdict]:
    """Whether the targets of a search can be reached, as verdicts by the numbers of its tasks."""
    watched = observed(model.network, search.observer)
    problem = Problem(prepare(watched.network), watched, search.tasks, options, limits, trace)
    return decided(problem, REACHABILITY)


def avoidable(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, trace: bool
) -> dict[int, Verdict]:
    """Whether runs avoid the goals of a search for ever, as verdicts by the numbers of its tasks."""
    unobserved = observed(model.network, None)
    verdicts: dict[int, Verdict] = {}
    for task in search.tasks:
        problem = Problem(model, unobserved, (task,), options, limits, trace)
        verdicts |= decided(problem, LIVENESS)
    return verdicts
