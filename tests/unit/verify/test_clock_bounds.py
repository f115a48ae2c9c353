"""Answers that a clock bound too small would change: the largest constant is met along one path only."""

from __future__ import annotations

from collections.abc import Callable

Answers = Callable[..., dict[str, str]]


def test_a_receiver_stays_behind_only_where_its_guard_is_false(answers: Answers) -> None:
    text = """
    clock x; broadcast chan c;
    process S() { init location A { invariant x <= 2; to B { sync c!; } } location B; }
    process R() { init location Off { to On { guard x <= 3; sync c?; } } location On; }
    system S, R;
    property P : E<> S.B && R.Off;
    """
    assert answers(text) == {"P": "fails"}


def test_a_clock_that_is_reset_in_one_case_only_still_matters(answers: Answers) -> None:
    text = """
    clock x, y; bool flag = true;
    process P() {
        init location I { to A { guard x >= 7; assign flag = false; } }
        location A { to B { assign flag ? (x = 0) : (y = 0); } }
        location B { to C { guard x <= 5; } }
        location C;
    }
    system P;
    property Q : E<> P.C;
    """
    assert answers(text) == {"Q": "fails"}


def test_a_remainder_of_a_negative_number_is_negative(answers: Answers) -> None:
    text = """
    clock x; int[-5,5] n = 0;
    process P() {
        init location A { to B { guard x >= 7; assign n = -5; } }
        location B { to C { guard x <= 4 - n % 3; } }
        location C;
    }
    system P;
    property Q : E<> P.C;
    """
    assert answers(text) == {"Q": "fails"}


def test_a_product_is_extreme_at_any_pair_of_ends(answers: Answers) -> None:
    text = """
    clock x; int[-3,2] n = 0; int[-3,2] m = 0;
    process P() {
        init location A { to B { guard x >= 11; assign n = -3, m = 2; } }
        location B { to C { guard x <= 4 - n * m; } }
        location C;
    }
    system P;
    property Q : E<> P.C;
    """
    assert answers(text) == {"Q": "fails"}


def test_a_quotient_is_largest_at_a_divisor_of_one(answers: Answers) -> None:
    text = """
    clock x; int[0,9] n = 0; int[0,3] d = 3;
    process P() {
        init location A { to B { guard x >= 10; assign n = 9, d = 1; } }
        location B { to C { guard x <= n / d; } }
        location C;
    }
    system P;
    property Q : E<> P.C;
    """
    assert answers(text) == {"Q": "fails"}


def test_bits_join_to_more_than_either(answers: Answers) -> None:
    text = """
    clock x; int[0,4] n = 0; int[0,3] m = 0;
    process P() {
        init location A { to B { guard x >= 8; assign n = 4, m = 3; } }
        location B { to C { guard x <= (n | m); } }
        location C;
    }
    system P;
    property Q : E<> P.C;
    """
    assert answers(text) == {"Q": "fails"}


def test_a_function_may_change_its_parameter(answers: Answers) -> None:
    text = """
    clock x;
    int[0,9] f(int[0,9] p) { p = p + 5; return p; }
    process P() {
        init location A { to B { guard x >= 8; } }
        location B { to C { guard x <= f(2); } }
        location C;
    }
    system P;
    property Q : E<> P.C;
    """
    assert answers(text) == {"Q": "fails"}


def test_a_shift_is_largest_at_the_largest_distance(answers: Answers) -> None:
    text = """
    clock x; int[0,3] n = 0;
    process P() {
        init location A { to B { guard x >= 9; assign n = 3; } }
        location B { to C { guard x <= (1 << n); } }
        location C;
    }
    system P;
    property Q : E<> P.C;
    """
    assert answers(text) == {"Q": "fails"}
