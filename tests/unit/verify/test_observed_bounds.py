"""Temporal properties of models where an event falls exactly on a bound of a window."""

from __future__ import annotations

from collections.abc import Callable

import pytest

pytestmark = pytest.mark.drawn

Answers = Callable[..., dict[str, str]]


def test_an_open_lower_bound_leaves_out_a_rise_just_there(answers: Answers) -> None:
    text = """
    process P() {
        clock x;
        init location I { to A { assign x = 0; } }
        location A { invariant x <= 1; to B { guard x == 1; } }
        location B;
    }
    system P;
    property Open : G (rise(P.A) -> G(1,3] !rise(P.B));
    property Closed : G (rise(P.A) -> G[1,3] !rise(P.B));
    """
    assert answers(text) == {"Open": "holds", "Closed": "fails"}


def test_what_was_not_for_exactly_the_length_of_a_closed_window_was_not_in_it(answers: Answers) -> None:
    text = """
    process P() {
        clock x;
        init location A { to M { guard x >= 1; assign x = 0; } }
        location M { invariant x <= 2; to B { guard x == 2; } }
        location B;
    }
    system P;
    property Q : G (rise(P.B) -> O[0,2] P.A);
    """
    assert answers(text) == {"Q": "fails"}


def test_what_ended_exactly_the_length_of_a_window_ago_is_not_in_it(answers: Answers) -> None:
    text = """
    process P() {
        clock x;
        init location A { to M { assign x = 0; } }
        location M { invariant x <= 2; to B { guard x == 2; } }
        location B;
    }
    system P;
    property Q : G (rise(P.B) -> H[0,2] !P.A);
    """
    assert answers(text) == {"Q": "holds"}


def test_a_window_in_a_window_is_open_where_either_is(answers: Answers) -> None:
    text = """
    process P() {
        clock x;
        init location I { to A { assign x = 0; } }
        location A { invariant x <= 2; to B { guard x == 2; } }
        location B;
    }
    system P;
    property Open : G (rise(P.A) -> G(1,2] G[1,2] !rise(P.B));
    property Closed : G (rise(P.A) -> G[1,2] G[1,2] !rise(P.B));
    """
    assert answers(text) == {"Open": "holds", "Closed": "fails"}


def test_what_has_to_hold_until_then_may_end_just_then(answers: Answers) -> None:
    text = """
    process P() {
        clock x;
        init location I { to A { assign x = 0; } }
        location A { invariant x <= 2; to B { guard x == 2; } }
        location B;
    }
    system P;
    property Q : G (rise(P.A) -> P.A U[2,5] P.B);
    """
    assert answers(text) == {"Q": "holds"}


def test_nothing_falls_at_the_start_of_a_run(answers: Answers) -> None:
    text = """
    process P() { init location A; location B; }
    system P;
    property Q : G !fall(P.B);
    """
    assert answers(text) == {"Q": "holds"}


def test_a_time_without_the_left_side_ends_what_since_has_seen(answers: Answers) -> None:
    text = """
    process P() {
        clock x;
        init location A { invariant x <= 1; to M { guard x == 1; assign x = 0; } }
        location M { invariant x <= 1; to C { guard x == 1; assign x = 0; } }
        location C { invariant x <= 1; to T { guard x == 1; } }
        location T;
    }
    system P;
    property Q : G (rise(P.T) -> (P.A || P.C || P.T) S[0,5] P.A);
    property R : G (rise(P.T) -> (P.A || P.M || P.C || P.T) S[0,5] P.A);
    """
    assert answers(text) == {"Q": "fails", "R": "holds"}


def test_an_answer_at_the_open_end_of_a_window_is_too_late(answers: Answers) -> None:
    text = """
    process P() {
        clock x;
        init location I { to A { assign x = 0; } }
        location A { invariant x <= 1; to C { guard x == 1; assign x = 0; } }
        location C { invariant x <= 1; to D { guard x == 1; } }
        location D;
    }
    system P;
    property Open : G (rise(P.A) -> F[0,2] G[0,1) P.C);
    property Closed : G (rise(P.A) -> F[0,2] G[0,1] P.C);
    """
    assert answers(text) == {"Open": "holds", "Closed": "fails"}


def test_gaps_between_rises(answers: Answers) -> None:
    text = """
    process P() {
        clock x;
        init location B { invariant x <= 6; to A { guard x >= 4; assign x = 0; } }
        location A { invariant x <= 1; to B { guard x == 1; } }
    }
    system P;
    property Longest : G (rise(P.A) -> F(0,6] rise(P.A));
    property Longer : G (rise(P.A) -> F(0,6) rise(P.A));
    property Jitter : G (rise(P.A) -> F[4,6] rise(P.A));
    property Later : G (rise(P.A) -> F(4,6] rise(P.A));
    property Much_later : G (rise(P.A) -> F[5,6] rise(P.A));
    property Falls : G (rise(P.A) -> F[1,1] fall(P.A));
    property Itself : G (rise(P.A) -> F[0,1] rise(P.A));
    """
    assert answers(text) == {
        "Longest": "holds",
        "Longer": "fails",
        "Jitter": "holds",
        "Later": "fails",
        "Much_later": "fails",
        "Falls": "holds",
        "Itself": "holds",
    }


TWICE = """
bool q, r;
process P() {
    clock x;
    init location A { invariant x <= 1; to B { guard x == 1; assign q = 1, x = 0; } }
    location B { invariant x <= 1; to C { guard x == 1; assign q = 0, x = 0; } }
    location C { invariant x <= 2; to D { guard x == 2; assign q = 1, x = 0; } }
    location D { invariant x <= 4; to E { guard x == 4; assign r = 1; } }
    location E;
}
system P;
"""
"""q from 1 to 2 and from 4 on, r from 8 on."""


def test_the_second_beginning_of_a_chain_counts_from_its_own_time(answers: Answers) -> None:
    properties = """
    property Later : F[0,10] (rise(q) && F[0,5] rise(r));
    property Exactly : F[0,10] (rise(q) && F[0,4] rise(r));
    property Open : F[0,10] (rise(q) && F[0,4) rise(r));
    property First : F[0,3] (rise(q) && F[0,7] rise(r));
    property Too_late : F[0,3] (rise(q) && F[0,6] rise(r));
    """
    assert answers(TWICE + properties) == {
        "Later": "holds",
        "Exactly": "holds",
        "Open": "fails",
        "First": "holds",
        "Too_late": "fails",
    }


def test_the_end_of_what_begins_a_chain_is_no_part_of_it(answers: Answers) -> None:
    properties = """
    property Just_out : F[0,3] (q && F[0,6] rise(r));
    property Inside : F[0,3] (q && F[0,7] rise(r));
    property Open : F[0,3] (q && F[0,7) rise(r));
    """
    assert answers(TWICE + properties) == {"Just_out": "fails", "Inside": "holds", "Open": "holds"}


def test_what_is_right_at_the_first_instant_only_does_not_pass_for_what_was_before(answers: Answers) -> None:
    text = """
    bool q;
    bool r = true;
    process P() { init location A; }
    system P;
    property First : F[0,6] ((!q || fall(r)) && F[0,3] rise(r));
    property Later : F[0,6] ((!q || fall(r)) && F(0,3] rise(r));
    """
    # Before the run everything is false, so r rises at 0, and there alone.
    assert answers(text) == {"First": "holds", "Later": "fails"}
