"""Runs that avoid a goal, where one state stands for its orbit under permutations of interchangeable processes."""

from __future__ import annotations

from itertools import pairwise

import pytest

import tachk
from tachk.base.resources import data_root
from tachk.engine.options import NEVER, Limits, Options

FISCHER = data_root() / "models" / "classics" / "fischer.ta"
SOMEBODY = "(exists (i : pid_t) P(i).request) --> (exists (i : pid_t) P(i).waiting)"


@pytest.mark.parametrize(
    ("query", "most"),
    [
        (SOMEBODY, 1_000),
        ("P(1).request --> P(1).waiting", 6_000),
        ("P(1).request && P(1).x > 0 --> P(1).waiting", 6_000),
        ("P(1).request --> P(1).x > 10 || P(1).waiting", 6_000),
        ("P(1).request --> deadlock || P(1).waiting", 8_000),
    ],
)
@pytest.mark.parametrize("options", [Options(), Options(proof_after=NEVER)])
def test_what_holds_of_many_processes(query: str, most: int, options: Options) -> None:
    (verdict,) = tachk.load(FISCHER, N=12).verify(query, options=options, limits=Limits(states=most))
    assert verdict.answer.value == "holds" and verdict.statistics.interchangeable > 0


def test_zones_of_few_clocks_in_records_for_many() -> None:
    """With 21 clocks a whole zone has 1,008 bytes; rows of fewer clocks are read 32 bytes at a time."""
    (verdict,) = tachk.load(FISCHER, N=20).verify("P(1).request --> P(1).waiting", limits=Limits(states=20_000))
    assert verdict.answer.value == "holds"


TAKING_TURNS = """
int[0, 3] last = 0;
process P(const int[1, 3] me) {
    clock x;
    init location wait { invariant x <= 2; to wait { guard last != me && x >= 1; assign last = me, x = 0; } }
}
system P;
"""


def test_a_run_is_reported_with_the_names_of_the_model() -> None:
    """Up to exchanges it comes back to where it was after each step; the processes that act are different ones."""
    (verdict,) = tachk.loads(TAKING_TURNS).verify("A<> last == 0 && P(1).wait && last == 1")
    assert verdict.answer.value == "fails" and verdict.trace is not None
    acting = [transition.participants[0].process for transition in verdict.trace.path]
    assert len(acting) > 2 and all(one != other for one, other in pairwise(acting))


GOAL = """
process P(const int[1, 3] me) {
    clock x;
    init location start { invariant x <= 1; to done { guard x >= 1; assign x = 0; } }
    location done { invariant x <= 2; to again { guard x >= 1; } }
    location again;
}
system P;
"""


@pytest.mark.parametrize(
    ("query", "holds", "sorts"),
    [
        ("A<> exists (i : int[1, 3]) P(i).done", True, True),
        ("A<> exists (i : int[1, 3]) P(i).done && P(i).x > 0", True, True),
        ("A<> exists (i : int[1, 3]) P(i).done && P(i).x > 1", False, False),
        ("A<> forall (i : int[1, 3]) P(i).done", True, True),
        ("A<> (exists (i : int[1, 3]) P(i).again) && (exists (i : int[1, 3]) P(i).start)", False, True),
    ],
)
@pytest.mark.parametrize("options", [Options(), Options(proof_after=NEVER), Options(proof_after=0)])
def test_runs_end_at_the_goal(query: str, holds: bool, sorts: bool, options: Options) -> None:
    (verdict,) = tachk.loads(GOAL).verify(query, options=options)
    assert (verdict.answer.value == "holds") is holds
    assert (verdict.statistics.interchangeable > 0) is (holds and sorts)


APART_BUT_FOR_AN_EDGE_IN_VAIN = """
typedef int[0, 2] id_t;
int[0, 1] fork[id_t] = {1, 0, 0};
chan to[id_t];
process P(const id_t me) {
    clock x;
    init location begin { to middle { assign x = 0; } }
    location middle { invariant x <= 3; to end { guard x > 2; } }
    location end { to end { guard fork[(me + 2) % 3] == 0 && x == 2; sync to[(me + 1) % 3]!; } }
}
system P;
"""


def test_processes_that_only_an_edge_without_a_partner_distinguishes() -> None:
    """Its guard is false for one of them at once; still all have the same clock bounds, and the run is told."""
    (verdict,) = tachk.loads(APART_BUT_FOR_AN_EDGE_IN_VAIN).verify("A[] not deadlock")
    assert verdict.statistics.interchangeable > 0
    assert verdict.trace is not None and len(verdict.trace.path) == 6
