from __future__ import annotations

import json
from dataclasses import replace
from random import Random

import pytest

import tachk
from tachk.base.operators import BinaryOperator
from tachk.base.words import QueryKind
from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED, Status
from tachk.model.builder import NetworkBuilder
from tachk.model.expressions import BOOL, Binary, Constant
from tachk.model.query import Query
from tachk.report.junit_report import runs_to_junit
from tachk.report.verifyta_report import run_to_verifyta
from tachk.verify.vacuity import noted
from tachk.verify.verify import verify
from tests.support import Shape, random_case
from tests.support.seeds import enough, seeds

MODEL = """
int[0,2] n; bool b; int[0,5] a[2];
const int K = 2;
process P() {
    clock x;
    init location a { invariant x <= 3; to c { guard x >= 2; assign x = 0, n = 1 - n; } }
    location c { invariant x <= 1; to a { assign x = 0; } to never { guard x > 1; }
        to a { guard false; assign b = 1; } }
    location never;
}
system P;
"""


def notes(query: str, **options: object) -> tuple[str, ...]:
    (verdict,) = tachk.loads(MODEL).verify(query, options=Options(**options))  # type: ignore[arg-type]
    return verdict.notes


NEVER = "holds only because `{}` is never true"


@pytest.mark.parametrize(
    ("query", "texts"),
    [
        ("A[] P.never imply b", ["P.never"]),
        ("A[] P.never imply P.x > 7", ["P.never"]),
        ("A[] P.c imply P.x <= 1", []),
        ("A[] P.a imply (n == 2 imply b)", ["n == 2"]),
        ("A[] (n == 2 imply b) and (P.c imply not P.a)", ["n == 2"]),
        ("A[] forall (i : int[0,2]) n == 2 && i < 2 imply P.x <= i", ["n == 2 && i < 2"]),
        ("A[] forall (i : int[0,2]) n == i imply i < 2", []),
        ("A[] P.a imply (n <= 2 imply (P.c imply b))", ["P.c"]),  # not beside P.a
        ("A[] not P.never", []),  # that is what the property says, not what it presumes
        ("A[] P.x > 9 imply b", []),  # would make the search larger
        ("A[] deadlock imply b", []),
        ("A[] K > 3 imply b", []),  # decided by constants
        ("A[] a[n] > 7 imply b", ["a[n] > 7"]),
        ("E<> P.a imply b", []),
        ("A[] n < 2 imply n > 5", []),  # fails
        ("P.never --> b", ["P.never"]),
        ("P.c && P.x > 1 --> b", ["P.c && P.x > 1"]),
        ("n == 2 && P.x >= 1 --> n == 0", ["n == 2 && P.x >= 1"]),
        ("P.c --> P.a", []),
        ("P.c && P.x <= 1 --> P.a", []),
        ("P.c --> P.c", []),  # answered at once, but P.c happens
        ("P.c && P.x == 1 --> P.c", []),
        ("G (P.never -> F[0, 3] P.a)", ["P.never"]),
        ("G (rise(n == 2) -> F[0, 3] P.a)", ["rise(n == 2)"]),
        ("G (P.c && n < 2 -> F[0, 3] P.a)", []),
        ("G (P.c and not (n < 2) -> F[0, 3] P.a)", ["P.c && !(n < 2)"]),
        ("G (P.c -> F[0, 3] P.a) and G (P.never -> F[0, 3] P.c)", ["P.never"]),
        ("G[0, 9] (P.never or n == 2 -> F[0, 3] P.a)", ["P.never || n == 2"]),
        ("G (P.never or P.c -> F[0, 3] P.a)", []),
        ("G (rise(P.never or P.c) -> F[0, 3] P.a)", []),
        ("G (rise(P.never) or rise(P.c) -> F[0, 3] P.a)", []),
        ("G (F[0, 2] P.never -> P.a)", []),  # looks ahead: not asked
        ("G (not P.never)", []),
        ("Whenever P.never, within 3, P.a must be true.", ["P.never"]),
        ("Whenever P.c, within 3, P.a must be true.", []),
        ("G (P.never -> F P.a)", ["P.never"]),
        ("G (rise(n == 2) -> F P.a)", ["rise(n == 2)"]),
        ("G (P.c -> F P.a)", []),
        ("G (P.c -> F P.c)", []),  # the observer never moves, but P.c happens
        ("G (P.c -> F P.a) and G (P.never -> F P.c)", ["P.never"]),
        ("G (P.never -> F P.a) and G (n == 2 -> F P.c)", ["P.never", "n == 2"]),
        ("G (P.never or P.c -> F P.a)", []),
        ("G (P.a -> F P.never)", []),  # fails
        ("G (F P.never -> F P.a)", []),  # looks ahead: not asked
        ("G F P.a", []),
        ("Whenever P.never is true, eventually, P.a must be true.", ["P.never"]),
        ("Whenever P.c is true, eventually, P.a must be true.", []),
    ],
)
def test_what_is_never_true(query: str, texts: list[str]) -> None:
    if query.startswith("A[] a[n]"):
        texts = []  # may be a run-time error as far as is known: not asked
    assert notes(query) == tuple(NEVER.format(text) for text in texts)


def test_a_limit_leaves_a_note_out_but_not_the_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    queries = tachk.loads(MODEL + "property p : G (P.never -> F P.a);")
    found = zone.explore

    def stopped(*arguments: object) -> object:
        program, goals, options, _ = arguments
        return found(program, goals, options, Limits(states=1))  # type: ignore[arg-type]

    monkeypatch.setattr("tachk.verify.reachability.explore", stopped)
    (verdict,) = queries.verify()
    assert (verdict.answer.value, verdict.notes) == ("holds", ())


def test_an_interruption_in_the_search_for_a_note_is_not_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    queries = tachk.loads(MODEL + "property p : G (P.never -> F P.a);")
    found = zone.explore

    def interrupted(*arguments: object) -> object:
        outcome = found(*arguments)  # type: ignore[arg-type]
        goals = tuple(replace(goal, status=Status.UNDECIDED) for goal in outcome.goals)
        return replace(outcome, goals=goals, reason=INTERRUPTED)

    monkeypatch.setattr("tachk.verify.reachability.explore", interrupted)
    (verdict,) = queries.verify()
    assert (verdict.answer.value, verdict.reason) == ("unknown", INTERRUPTED)


def test_an_implication_for_all_processes_is_one() -> None:
    fischer = tachk.load("models/classics/fischer.ta")
    assert fischer.verify(property="mutual_exclusion")[0].notes == ()
    # Of the last process alone it is never true.
    assert fischer.verify("A[] forall (i : pid_t) P(i).critical && id + i <= 5 imply id == i")[0].notes == ()
    (verdict,) = fischer.verify("A[] forall (i : pid_t) P(i).critical && id == 0 imply i == 3")
    assert verdict.notes == (NEVER.format("P(i).critical && id == 0"),)


def test_a_property_that_fails_has_no_note_although_the_search_goes_through_everything() -> None:
    fails, holds = tachk.loads(MODEL).verify("A[] (n == 2 imply b) && P.a", "A[] P.a || P.c")
    assert (fails.answer.value, fails.notes) == ("fails", ())
    assert holds.answer.value == "holds"


def test_notes_are_reported_in_every_form() -> None:
    report = tachk.loads(MODEL).verify("A[] P.never imply b")
    note = NEVER.format("P.never")
    assert f"q1: {note}" in str(report)
    assert json.loads(json.dumps(report.to_dict()))["results"][0]["notes"] == [note]  # type: ignore[index,call-overload]
    assert f"<system-out>{note}</system-out>" in runs_to_junit([report.record])
    assert f" -- tachk: {note}" in run_to_verifyta(report.record)
    assert f"<small>{note.replace('`', '`')}</small>" in report._repr_html_()


def test_what_is_only_noted_neither_prolongs_a_search_nor_claims_to_be_unreachable() -> None:
    builder = NetworkBuilder()
    n = builder.integer("n", 0, 99)
    process = builder.process("P")
    here = process.location("a")
    process.edge(here, here, guard=n < 99, updates=[n.assign(n + 1)])
    program, (first, second) = lower(builder.build(), [(n == 3).expression, (n == 50).expression])
    outcome = zone.explore(program, (first, *noted([second])))
    assert [goal.status for goal in outcome.goals] == [Status.REACHED, Status.UNDECIDED]
    assert outcome.statistics.states_stored < 10
    outcome = zone.explore(program, (second, *noted([first])))
    assert [goal.status for goal in outcome.goals] == [Status.REACHED, Status.REACHED]
    assert outcome.goals[1].path is None


@pytest.mark.parametrize("language", [False, True])
def test_notes_on_random_networks_are_true_and_change_no_answer(language: bool) -> None:
    told = 0
    for seed in seeds(range(120)):
        case = random_case(Random(seed), Shape(processes=2, locations=3, clocks=1, constant=3, language=language))
        if len(case.predicates) < 2:
            continue
        trigger, other = case.predicates[:2]
        imply = Binary(BinaryOperator.IMPLY, trigger, other, BOOL)
        try:
            asked, alone = verify(
                case.network,
                [Query("q", QueryKind.INVARIANTLY, imply), Query("e", QueryKind.POSSIBLY, trigger)],
                limits=Limits(states=3000),
                trace=False,
            )
        except tachk.InputError:
            continue
        if asked.notes:
            told += 1
            assert alone.answer.value != "holds", f"seed {seed}"
    assert enough(told > 1 or language)


def test_a_constant_is_no_trigger() -> None:
    query = Query("q", QueryKind.INVARIANTLY, Binary(BinaryOperator.IMPLY, Constant(0), Constant(1), BOOL))
    (verdict,) = verify(tachk.loads(MODEL).network, [query])
    assert verdict.notes == ()


def test_a_search_does_not_go_on_for_a_trigger() -> None:
    text = """int[0,1000] n;
    process P() { init location s { to s { guard n < 1000; assign n++; } } }
    system P; property p : A[] (P.s imply n <= 3) && (n == 990 imply P.s);"""
    (verdict,) = tachk.loads(text).verify()
    assert verdict.answer is tachk.Answer.FAILS
    assert verdict.statistics.states_stored < 50
