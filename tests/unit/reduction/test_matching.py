"""Processes whose edges and updates stand in different orders, and edges that no process takes part in."""

import pytest

import tachk
from tachk.analysis.never_taken import never_taken
from tachk.engine.symmetry.detection import find_symmetry

REGISTERS = """
int[0, 3] r1 = 0, r2 = 0, r3 = 0;
clock x1, x2, x3;
chan is1_0, is1_1, is1_2, is1_3, is2_0, is2_1, is2_2, is2_3, is3_0, is3_1, is3_2, is3_3;
broadcast chan set1, set2, set3;

process P1() {
    init location A { to B { sync is1_0!; assign x1 = 0; } }
    location B { to A { sync is1_1!; } to A { sync set1!; assign x1 = 0, r1 = 1, r2 = 1, r3 = 1; } }
}
process P2() {
    init location A { to B { sync is2_0!; assign x2 = 0; } }
    location B { to A { sync set2!; assign r3 = 2, x2 = 0, r1 = 2, r2 = 2; } to A { sync is2_2!; } }
}
process P3() {
    init location A { to B { sync is3_0!; assign x3 = 0; } }
    location B { to A { sync is3_3!; } to A { sync set3!; assign r1 = 3, r2 = 3, r3 = 3, x3 = 0; } }
}
process R1() { init location M {
    to M { guard r1 == 0; sync is1_0?; } to M { guard r1 == 1; sync is1_1?; } to M { sync set1?; }
    to M { guard r1 == 2; sync is1_2?; } to M { sync set3?; } to M { guard r1 == 3; sync is1_3?; } to M { sync set2?; }
} }
process R2() { init location M {
    to M { sync set1?; } to M { guard r2 == 3; sync is2_3?; } to M { guard r2 == 2; sync is2_2?; } to M { sync set3?; }
    to M { guard r2 == 0; sync is2_0?; } to M { sync set2?; } to M { guard r2 == 1; sync is2_1?; }
} }
process R3() { init location M {
    to M { guard r3 == 1; sync is3_1?; } to M { sync set2?; } to M { guard r3 == 3; sync is3_3?; } to M { sync set1?; }
    to M { guard r3 == 2; sync is3_2?; } to M { guard r3 == 0; sync is3_0?; } to M { sync set3?; }
} }
system P1, P2, P3, R1, R2, R3;
"""


def blocks(text: str) -> list[tuple[tuple[int, ...], ...]]:
    return [group.members for group in find_symmetry(tachk.loads(text).network, []).groups]


def test_edges_and_updates_may_come_in_any_order() -> None:
    assert blocks(REGISTERS) == [((0, 3), (1, 4), (2, 5))]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("r1 == 0; sync is1_0?", "r1 == 3; sync is1_0?"),
        ("r3 == 3; sync is3_3?", "r3 == 1; sync is3_3?"),
        ("r3 = 2, x2 = 0, r1 = 2", "r3 = 2, x2 = 0, r1 = 1"),
        ("sync set3?; } to M { guard r1", "} to M { guard r1"),
    ],
)
def test_what_distinguishes_one_process_leaves_two_at_most(old: str, new: str) -> None:
    assert REGISTERS.count(old) == 1
    assert all(len(members) < 3 for members in blocks(REGISTERS.replace(old, new)))


TWO = """
int[0, 3] a = 0, b = 0, c = 0, d = 0;
clock x1, x2;
process P1() { init location A { to B { assign %s; } } location B; }
process P2() { init location A { to B { assign %s; } } location B; }
system P1, P2;
"""


@pytest.mark.parametrize(
    ("one", "other", "similar"),
    [
        ("a = 1, x1 = 0", "x2 = 0, b = 1", True),
        ("x1 = 1, x1 = 0", "x2 = 1, x2 = 0", True),
        ("x1 = 1, x1 = 0", "x2 = 0, x2 = 1", False),
        ("a = 1, c = a", "b = 1, d = b", True),
        ("a = 1, c = a", "d = b, b = 1", False),
        ("x1 = 0, a = 1, c = a", "x2 = 0, d = b, b = 1", False),
        ("x1 = 0, c = 4", "x2 = 0, d = 4", True),
        ("x1 = 0, c = 4", "d = 4, x2 = 0", False),
        ("a = 1, c = 2, a = 3", "d = 2, b = 1, b = 3", True),
        ("a = 1, c = 2, a = 3", "b = 1, b = 3, d = 2", False),
    ],
)
def test_updates_keep_their_order_where_it_could_be_noticed(one: str, other: str, similar: bool) -> None:
    assert bool(blocks(TWO % (one, other))) is similar


def test_an_invariant_of_a_clock_that_another_process_resets_distinguishes_them() -> None:
    text = TWO % ("x1 = 0", "x2 = 0")
    one, other = "process P1() { init location A { ", "process P2() { init location A { "
    assert blocks(text.replace(one, one + "invariant x1 <= 2; ").replace(other, other + "invariant x2 <= 2; "))
    assert not blocks(text.replace(one, one + "invariant x1 <= 2; ").replace(other, other + "invariant x1 <= 2; "))


CHANNELS = """
chan call, own, heard;
broadcast chan all, news;
int[0, 2] a[2];
int[0, 5] i = 0;
process P() {
    init location A {
        to A { sync call!; }
        to A { sync own!; }
        to A { sync own?; }
        to A { sync all!; }
        to A { sync news?; }
        to A { guard a[i] == 1; sync news?; }
        to A { sync heard?; }
        to A { guard false; }
        to A { guard i < 5; assign i = i + 1; }
    }
}
process Q() { init location A { to A { sync heard!; } } }
system P, Q;
"""


def test_edges_without_a_partner_in_another_process_are_never_taken() -> None:
    network = tachk.loads(CHANNELS).network
    assert sorted(never_taken(network)) == [(0, 0), (0, 1), (0, 2), (0, 4), (0, 7)]


def test_edges_of_a_controller_that_correspond_to_none() -> None:
    """One is shorter than the others, and more of these serve one process than the other."""
    text = """
chan give1, give2;
int[0, 3] a = 0;
process P1() { init location A { to B { sync give1?; } } location B { } }
process P2() { init location A { to B { sync give2?; } } location B { } }
process C() {
    init location A {
        to A { guard a < 3; sync give1!; }
        to A { guard a == 1 && a < 3; sync give1!; assign a = 1; }
        to A { guard a == 1 && a < 3; sync give2!; assign a = 1; }
        to A { guard a == 1 && a < 3; sync give2!; assign a = 1; }
    }
}
system P1, P2, C;
"""
    assert not blocks(text)
