"""The tables of strategies: what each is worth, how they are switched off, and that budgets are kept."""

from __future__ import annotations

from dataclasses import replace

import pytest

import tachk
from tachk import Limits, Options
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import OutOfTimeError
from tachk.engine.options import Engine
from tachk.engine.outcome import Statistics
from tachk.meaning.discrete import prepare
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.transform.observed import observed
from tachk.transform.transformation import Exactness
from tachk.verify import strategies
from tachk.verify.plan import Analysis, Task, analysis_of
from tachk.verify.strategy import NO_STRATEGY, DisagreementError, Findings, Problem, Strategy, decided
from tachk.verify.verdict import Answer, Verdict
from tests.support.reductions.verdict_agreement import FEW_STATES, random_questions
from tests.support.strategies import changed, rows

pytestmark = pytest.mark.drawn

MODEL = """
chan go;
process P() { clock x; init location A { to B { guard x >= 2; sync go!; } } location B; }
process Q() { init location C { to D { sync go?; } } location D; }
system P, Q;
property reached : E<> P.B;
property never : A[] P.B imply P.x >= 2;
property always : A<> P.B;
"""
EXTREMES = """
int[0,3] n;
process P() { clock x, y; init location A { invariant x <= 3; to A { guard n < 3; assign n = n + 1, x = 0; } } }
system P;
property integer : sup: n;
property of_clock : inf{n == 1}: P.x;
property difference : bounds: P.y - P.x;
property both : sup: n, P.x;
property nothing : inf{n == 4}: n;
"""


def named(text: str, options: Options = Options()) -> dict[str, tuple[str, str]]:
    verdicts = tachk.loads(text).verify(options=options).record.verdicts
    return {verdict.query.name: (verdict.answer.value, verdict.strategy) for verdict in verdicts}


def test_each_verdict_names_its_strategy() -> None:
    assert named(MODEL) == {"reached": ("holds", "zones"), "never": ("holds", "zones"), "always": ("fails", "any-run")}
    assert named(EXTREMES) == {
        "integer": ("holds", "measured"),
        "of_clock": ("holds", "time-bound"),
        "difference": ("holds", "bisection"),
        "both": ("holds", "time-bound"),
        "nothing": ("fails", "measured"),
    }


def test_verdicts_of_z3_name_it() -> None:
    text = MODEL.replace("property always : A<> P.B;", "")
    assert named(text, Options(engine=Engine.SMT)) == {"reached": ("holds", "smt"), "never": ("holds", "smt")}


def test_bounded_model_checking_only_finds() -> None:
    text = MODEL.replace("property always : A<> P.B;", "")
    without = Options(engine=Engine.SMT).off("smt")
    assert named(text, without) == {"reached": ("holds", "bounded"), "never": ("unknown", "")}


@pytest.mark.parametrize("name", ["measured", "time-bound"])
def test_extremes_are_the_same_by_other_strategies(name: str) -> None:
    usual, other = (tachk.loads(EXTREMES).verify(options=o).record.verdicts for o in (Options(), Options().off(name)))
    for one, another in zip(usual, other, strict=True):
        assert another.strategy != name
        assert [(e.expression, *_values(e)) for e in one.extremes] == [
            (e.expression, *_values(e)) for e in another.extremes
        ]


def _values(extremes: tachk.Extremes) -> tuple[object, ...]:
    return tuple((side.value, side.strict) if side else None for side in (extremes.least, extremes.largest))


def test_names_are_held_apart() -> None:
    names = [row.name for row in rows()]
    assert len(names) == len(set(names))
    assert not set(names) & {"alu", "merging", "pruning", "attempts", "cone", "symmetry", "local-times"}


@pytest.mark.parametrize("name", strategies.names())
def test_without_a_strategy_no_known_answer_changes(name: str) -> None:
    model = tachk.loads(MODEL)
    usual = model.verify().record.verdicts
    for verdict, other in zip(usual, model.verify(options=Options().off(name)).record.verdicts, strict=True):
        assert other.strategy != name
        assert other.answer is verdict.answer or other.reason == NO_STRATEGY


def test_a_name_that_there_is_not_is_an_error() -> None:
    with pytest.raises(UsageError, match="no strategy `unblokked`"):
        tachk.loads(MODEL).verify(options=Options().off("unblokked"))


def test_a_strategy_that_is_stopped_leaves_the_others_their_turn() -> None:
    def stopped(problem: Problem) -> Findings:
        raise OutOfTimeError

    with changed(lambda row: replace(row, run=stopped) if row.name == "unblocked" else row):
        (verdict,) = tachk.loads(MODEL).verify(property="never").record.verdicts
    assert (verdict.answer.value, verdict.strategy) == ("holds", "zones")


def test_what_a_strategy_does_not_decide_is_not_believed() -> None:
    with changed(
        lambda row: replace(row, exactness=Exactness.REACHABLE) if row.name in ("unblocked", "zones") else row
    ):
        reached, never = tachk.loads(MODEL).verify(property=["reached", "never"]).record.verdicts
    assert reached.answer.value == "holds"
    assert (never.answer.value, never.reason) == ("unknown", NO_STRATEGY)


def test_no_search_stores_more_than_its_budget() -> None:
    text = "int[0,5000] n; process P() { init location A { to A { guard n < 5000; assign n++; } } } system P;"
    (verdict,) = tachk.loads(text).verify("A[] n < 5000", limits=Limits(states=100))
    assert verdict.reason == "state limit"
    assert verdict.statistics.states_stored < 200


def problem_of(network: Network, *queries: Query) -> Problem:
    tasks = tuple(Task(number, query) for number, query in enumerate(queries))
    return Problem(prepare(network), observed(network, None), tasks, Options(), FEW_STATES, False)


def claims(name: str, answers: dict[int, Answer], exactness: Exactness = Exactness.EVERYTHING) -> Strategy:
    """A strategy that gives these answers, whatever is asked."""
    queries = tachk.loads(MODEL).loaded.queries
    verdicts = {n: Verdict(queries[n], answer, True, "", Statistics()) for n, answer in answers.items()}
    return Strategy(name, "", lambda problem: Findings(verdicts), exactness)


def decided_by(*table: Strategy) -> list[tuple[str, str]]:
    """About `A[]` and `E<>` of the model."""
    model = tachk.loads(MODEL)
    found = decided(problem_of(model.network, *model.loaded.queries[:2]), table)
    return [(verdict.answer.value, verdict.strategy) for _, verdict in sorted(found.items())]


def test_a_run_that_is_found_changes_no_answer_that_is_proved() -> None:
    proves = claims("proves", {0: Answer.FAILS}, Exactness.UNREACHABLE)
    finds = claims("finds", {0: Answer.HOLDS, 1: Answer.FAILS}, Exactness.REACHABLE)
    with pytest.raises(DisagreementError) as caught:
        decided_by(proves, finds)
    assert (caught.value.one.strategy, caught.value.other.strategy) == ("proves", "finds")
    with pytest.raises(DisagreementError):
        decided_by(claims("finds", {0: Answer.HOLDS}), claims("proves", {0: Answer.FAILS, 1: Answer.HOLDS}))


def test_the_first_strategy_that_can_be_believed_decides() -> None:
    finds = claims("finds", {0: Answer.HOLDS}, Exactness.REACHABLE)
    others = {1: Answer.HOLDS, 0: Answer.UNKNOWN}
    assert decided_by(finds, claims("rest", others)) == [("holds", "finds"), ("holds", "rest")]
    assert decided_by(finds, claims("rest", {**others, 0: Answer.HOLDS})) == [("holds", "finds"), ("holds", "rest")]
    partly = claims("partly", {0: Answer.FAILS, 1: Answer.HOLDS}, Exactness.REACHABLE)
    assert decided_by(partly, claims("whole", {0: Answer.HOLDS, 1: Answer.FAILS})) == [
        ("holds", "whole"),
        ("fails", "whole"),
    ]


@pytest.mark.parametrize("seed", range(30_000, 30_010))
def test_no_strategy_contradicts_one_that_can_be_believed(seed: int) -> None:
    """All strategies of a table are run about all queries. The loop would stop at the first that decides."""
    questions = random_questions(seed)
    tables = {Analysis.REACHABILITY: strategies.REACHABILITY, Analysis.LIVENESS: strategies.LIVENESS}
    for query in questions.queries:
        problem = problem_of(questions.network, query)
        claimed: set[Answer] = set()
        for strategy in tables[analysis_of(query)]:
            found = strategy.run(problem)
            problem = problem.knowing(found)
            (verdict,) = decided(problem, (replace(strategy, run=lambda _, found=found: found),)).values()
            claimed |= {verdict.answer} - {Answer.UNKNOWN}
        assert len(claimed) <= 1, query.text or query.name
