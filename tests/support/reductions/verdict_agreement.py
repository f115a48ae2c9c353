"""Verdicts with and without what saves states: each reduction alone, all by default, and as many as can be.

The other comparisons of this package hold engines against oracles. This one asks whole questions, as users do, so that
it sees what is left out before a search, what is put back into its runs, and where a reduction has to be off.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from random import Random

import tachk
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.words import QueryKind
from tachk.engine.options import Limits, LocalTimes, Options, SearchOrder
from tachk.model.connectives import negation
from tachk.model.expressions import Deadlock
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.random_networks import Shape, random_case
from tachk.verify.verdict import Answer, Verdict
from tachk.verify.verify import verify
from tests.support.queries import elaborate_queries
from tests.support.strategies import each_switched_off
from tests.support.symmetric.cases import SymmetricCase, random_symmetric_case
from tests.support.symmetric.controllers import random_controller_case
from tests.support.symmetric.counted import random_counted_case
from tests.support.symmetric.cycles import random_ring_case
from tests.support.symmetric.registers import random_register_case

NO_REDUCTION = Options(order=SearchOrder.BFS, subsumption=False).off(
    "local-times", "unblocked", "sliced", "alu", "merging", "pruning", "cone", "symmetry", "attempts"
)
BY_DEFAULT = Options()
ALONE: Mapping[str, Options] = {
    "subsumption": replace(NO_REDUCTION, subsumption=True),
    "alu": replace(NO_REDUCTION.on("alu"), subsumption=True),
    "merging": replace(NO_REDUCTION.on("merging"), subsumption=True),
    "pruning": NO_REDUCTION.on("pruning"),
    "local times": replace(NO_REDUCTION.on("local-times"), local_times=LocalTimes.ALWAYS),
    "partial order": replace(NO_REDUCTION, partial_order=True),
    "cone of influence": NO_REDUCTION.on("cone"),
    "without what only blocks": NO_REDUCTION.on("unblocked", "sliced"),
    "symmetry": NO_REDUCTION.on("symmetry"),
}
TOGETHER: Mapping[str, Options] = {
    **each_switched_off(),
    "without pruning": Options().off("pruning"),
    "local times and symmetry": Options(local_times=LocalTimes.ALWAYS),
    "partial order, all": Options(partial_order=True).off("symmetry"),
    "depth first": Options(order=SearchOrder.DFS),
    "by progress": Options(order=SearchOrder.PROGRESS),
    "shortest": Options(shortest=True),
}

SHAPES = (
    Shape(processes=3, locations=3, clocks=2),
    Shape(priorities=True, processes=3, locations=3, clocks=2),
    Shape(hurried=0.6, groups=2, clocks=1, processes=2, locations=3),
    Shape(language=True, faults=0.2, processes=3, locations=3, clocks=2),
    Shape(receivers=1, blockers=1, processes=2, clocks=1, locations=3),
    Shape(own_data=0.7, companions=2, processes=2, clocks=1, locations=3),
)

FEW_STATES = Limits(states=3000)


@dataclass(frozen=True, slots=True)
class Questions:
    """A network and queries about it.

    Attributes:
        one_by_one: the queries are asked one after the other; else they may share a search.
    """

    kind: str
    network: Network
    queries: tuple[Query, ...]
    one_by_one: bool = False


@dataclass(frozen=True, slots=True)
class Compared:
    """Attributes:
    verdicts: of each way to search, by its name.
    problems: what cannot be right; empty if all is well.
    """

    verdicts: Mapping[str, tuple[Verdict, ...]]
    problems: tuple[str, ...]


def random_questions(seed: int) -> Questions:
    """A small network with questions about single states, deadlocks and runs: of ten, four have interchangeable
    processes, or almost, in the ways of this package, one a ring, and one a variable that goes through processes. Every
    second ten of them are asked one by one."""
    return replace(_questions(seed), one_by_one=seed // 10 % 2 == 1)


def _questions(seed: int) -> Questions:
    random = Random(seed)
    match seed % 10:
        case 0 | 1:
            return _of_text("symmetric", random_symmetric_case(random), random)
        case 2:
            return _of_text("controller", random_controller_case(random), random)
        case 3:
            return _of_text("registers", random_register_case(random), random)
        case 4:
            return _of_text("ring", random_ring_case(random), random)
        case 5:
            return _of_text("counted", random_counted_case(random), random)
        case _:
            shape = SHAPES[random.randrange(len(SHAPES))]
            case = random_case(random, shape)
            one, other, *_ = case.predicates
            return Questions(
                "random",
                case.network,
                (
                    Query("q1", QueryKind.POSSIBLY, one),
                    Query("q2", QueryKind.INVARIANTLY, negation(other)),
                    Query("q3", QueryKind.INVARIANTLY, negation(Deadlock())),
                    Query("q4", QueryKind.EVENTUALLY, one),
                    Query("q5", QueryKind.LEADS_TO, one, (other,)),
                ),
            )


def _of_text(kind: str, case: SymmetricCase, random: Random) -> Questions:
    model = tachk.loads(case.text)
    first, second = (query.split(" ", 1)[1] for query in random.sample(case.queries, 2))
    more = random.choice((f"A<> {first}", f"E[] {first}", f"{first} --> {second}"))
    texts = [*case.queries[:3], "A[] not deadlock"]
    if "deadlock" not in more:
        texts.append(more)
    queries, _ = elaborate_queries(model.loaded, "\n".join(texts))
    return Questions(kind, model.network, queries)


def ways_of(seed: int) -> dict[str, Options]:
    """All by default, one alone and one combination, which take turns."""
    alone, together = list(ALONE)[seed % len(ALONE)], list(TOGETHER)[seed % len(TOGETHER)]
    return {"default": BY_DEFAULT, alone: ALONE[alone], together: TOGETHER[together]}


def compare_verdicts(questions: Questions, ways: Mapping[str, Options], limits: Limits = FEW_STATES) -> Compared:
    """Asks without any reduction and in these ways."""
    found = {}
    for name, options in {"no reduction": NO_REDUCTION, **ways}.items():
        try:
            found[name] = _verdicts(questions, options, limits)
        except UnsupportedError:  # without a reduction as with one: nothing is to be compared
            return Compared({}, ())
        except Exception as error:
            return Compared(found, (f"{name}: {type(error).__name__}: {error}",))
    plain = found["no reduction"]
    return Compared(
        found, tuple(problem for name, verdicts in found.items() for problem in _contradictions(name, plain, verdicts))
    )


def _verdicts(questions: Questions, options: Options, limits: Limits) -> tuple[Verdict, ...]:
    """Those about single states with their runs, which are replayed; those about runs without, to save time."""
    about_states = [query for query in questions.queries if query.target is not None]
    about_runs = [query for query in questions.queries if query.target is None]
    parts = [[query] for query in about_states] if questions.one_by_one else [about_states]
    answered = [verify(questions.network, part, options, limits) for part in parts]
    answered.append(verify(questions.network, about_runs, options, limits, trace=False))
    return tuple(chain.from_iterable(answered))


def _contradictions(name: str, plain: Sequence[Verdict], others: Sequence[Verdict]) -> Iterator[str]:
    for one, other in zip(plain, others, strict=True):
        asked = f"{name}, {other.query.kind.value} {other.query.text or other.query.name}"
        if {one.answer, other.answer} == {Answer.HOLDS, Answer.FAILS}:
            yield f"{asked}: {other.answer.value}, without reductions {one.answer.value}"
        if one.fault is not None and _looked_at_all(other):
            yield f"{asked}: a run-time error is overlooked"
        if other.fault is not None and _looked_at_all(one):
            yield f"{asked}: a run-time error that is not met without reductions"


def _looked_at_all(verdict: Verdict) -> bool:
    """Whether the verdict says that no run does something, and that no run meets a run-time error."""
    holds_when_reached = verdict.query.holds_when_reached
    if holds_when_reached is None or verdict.unexamined:
        return False
    return verdict.answer is (Answer.FAILS if holds_when_reached else Answer.HOLDS)
