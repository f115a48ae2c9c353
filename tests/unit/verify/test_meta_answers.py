"""Answers that change when a meta variable whose value lasts is reset between transitions."""

from __future__ import annotations

from collections.abc import Callable

Answers = Callable[..., dict[str, str]]


def test_a_branch_that_is_not_taken_writes_nothing(answers: Answers) -> None:
    text = """
    meta int[0,1] m; bool flag = true;
    void f() { if (flag) m = 1; flag = false; }
    process P() {
        init location A { to B { assign f(); } }
        location B { to C { assign f(), flag = m == 1; } }
        location C;
    }
    system P;
    property Q : E<> P.C && flag;
    """
    assert answers(text) == {"Q": "holds"}


def test_a_loop_that_does_not_run_writes_nothing(answers: Answers) -> None:
    text = """
    meta int[0,1] m; bool flag = true;
    void f() { while (flag) { m = 1; flag = false; } flag = m == 1; }
    void g() { flag = false; f(); }
    process P() { init location A { to B { assign f(); } } location B { to C { assign g(); } } location C; }
    system P;
    property Q : E<> P.C && flag;
    """
    assert answers(text) == {"Q": "holds"}


def test_a_receiver_on_one_of_two_channels_reads_what_both_senders_write(answers: Answers) -> None:
    text = """
    meta int[0,1] m; int[0,2] n = 0; chan c, d;
    process S() { init location A { to B { sync c!; assign m = 1; } } location B { to C { sync d!; } } location C; }
    process R() { init location L { to L { sync (n == 0 ? c : d)?; assign n = m + 1; } } }
    system S, R;
    property Q : E<> S.C && n == 2;
    """
    assert answers(text) == {"Q": "holds"}
