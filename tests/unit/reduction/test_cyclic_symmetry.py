"""Which processes form a ring, and what breaks one."""

from __future__ import annotations

import pytest

import tachk
from tachk import Limits, Options
from tachk.base.resources import data_root
from tachk.engine.options import LocalTimes
from tachk.engine.symmetry.detection import find_symmetry
from tachk.engine.symmetry.tables import tables_of
from tests.support.strategies import switched

TEXT = """
const int N = 4;
typedef int[0, N - 1] id_t;
int[0, N] token = N;
int[0, 1] fork[N];
chan to[N];
broadcast chan all;

process P(const id_t me) {
    const int RIGHT = (me + 1) % N;
    clock x;
    id_t next = RIGHT;
    init location L { to M { guard fork[me] + fork[RIGHT] == 0; assign fork[RIGHT] = 1, token = me, x = 0; } }
    location M { to L { EDGE } }
}
process Q() {
    init location L { to L { OTHER } }
}
system P, Q;
"""


def ring_sizes(edge: str = "", other: str = "", *queries: str, text: str = TEXT) -> list[int]:
    model = tachk.loads(text.replace("EDGE", edge).replace("OTHER", other))
    targets = [verdict.query.target for verdict in model.verify(*queries, trace=False)] if queries else []
    symmetry = find_symmetry(model.network, [target for target in targets if target is not None])
    assert not symmetry.groups
    return [len(cycle.members) for cycle in symmetry.cycles]


@pytest.mark.parametrize(
    "edge",
    [
        "guard x > 2 && token == me; assign token = RIGHT;",
        "select k : id_t; guard k != me; assign token = (k + 1) % N;",
        "assign next = (next - 1 + N) % N;",
        "sync to[next]!;",
        "sync to[me]?;",
        "sync all?; assign x = 0;",
        "sync all?; assign fork[me] = 0;",
    ],
)
def test_neighbours_are_known_by_number(edge: str) -> None:
    assert ring_sizes(edge, "sync all!; assign token = N;") == [4]
    assert ring_sizes(edge, "select k : id_t; guard fork[(k + 1) % N] == 0; sync to[k]!;") == [4]


@pytest.mark.parametrize(
    ("edge", "sizes"),
    [
        ("guard token < me;", []),
        ("assign token = 1;", []),
        ("assign fork[1] = 0;", []),
        ("assign next = (next + me) % N;", []),
        ("assign token = (token + 1) % (N + 1);", []),
        ("assign token = (token + 1) % N;", []),
        ("guard (next + 2) % 5 == me; assign next = me;", []),
        ("guard (me + 0) % 2 == 0; assign fork[me] = 0;", [2]),
        ("sync all?; assign token = me;", []),
    ],
)
def test_what_breaks_a_ring(edge: str, sizes: list[int]) -> None:
    assert ring_sizes(edge, "sync all!;") == sizes


def test_others_may_not_prefer_a_place() -> None:
    assert ring_sizes("", "assign fork[2] = 0;") == []
    assert ring_sizes("", "guard fork[0] + fork[2] == 0; assign fork[0] = 0, fork[2] = 0;") == []


def test_run_time_errors_may_not_depend_on_the_order_of_processes() -> None:
    text = TEXT.replace("location M {", "location M { invariant x <= 9 / fork[me];")
    assert ring_sizes(text=text) == []


def test_initial_values_need_not_go_round() -> None:
    assert ring_sizes(text=TEXT.replace("fork[N];", "fork[N] = {1, 0, 0, 0};")) == [4]
    assert ring_sizes("assign token = me;", "", text=TEXT.replace("token = N;", "token = 0;")) == [4]
    assert ring_sizes("assign next = me;", text=TEXT.replace("next = RIGHT;", "next = 0;")) == [4]


def test_constants_go_round() -> None:
    unchanged = "guard first[next] == 0;"
    assert ring_sizes(unchanged, text=TEXT.replace("chan to", "int[0, 1] first[N]; chan to")) == [4]
    assert ring_sizes(unchanged, text=TEXT.replace("chan to", "int[0, 1] first[N] = {1, 0, 1, 0}; chan to")) == [2]
    assert ring_sizes(unchanged, text=TEXT.replace("chan to", "int[0, 1] first[N] = {1, 0, 0, 0}; chan to")) == []


@pytest.mark.parametrize(
    ("query", "sizes"),
    [
        ("E<> exists (i : id_t) P(i).M and P((i + 1) % N).M", [4]),
        ("E<> P(0).M", []),
        ("E<> P(0).M and P(2).M or P(1).M and P(3).M", [4]),
        ("E<> P(0).M and P(2).M", [2]),
        ("A[] not deadlock", [4]),
    ],
)
def test_a_query_leaves_the_rotations_that_keep_it(query: str, sizes: list[int]) -> None:
    assert ring_sizes("", "", query) == sizes


def test_several_templates_go_round_together() -> None:
    model = tachk.load(data_root() / "models" / "classics" / "dining_philosophers.ta", N=5)
    (cycle,) = find_symmetry(model.network, []).cycles
    assert cycle.members == ((0, 5), (1, 6), (2, 7), (3, 8), (4, 9))
    (part,) = (part for part in model.check().parts if part.question == "interchangeable processes")
    assert part.answer == "Philosopher(0) with Fork(0) to Philosopher(4) with Fork(4) (5) in a ring"


def test_a_ring_of_a_prime_number_divides_what_is_stored() -> None:
    model = tachk.load(data_root() / "models" / "classics" / "dining_philosophers.ta", N=5)
    stored = []
    for symmetry in (True, False):
        options = switched(Options().off("merging", "local-times"), symmetry, "symmetry")
        (verdict,) = model.verify(property="neighbours", options=options)
        assert verdict.answer.value == "holds"
        stored.append(verdict.statistics.states_stored)
    similar = 3  # all think, all hold a fork and all put it back at the same time
    assert 5 * (stored[0] - similar) <= stored[1] <= 5 * stored[0]


def test_what_belongs_to_two_of_them_goes_round_but_is_not_exchanged() -> None:
    text = """
    typedef int[0, 2] id_t;
    bool knows[3][3];
    process P(const id_t i) {
        init location A { to B { select j : id_t; guard i != j; assign knows[i][j] = true; } }
        location B;
    }
    system P;
    """
    model = tachk.loads(text)
    tables = [table for _, table in tables_of(model.network, find_symmetry(model.network, []))]
    assert [getattr(table, "cyclic", None) for table in tables] == [None, True]
    (part,) = (part for part in model.check().parts if part.question == "interchangeable processes")
    assert part.answer.startswith("P(0), P(1), P(2) in a ring; not all P: `knows` holds what belongs to two of them")
    (verdict,) = model.verify("E<> forall (i : id_t) P(i).B", limits=Limits(states=100))
    assert verdict.statistics.states_stored < 27


def test_a_ring_is_turned_over_local_times_too() -> None:
    model = tachk.load(data_root() / "models" / "classics" / "dining_philosophers.ta", N=6)
    queries = ("E<> false", "E<> exists (i : seat_t) Philosopher(i).eating && Philosopher((i + 2) % N).done")
    stored = []
    for symmetry in (True, False):
        none, some = model.verify(
            *queries, options=switched(Options(local_times=LocalTimes.ALWAYS), symmetry, "symmetry")
        )
        assert (none.answer.value, some.answer.value) == ("fails", "holds")
        assert some.trace is not None
        stored.append(none.statistics.states_stored)
    assert stored == [151, 853]


def test_clocks_of_two_neighbours_keep_their_places_over_local_times() -> None:
    text = """
    const int N = 3;
    typedef int[0, N - 1] id_t;
    clock link[N];
    chan to[N];
    process P(const id_t me) {
        const int LEFT = (me + N - 1) % N;
        bool told = false;
        init location A {
            to A { guard link[me] > 1 && !told; sync to[me]!; assign told = true; }
            to A { sync to[LEFT]?; assign link[LEFT] = 0; }
        }
    }
    system P;
    property all : E<> forall (i : id_t) P(i).told && link[i] <= 1;
    """
    model = tachk.loads(text)
    assert ring_sizes(text=text) == [3]
    (local,) = model.verify(options=Options(local_times=LocalTimes.ALWAYS))
    (plain,) = model.verify(options=Options().off("symmetry", "local-times"))
    assert local.answer == plain.answer
    assert local.statistics.local_times
    assert not plain.statistics.local_times
