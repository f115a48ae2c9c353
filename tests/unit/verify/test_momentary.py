"""A property that holds because its trigger lasts for no time says so."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import partial
from random import Random

import pytest

import tachk
from tachk.base.job import Job
from tachk.base.words import QueryKind
from tachk.engine.options import Limits
from tachk.engine.outcome import Statistics
from tachk.meaning.discrete import prepare
from tachk.meaning.step import StepError, delay, initial_state, satisfies, successors
from tachk.model.connectives import both
from tachk.model.expressions import BOOL, Constant, Deadlock, LocationTest
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.run import TimedState
from tachk.verify import momentary
from tachk.verify.verdict import Answer, Verdict
from tachk.verify.verify import _decided_plainly
from tests.support import Shape, random_case
from tests.support.seeds import enough, seeds
from tests.unit.verify.test_times import LEFT_IN_A_CHAIN

MOMENTARY = "`Train.Appr` is also true for no time, in committed locations; that does not count"


@pytest.mark.parametrize(
    "text",
    [
        "Whenever Train.Appr, within 20, Train.Cross must be true.",
        "G (Train.Appr -> F[0, 20] Train.Cross)",
        "G (rise(Train.Appr) -> F[0, 20] Train.Cross)",
    ],
)
def test_a_trigger_that_is_left_in_a_chain(text: str) -> None:
    (verdict,) = tachk.loads(LEFT_IN_A_CHAIN).verify(text)
    assert verdict.answer is tachk.Answer.HOLDS
    assert [note.replace("rise(Train.Appr)", "Train.Appr") for note in verdict.notes] == [MOMENTARY]


@pytest.mark.parametrize(
    "changed",
    [
        LEFT_IN_A_CHAIN.replace("to Occ { sync stop!; }", ""),  # the chain ends in Appr
        LEFT_IN_A_CHAIN.replace("to Stop { sync stop?; }", "to Appr { sync stop?; }"),
    ],
)
def test_a_trigger_that_lasts_needs_no_note(changed: str) -> None:
    (verdict,) = tachk.loads(changed).verify("G (Train.Appr -> F[0, 120] Train.Cross)")
    assert verdict.notes == ()


IN_URGENT = "process P() { state A, B, C; urgent A; init A; trans A -> B { }; } system P;"


@pytest.mark.parametrize(
    ("text", "note"),
    [
        ("G (P.A -> F P.C)", "`P.A` is also true"),
        ("G (P.A -> F[0,5] P.C)", "`P.A` is also true"),
        ("G !P.A", "`!P.A` is also false"),
        ("Whenever P.A, within 5, P.C must be true.", "`P.A` is also true"),
    ],
)
def test_what_is_so_in_urgent_locations_only(text: str, note: str) -> None:
    (verdict,) = tachk.loads(IN_URGENT).verify(text)
    assert verdict.answer is tachk.Answer.HOLDS
    assert verdict.notes == (f"{note} for no time, in urgent locations; that does not count",)


@pytest.mark.parametrize(
    ("stays", "answer", "notes"),
    [
        ("guard n != 1;", tachk.Answer.HOLDS, ["`n == 1` is also true for no time, in urgent locations;"]),
        ("", tachk.Answer.FAILS, []),
    ],
)
def test_others_may_act_while_a_process_is_in_an_urgent_location(
    stays: str, answer: tachk.Answer, notes: list[str]
) -> None:
    (verdict,) = tachk.loads(f"""
        int n; bool there;
        process P() {{
            init location A {{ to B {{ assign there = true; }} }}
            urgent location B {{ to C {{ {stays} assign there = false; }} }}
            location C;
        }}
        process Q() {{
            init location Q0 {{ to Q1 {{ guard there && n == 0; assign n = 1; }} }}
            location Q1 {{ to Q0 {{ guard there; assign n = 2; }} }}
        }}
        system P, Q;
    """).verify("G (n == 1 -> F[0,5] n == 5)")
    assert verdict.answer is answer
    assert [note[: len(expected)] for note, expected in zip(verdict.notes, notes, strict=True)] == notes


def test_both_kinds_of_locations_are_named() -> None:
    mixed = LEFT_IN_A_CHAIN.replace("location Occ;", "location Occ { to End; } urgent location End;")
    (verdict,) = tachk.loads(mixed).verify("G (Train.Appr -> F[0, 20] Train.Cross)")
    where = "committed or urgent locations; that does not count"
    assert verdict.notes == (
        f"`Train.Appr` is also true where runs end in {where}",  # End is never left, and Appr not yet
        f"`Train.Appr` is also true for no time, in {where}",
    )


@pytest.mark.parametrize(
    ("exits", "formula", "answer", "noted"),
    [
        ("", "G !P.d", Answer.HOLDS, True),
        ("", "G (P.d -> F[0, 5] P.a)", Answer.HOLDS, True),
        ("to a { guard x >= 1; }", "G !P.d", Answer.HOLDS, True),
        ("to a { guard x <= 5; }", "G !P.d", Answer.HOLDS, False),
        ("to a;", "G !P.d", Answer.HOLDS, False),
        ("", "G (P.d -> F P.a)", Answer.FAILS, False),  # where a run can go no further its last values count
        ("", "G !P.a", Answer.FAILS, False),
    ],
)
def test_what_is_so_where_a_run_ends(exits: str, formula: str, answer: Answer, noted: bool) -> None:
    model = tachk.loads(
        "clock x; process P() { init location a { invariant x <= 3; to c { guard x >= 3; assign x = 0; } } "
        f"committed location c {{ to a; to d; }} committed location d {{ {exits} }} }} system P;"
    )
    (verdict,) = model.verify(formula)
    assert verdict.answer is answer
    assert any("where runs end in committed locations; that does not count" in n for n in verdict.notes) is noted


def test_an_update_may_break_the_invariant_of_another_process() -> None:
    model = tachk.loads(
        "int[0, 1] n; process P() { init location a { to d; } committed location d { to a { assign n = 1; } } }\n"
        "process Q() { init location b { invariant n == 0; } } system P, Q;"
    )
    (verdict,) = model.verify("G !P.d")
    assert verdict.answer is Answer.HOLDS
    assert [note.partition(" is also ")[2] for note in verdict.notes] == [
        "false where runs end in committed locations; that does not count"
    ]


def test_what_the_property_says_of_committed_states_needs_no_note() -> None:
    report = tachk.loads(LEFT_IN_A_CHAIN).verify(
        "A[] (Train.Appr imply Train.x <= 20)", "Train.Appr -->[<= 120] Train.Cross"
    )
    assert [(verdict.answer, verdict.notes) for verdict in report] == [(tachk.Answer.HOLDS, ())] * 2


@pytest.mark.parametrize(
    ("text", "note"),
    [
        ("G !Gate.Tell", "`!Gate.Tell` is also false for no time, in committed locations; that does not count"),
        ("G (Gate.Free || Gate.Occ)", "`Gate.Free || Gate.Occ` is also false for no time, in committed locations;"),
        ("!Gate.Tell must be true.", "`!Gate.Tell` is also false for no time, in committed locations;"),
    ],
)
def test_a_demand_that_lapses_in_a_chain(text: str, note: str) -> None:
    (verdict,) = tachk.loads(LEFT_IN_A_CHAIN).verify(text)
    assert verdict.answer is tachk.Answer.HOLDS
    assert [found.startswith(note) for found in verdict.notes] == [True]


def undecided(network: Network, queries: Sequence[Query], limits: Limits) -> list[Verdict]:
    return [Verdict(query, Answer.UNKNOWN, True, "state limit", Statistics()) for query in queries]


def test_what_is_not_known_is_said() -> None:
    model = tachk.loads(LEFT_IN_A_CHAIN)
    (verdict,) = model.verify("G (Train.Appr -> F[0, 20] Train.Cross)")
    bare = replace(verdict, notes=())
    (noted,) = momentary.with_momentary_triggers(model.network, [bare], Limits(), undecided)
    unknown = "whether `Train.Appr` is also true for no time, in committed locations, is not known (state limit)"
    assert noted.notes == (unknown,)


def visited(network: Network, condition: LocationTest, most: int = 4000) -> bool | None:
    """By the reference semantics, with one clock at multiples of one half: whether some chain has the condition and
    neither the state in which it begins nor the one in which it ends. None where that takes too many states."""
    model = prepare(network)
    pending: list[tuple[TimedState, bool, bool]] = [(initial_state(model), False, False)]
    seen = set()
    while pending:
        state, before, risen = pending.pop()
        now = satisfies(model, state, condition)
        if any(location.committed or location.urgent for location in model.current(state.discrete)):
            risen = risen or now
        else:
            if risen and not before and not now:
                return True
            before, risen = now, False
        key = (state.discrete, tuple(min(value, 5) for value in state.clocks), before, risen)
        if key in seen:
            continue
        if len(seen) > most:
            return None
        seen.add(key)
        pending += [(after, before, risen) for _, after in successors(model, state)]
        with suppress(StepError):
            pending.append((delay(model, state, Fraction(1, 2)), before, risen))
    return False


def test_on_random_networks_it_is_what_the_definition_says() -> None:
    found = {True: 0, False: 0}
    for seed in seeds(range(70)):
        random = Random(seed)
        case = random_case(random, Shape(deadlocks=False, clocks=1, processes=2, locations=3, constant=3))
        condition = LocationTest(0, random.randrange(len(case.network.processes[0].locations)))
        stopped = momentary._may_stop_time(case.network)
        if stopped is None:
            continue
        ends = momentary._ends_by_channel(case.network)
        conditions = {momentary._MomentaryCondition("it", True): condition}
        watched, goals = momentary._watched(case.network, stopped, ends, conditions)
        (answer,) = momentary._reached(
            watched, goals, tachk.Limits(states=5000), partial(_decided_plainly, Job())
        ).values()
        expected = visited(case.network, condition)
        if expected is not None and answer.answer is not tachk.Answer.UNKNOWN:
            assert (answer.answer is tachk.Answer.HOLDS) == expected, f"seed {seed}"
            found[expected] += 1
    assert enough(found[True] > 0 and found[False] > 10), found


def ended_with(network: Network, condition: LocationTest, most: int = 4000) -> bool | None:
    """By the reference semantics, as `visited`: whether a run ends with the condition in a location that stops time."""
    model = prepare(network)
    pending = [initial_state(model)]
    seen = set()
    while pending:
        state = pending.pop()
        key = (state.discrete, tuple(min(value, 5) for value in state.clocks))
        if key in seen:
            continue
        if len(seen) > most:
            return None
        seen.add(key)
        following = [after for _, after in successors(model, state)]
        if any(location.committed or location.urgent for location in model.current(state.discrete)):
            if not following and satisfies(model, state, condition):
                return True
        else:
            with suppress(StepError):
                following.append(delay(model, state, Fraction(1, 2)))
        pending += following
    return False


def test_on_random_networks_runs_end_where_the_definition_says() -> None:
    found = {True: 0, False: 0}
    for seed in seeds(range(100)):
        random = Random(seed)
        case = random_case(random, Shape(deadlocks=False, clocks=1, processes=2, locations=3, constant=3))
        number = random.randrange(len(case.network.processes[0].locations))
        condition = LocationTest(0, number)
        ends = momentary._some_stops_time(case.network, momentary._perhaps_last_places(case.network))
        goal = Constant(0, BOOL) if ends is None else both(both(ends, condition), Deadlock())
        (verdict,) = _decided_plainly(Job(), case.network, [Query("it", QueryKind.POSSIBLY, goal)], Limits(states=5000))
        expected = ended_with(case.network, condition)
        if expected is not None and verdict.answer is not Answer.UNKNOWN:
            assert (verdict.answer is Answer.HOLDS) == expected, f"seed {seed}"
            found[expected] += 1
    assert enough(found[True] > 3 and found[False] > 10), found


LOOP = """
int[0, 3] n;
process P() {{
    clock x;
    state S, A, B;
    commit A, B;
    init S;
    trans S -> A {{ guard x >= 1; assign x = 0; }}, {edges};
}}
process Q() {{ state Q0; init Q0; }}
system P, Q;
"""


@pytest.mark.parametrize(
    ("edges", "formula", "noted"),
    [
        ("A -> B { }, B -> A { }", "G !P.A", True),  # again and again
        ("A -> B { }, B -> B { }", "G !P.A", False),  # once
        ("A -> B { }, B -> A { }", "G P.S", True),
        ("A -> A { }", "G !P.A", True),
        ("A -> A { guard n < 3; assign n = n + 1; }, A -> S { }", "G !P.A", False),  # the loop ends
        ("A -> A { assign n = 1 - n; }, A -> S { }", "G !P.A", True),
        ("A -> A { assign n = 1 - n; }, A -> S { }", "G !(P.A && n == 0)", True),
        ("A -> A { guard x >= 1; }, A -> S { }", "G !P.A", False),
        ("A -> S { }, B -> B { }", "G !P.B", False),  # B is not reached
        ("A -> B { }, B -> B { }", "G (P.B -> F[0, 5] P.S)", True),
        ("A -> B { }, B -> B { }", "G (P.B -> F P.S)", False),  # fails: without a deadline it counts
    ],
)
def test_what_is_so_while_a_run_takes_steps_for_ever(edges: str, formula: str, noted: bool) -> None:
    (verdict,) = tachk.loads(LOOP.format(edges=edges)).verify(formula)
    assert verdict.answer is (Answer.FAILS if "F P.S" in formula else Answer.HOLDS)
    words = "where runs take steps for ever in committed locations; that does not count"
    assert any(words in note for note in verdict.notes) is noted


def met_for_ever(network: Network, condition: LocationTest, most: int = 4000) -> bool | None:
    """By the reference semantics, as `visited`: whether the states in which a location stops time have a cycle through
    one with the condition."""
    model = prepare(network)
    states = [initial_state(model)]
    following: dict[object, list[object]] = {}
    met: set[object] = set()

    def key(state: TimedState) -> object:
        return state.discrete, tuple(min(value, 5) for value in state.clocks)

    while states:
        state = states.pop()
        if key(state) in following:
            continue
        if len(following) > most:
            return None
        after = [each for _, each in successors(model, state)]
        stopped = any(location.committed or location.urgent for location in model.current(state.discrete))
        following[key(state)] = [key(each) for each in after] if stopped else []
        if stopped and satisfies(model, state, condition):
            met.add(key(state))
        if not stopped:
            with suppress(StepError):
                after.append(delay(model, state, Fraction(1, 2)))
        states += after
    return any(state in behind(following, state) for state in met)


def behind(following: dict[object, list[object]], state: object) -> set[object]:
    """What is reached by a step or more."""
    pending, seen = list(following[state]), set(following[state])
    while pending:
        fresh = set(following.get(pending.pop(), ())) - seen
        seen |= fresh
        pending += fresh
    return seen


def test_on_random_networks_runs_go_on_where_the_definition_says() -> None:
    found = {True: 0, False: 0}
    for seed in seeds(range(100)):
        random = Random(seed)
        case = random_case(random, Shape(deadlocks=False, clocks=1, processes=2, locations=3, constant=3))
        condition = LocationTest(0, random.randrange(len(case.network.processes[0].locations)))
        stopped = momentary._may_stop_time(case.network)
        if stopped is None:
            continue
        query = momentary._left_again(0, stopped, condition)
        (verdict,) = _decided_plainly(Job(), case.network, [query], Limits(states=5000))
        expected = met_for_ever(case.network, condition)
        if expected is not None and verdict.answer is not Answer.UNKNOWN:
            assert (verdict.answer is Answer.FAILS) == expected, f"seed {seed}"
            assert momentary._may_go_on(case.network) or not expected, f"seed {seed}"
            found[expected] += 1
    assert enough(found[True] > 3 and found[False] > 10), found


def test_searches_for_notes_share_the_time_that_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 0.0
    answers: list[str] = []

    def noting(
        network: Network, verdicts: Sequence[Verdict], limits: Limits, decide: momentary.Deciding
    ) -> Sequence[Verdict]:
        nonlocal now
        query = Query("it", QueryKind.POSSIBLY, Constant(1, BOOL))
        for moment in (6.0, 11.0):  # the second search begins when the ten seconds are over
            now = moment
            answers.extend(found.answer.value for found in decide(network, [query], limits))
        return verdicts

    monkeypatch.setattr("tachk.base.job.monotonic", lambda: now)
    monkeypatch.setattr(momentary, "with_momentary_triggers", noting)
    model = tachk.loads("process P() { init location a; } system P;")
    report = model.verify("G (P.a -> F[0, 2] P.a)", limits=Limits(seconds=10))
    assert report[0].answer is Answer.HOLDS
    assert answers == ["holds", "unknown"]
