"""Clocks that are set to the values of clocks."""

from __future__ import annotations

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.local_times import obstacle
from tachk.engine.options import Engine, Pace
from tachk.engine.program_image import encode
from tachk.meaning.discrete import initial_discrete, prepare
from tachk.meaning.repetition import observable_clocks
from tachk.model.builder import NetworkBuilder, conditional, deadlock
from tachk.model.fault import RuntimeErrorKind
from tests.support.oracles import reference


def test_a_copy_has_the_value_of_its_source_and_runs_on(reaches) -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a, b = process.location("A"), process.location("B")
    process.edge(a, b, guard=(x >= 2) & (x <= 3), updates=[y.assign(x + 1), x.assign(0)])
    assert reaches(network, b.reached & (y == 3) & (x == 0))
    assert reaches(network, b.reached & (y == 9) & (x >= 5))
    assert not reaches(network, b.reached & (y < 3))
    assert not reaches(network, b.reached & (y > 9) & (x < 5))


def test_updates_see_the_copies_of_earlier_ones(reaches) -> None:
    network = NetworkBuilder()
    x, y, z = (network.clock(name) for name in "xyz")
    process = network.process("P")
    a, b = process.location("A"), process.location("B", urgent=True)
    process.edge(a, b, guard=x == 2, updates=[y.assign(0), z.assign(x), x.assign(y + 5), y.assign(z + 1)])
    assert reaches(network, b.reached & (z == 2) & (x == 5) & (y == 3))


def test_a_deadlock_where_the_sum_of_two_copies_is_too_large(reaches) -> None:
    network = NetworkBuilder()
    x, y, z = (network.clock(name) for name in "xyz")
    process = network.process("P")
    a, b = process.location("A", invariant=y <= 4), process.location("B", invariant=z <= 5)
    process.edge(a, b, updates=[x.assign(y + 2), z.assign(x + 1)])
    process.edge(b, b, updates=[z.assign(0)])
    assert reaches(network, a.reached & deadlock() & (y > 2))
    assert not reaches(network, a.reached & deadlock() & (y <= 2))


def test_a_receiver_copies_what_the_sender_has_set(reaches) -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    channel = network.channel("c")
    sender, receiver = network.process("S"), network.process("R")
    a, b = sender.location("A"), sender.location("B")
    c, d = receiver.location("C"), receiver.location("D", urgent=True)
    sender.edge(a, b, guard=x == 4, send=channel, updates=[x.assign(1)])
    receiver.edge(c, d, receive=channel, updates=[y.assign(x + 2)])
    assert reaches(network, d.reached & (y == 3))
    assert not reaches(network, d.reached & (y > 3))


def test_a_computed_number_that_is_added_counts_for_the_unit_of_time(reaches) -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    n = network.integer("n", 0, 1)
    process = network.process("P")
    a, b = process.location("A"), process.location("B", urgent=True)
    process.edge(a, a, updates=[n.assign(1)])
    process.edge(a, b, guard=(y == 10) & (n == 1), updates=[x.assign(y + 5 * n)])
    assert reaches(network, b.reached & (x > 10) & (x < 20))
    assert not reaches(network, b.reached & ((x <= 10) | (x >= 20)))


def test_the_invariant_of_the_target_holds_for_the_copy(reaches) -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a, b = process.location("A"), process.location("B", invariant=y <= 5)
    process.edge(a, b, updates=[y.assign(x + 2)])
    assert reaches(network, b.reached & (x == 3))
    assert not reaches(network, b.reached & (x > 3))


def test_a_clock_that_only_copies_read_is_kept(reaches) -> None:
    """In another process than the one that compares the copy."""
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    channel = network.channel("c")
    copies, compares = network.process("P"), network.process("Q")
    a = copies.location("A")
    b, c = compares.location("B"), compares.location("C", urgent=True)
    copies.edge(a, a, guard=y >= 1, send=channel, updates=[x.assign(y), y.assign(0)])
    compares.edge(b, c, receive=channel, guard=x >= 3)
    assert reaches(network, c.reached & (x == 7))
    assert not reaches(network, c.reached & (x < 1))


def test_a_clock_that_advances_itself_for_ever_has_finitely_many_zones(reaches) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A", urgent=True), process.location("B")
    process.edge(a, a, updates=[x.assign(x + 3)])
    process.edge(a, b, guard=x == 9)
    assert reaches(network, b.reached)
    assert not reaches(network, a.reached & (x == 7))


def test_what_is_set_and_copied_may_depend_on_variables(reaches) -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    n = network.integer("n", 0, 3)
    process = network.process("P")
    a, b = process.location("A"), process.location("B", urgent=True)
    process.edge(a, a, guard=n < 2, updates=[n.assign(n + 1)])
    process.edge(a, b, guard=x == 1, updates=[conditional(n == 1, y, x).assign(conditional(n == 2, x, y) + n)])
    assert reaches(network, b.reached & (n == 1) & (y == 2) & (x == 1))
    assert reaches(network, b.reached & (n == 2) & (y == 1) & (x == 3))
    assert not reaches(network, b.reached & (n == 1) & (x > 1))


@pytest.mark.parametrize("chosen", [False, True])
def test_adding_a_negative_number_is_a_run_time_error(chosen: bool) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    n = network.integer("n", -1, 3, initial=-1)
    process = network.process("P")
    a, b = process.location("A"), process.location("B")
    process.edge(a, a, guard=x == 5, updates=[x.assign(x + (n if chosen else -1))])
    built, goals = network.build(), [b.reached.expression]
    for outcome in (zone.explore(*lower(built, goals)), reference.explore(built, goals)):
        assert outcome.fault is not None
        assert outcome.fault.kind is RuntimeErrorKind.NEGATIVE_CLOCK


STOPPED = """
clock x, y, z, s, many[2];
int n;
void copies(clock &to, clock &from, int more) { to = from + more; }
process P() {
    init location run { invariant s <= 3; to stand { guard s >= 1; assign x = 0; } }
    location stand { invariant x <= 5 && s' == 0; to again { guard x >= 2; assign UPDATE; } }
    location again { invariant s' == 0 && z' == (n == 0); }
}
system P;
property least : E<> P.again && z < 1;
property most : E<> P.again && z > 3 && y <= 0;
property same : E<> P.again && z == 3 && x == 2 && y == 0;
property runs_on : E<> P.again && z == 9 && s == 2 && x == 9;
property too_far : E<> P.again && z > 5 && y < 2;
"""
"""Behind the copy z is s, which has run for 1 to 3 and stood for 2 to 5, and y is 0."""


@pytest.mark.parametrize("engine", [Engine.ZONE, Engine.SMT])
@pytest.mark.parametrize(
    "update",
    [
        "z = s, y = 0",
        "y = s, z = y, y = 0",
        "copies(z, s, n), y = 0",
        "many[n] = s, z = many[n], y = 0",
        "z = n == 0 ? s : x, y = 0",
        "y = s + 4, s = 2, z = y, z = z + n, y = 0",
    ],
)
def test_every_form_of_copy_reads_a_clock_that_stood_still(update: str, engine: Engine) -> None:
    text = STOPPED.replace("UPDATE", update)
    expected = {"least": False, "most": False, "same": True, "runs_on": True, "too_far": False}
    if "s + 4" in update:
        text = text.replace("z < 1", "z < 5").replace("z > 3", "z > 7").replace("z == 3", "z == 7")
        text = text.replace("z == 9", "z == 13").replace("z > 5", "z > 9")
    verdicts = tachk.loads(text).verify(options=tachk.Options(engine=engine))
    assert {verdict.query.name: verdict.answer == "holds" for verdict in verdicts} == expected
    assert all(verdict.exact and verdict.answer in ("holds", "fails") for verdict in verdicts)


def test_runs_that_go_on_for_ever_beside_copies_of_clocks_that_stand_still() -> None:
    model = tachk.loads(
        "clock x, y, s; process P() { init location a { invariant x <= 2 && s' == 0; to b { assign y = s, x = 0; } }"
        " location b { invariant x <= 2 && y' == 0; to a { assign s = y, x = 0; } } } system P;"
    )
    answers = [verdict.answer for verdict in model.verify("A<> s > 2", "E[] s <= 1", "A<> y > x + 2", "A[] s <= 2")]
    assert answers == ["fails", "holds", "fails", "holds"]


def test_the_fastest_run_beside_copies_of_clocks_that_stand_still() -> None:
    model = tachk.loads(
        "clock x, y, s; process P() { init location a { to b { assign x = 0; } }"
        " location b { invariant s' == 0; to c { guard x >= 3; assign y = s + 1, x = 0; } }"
        " location c { invariant y' == 0; to d { guard x >= 1; } }"
        " location d { to e { guard y >= 6; } } location e; } system P;"
    )
    (verdict,) = model.verify("E<> P.e", options=tachk.Options(pace=Pace.FASTEST))
    assert verdict.trace is not None
    assert verdict.trace.states[-1].time == 9


def looping(update: str) -> tachk.Model:
    return tachk.loads(
        f"clock x, y, z; process P() {{ init location a {{ to a {{ assign {update}; }} to b {{ guard x - z <= 3; }} }}"
        " location b; } system P; property p : E<> P.b;"
    )


def test_differences_that_copies_change_without_end_are_rejected() -> None:
    with pytest.raises(UnsupportedError) as caught:
        looping("x = y + 1, y = x").verify()
    assert caught.value.diagnostic.code == "E0712"
    assert looping("x = y, y = z + 1").verify()["p"].answer == "holds"


def test_local_times_are_not_for_copies() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a, b = process.location("A"), process.location("B")
    process.edge(a, b, guard=y >= 1, updates=[y.assign(x)])
    image = encode(*lower(network.build(), [b.reached.expression]))
    assert obstacle(image) == "clocks are set to the values of others"


@pytest.mark.parametrize("computed", [False, True])
def test_transitions_that_advance_clocks_far_are_not_answered_wrongly(computed: bool) -> None:
    """Each of the updates is small enough for a zone of 16 bits, all of them together are not."""
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    n = network.integer("n", 150, 180, initial=150)
    process = network.process("P")
    a, b = process.location("A"), process.location("B", urgent=True)
    process.edge(a, a, guard=n < 151, updates=[n.assign(n + 1)])
    process.edge(a, b, guard=(x == 100) & (y == 100), updates=[x.assign(x + (n if computed else 150))] * 120)
    goals = [(b.reached & (x < 5)).expression, (b.reached & (x >= 100) & (y <= 100)).expression]
    outcome = zone.explore(*lower(network.build(), goals))
    found = [goal.status.value for goal in outcome.goals]
    assert found == (["undecided"] * 2 if computed else ["unreachable", "reached"])


def test_a_loop_that_repeats_has_the_same_values_where_others_copy_them() -> None:
    """Nothing compares y, but x is set to it."""
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    network.clock("z")
    process = network.process("P")
    a = process.location("A", invariant=x <= 3)
    process.edge(a, a, guard=x >= 1, updates=[x.assign(y)])
    model = prepare(network.build())
    seen = observable_clocks(model, [initial_discrete(model)], ())
    assert seen.largest == {1: 3}
    assert seen.related == {2}


SYMMETRIC = """
const int N = 3; typedef int[0, N - 1] id_t;
clock g[N], last; int[0, N] busy;
process P(const id_t me) {
    clock x, y;
    init location a {
        invariant x <= 4;
        to b { guard x >= 1 && busy < 2; assign y = x, g[me] = y + 1, x = 0, busy = busy + 1; }
        to a { guard x >= 3; assign x = last; }
    }
    location b {
        invariant g[me] <= 7;
        to a { guard y >= 4 && x >= 2; assign x = 0, busy = busy - 1, last = y; }
        to c { guard g[me] >= 6 && last < 2; }
    }
    location c;
}
system P;
property later : E<> P(0).b && P(1).b && P(0).y > P(1).y;
property both : E<> P(0).c && P(1).c;
property three : A[] !(P(0).b && P(1).b && P(2).b);
"""


def test_processes_that_copy_clocks_are_interchangeable() -> None:
    model = tachk.loads(SYMMETRIC)
    reduced, whole = model.verify(), model.verify(options=tachk.Options().off("symmetry"))
    assert [verdict.answer for verdict in whole] == ["holds", "fails", "holds"]
    assert [verdict.answer for verdict in reduced] == ["holds", "fails", "holds"]
    assert reduced["three"].statistics.states_stored < whole["three"].statistics.states_stored
