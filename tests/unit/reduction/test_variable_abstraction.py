"""Coarser networks, in which it is left open in which order a variable goes through processes."""

from random import Random

import pytest

import tachk
from tachk.base.resources import data_root
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import Status
from tachk.engine.symmetry.tables import with_symmetry
from tachk.engine.symmetry.variable_abstraction import with_abstracted_variables
from tachk.engine.zone import explore
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.verify.verdict import answers_of
from tests.support.seeds import enough, seeds
from tests.support.symmetric.counted import random_counted_case

pytestmark = pytest.mark.drawn

CLASSICS = data_root() / "models" / "classics"

TEXT = """
const int N = 3;
typedef int[1, N] id_t;
int[1, N + 1] next = 1;
int[0, 9] count = 0;
int[0, 1] marks[N + 2];
chan call[N + 2];
broadcast chan all;
clock y;
bool is_first() { return next == 1; }
int[1, N + 1] last = N + 1;
void bump(int[1, N + 1] &k) { k = last; }
process Server() {
    init location A {
        to A { guard next <= N; sync call[next]!; assign next = next + 1; }
        to A { guard next == N + 1; assign next = 1; }
    }
}
process P(const id_t me) {
    clock x;
    init location Q { to R { sync call[me]?; assign x = 0; } }
    location R;
}
S = Server();
system S, P;
"""
QUERY = "E<> forall (i : id_t) P(i).R"


def coarser(text: str, query: str = QUERY) -> tuple[str, ...]:
    """The variables of which less can be known."""
    model = tachk.loads(text)
    (verdict,) = model.verify(query, limits=Limits(states=1), trace=False)
    assert verdict.query.target is not None
    found = with_abstracted_variables(model.network, [verdict.query.target])
    return () if found is None else tuple(variable.name for variable in found.variables)


def test_a_variable_that_goes_through_processes_is_found() -> None:
    assert coarser(TEXT) == ("next",)


EDGE = "to A { guard next == N + 1; assign next = 1; }"


@pytest.mark.parametrize(
    ("old", "new", "query"),
    [
        ("", "", "E<> next == 2"),
        ("", "", "A[] not deadlock"),
        ("", "", "E<> false"),
        ("system S, P;", "system S < P;", QUERY),
        ("chan call", "urgent chan call", QUERY),
        ("int[1, N + 1] next", "meta int[1, N + 1] next", QUERY),
        ("int[1, N + 1] next", "int next", QUERY),
        ("init location A {", "init location A { invariant y <= next;", QUERY),
        ("init location A {", "init location A { to A { guard is_first(); }", QUERY),
        ("init location A {", "init location A { to A { guard next <= N; assign bump(next); }", QUERY),
        ("init location A {", "init location A { to A { guard next <= N; assign count = next++; }", QUERY),
        ("init location A {", "init location A { to A { guard next == 2; sync all?; }", QUERY),
        ("sync call[me]?;", "guard next == me; sync call[me]?;", QUERY),
        ("guard next <= N;", "", QUERY),
        ("assign next = next + 1;", "assign next = next + 1, count = (count + next) % 9;", QUERY),
        ("assign next = next + 1;", "assign next = count;", QUERY),
    ],
)
def test_nothing_is_forgotten_where_it_could_be_noticed(old: str, new: str, query: str) -> None:
    text = TEXT.replace(old, new, 1)
    assert not old or text != TEXT
    assert coarser(text, query) == ()


@pytest.mark.parametrize(
    "edge", ["", "to A { guard next == 2; assign next = 3; }", "to A { guard next < N; assign next = next + 2; }"]
)
def test_what_is_kept_allows_all_that_was_possible(edge: str) -> None:
    text = TEXT.replace("init location A {", f"init location A {{ {edge}")
    assert coarser(text) == ("next",)
    model = tachk.loads(text)
    queries = [QUERY, "E<> P(3).R && P(1).R && P(2).Q", "E<> P(1).R && y > 4"]
    for verdict in model.verify(*queries, trace=False):
        assert verdict.query.target is not None
        found = with_abstracted_variables(model.network, [verdict.query.target])
        (goal,) = explore(*lower(found.network if found else model.network, [verdict.query.target])).goals
        assert (goal.status is Status.REACHED) >= (verdict.answer.value == "holds")


def test_an_edge_that_no_name_allows_is_not_left_out_where_its_guard_may_fail() -> None:
    text = TEXT.replace("init location A {", "init location A { to A { guard 6 / count > 2 && next > N + 1; }")
    model = tachk.loads(text)
    (verdict,) = model.verify(QUERY)
    assert verdict.fault is not None and verdict.query.target is not None
    found = with_abstracted_variables(model.network, [verdict.query.target])
    assert found is not None
    assert explore(*lower(found.network, [verdict.query.target])).fault is not None


def test_names_may_be_negative() -> None:
    text = """
        typedef int[-3, -1] id_t;
        int[-3, -1] next;
        process Server() { init location A { to A { guard next < -1; assign next = next + 1; } } }
        process P(const id_t me) { init location Q { to R { guard next == me; } } location R; }
        S = Server();
        system S, P;
    """
    assert coarser(text, "E<> forall (i : id_t) P(i).R") == ("next",)


def test_stations_that_are_named_by_number_are_as_few_as_those_named_in_any_order() -> None:
    stored = []
    for name in ("csma_cd", "csma_cd_any_order"):
        model = tachk.load(CLASSICS / f"{name}.ta", N=6)
        (verdict,) = model.verify(property="collision_noticed")
        target = verdict.query.target
        assert target is not None
        found = with_abstracted_variables(model.network, [target])
        network = model.network if found is None else found.network
        program, goals = lower(network, [target])
        outcome = explore(with_symmetry(program, network, [target]), goals)
        assert outcome.goals[0].status is Status.UNREACHABLE
        stored.append(outcome.statistics.states_stored)
    assert stored[0] == stored[1] < verdict.statistics.states_stored * 2


@pytest.mark.parametrize(
    ("name", "constants", "query", "variable"),
    [
        ("csma_cd", {"N": 11}, "collision_noticed", "Medium.next"),
        ("critical_region", {"N": 6, "CAREFUL": True}, "exclusive", "id"),
        ("critical_region", {"N": 5}, "in_time", "id"),
    ],
)
def test_published_models_are_decided_with_less_known(
    name: str, constants: dict[str, int], query: str, variable: str
) -> None:
    model = tachk.load(CLASSICS / f"{name}.ta", **constants)
    options = Options().off("pruning")
    (verdict,) = model.verify(property=query, limits=Limits(states=30_000), options=options)
    assert (verdict.answer.value, verdict.statistics.less_known) == ("holds", (variable,))
    (verdict,) = model.verify(property=query, limits=Limits(states=30_000), options=options.off("symmetry"))
    assert (verdict.answer.value, verdict.reason) == ("unknown", "state limit")


def test_what_can_be_reached_with_less_known_is_searched_for_in_the_network_itself() -> None:
    model = tachk.load(CLASSICS / "critical_region.ta", N=6)
    (verdict,) = model.verify(property="can_be_safe", limits=Limits(states=30_000))
    assert verdict.answer.value == "holds" and verdict.trace is not None and verdict.query.target is not None
    assert verdict.statistics.less_known == ()
    replay(prepare(model.network), verdict.trace, verdict.query.target)


def test_what_is_unreachable_with_less_known_is_unreachable() -> None:
    coarse = decided = 0
    for seed in seeds(range(18)):
        case = random_counted_case(Random(seed))
        model = tachk.loads(case.text)
        for verdict in model.verify(*case.queries, limits=Limits(states=2000), options=Options().off("symmetry")):
            assert verdict.query.target is not None
            found = with_abstracted_variables(model.network, [verdict.query.target])
            if found is None or verdict.reason == "state limit":
                continue
            coarse += 1
            (goal,) = explore(*lower(found.network, [verdict.query.target]), limits=Limits(states=20_000)).goals
            if goal.status is Status.UNREACHABLE:
                decided += 1
                assert verdict.answer is answers_of(verdict.query)[1], f"seed {seed}, {verdict.query.text}"
    assert enough(coarse > 10 and decided > 3)
