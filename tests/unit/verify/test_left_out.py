"""Answers that change when a process is taken to be outside the cone of influence, or to only block, that is not."""

from __future__ import annotations

from collections.abc import Callable

Answers = Callable[..., dict[str, str]]


def test_who_sends_on_a_channel_that_counts_counts(answers: Answers) -> None:
    text = """
    chan c;
    process Main() { init location A { to B { sync c?; } } location B; }
    process Helper() { init location U { to V { sync c!; } } location V; }
    system Main, Helper;
    property Q : E<> Main.B;
    """
    assert answers(text) == {"Q": "holds"}


def test_what_a_relevant_update_reads_counts(answers: Answers) -> None:
    text = """
    int n = 0, m = 0;
    process Main() { init location A { to A { assign n = m; } } }
    process Writer() { clock y; init location U { invariant y <= 3; to V { assign m = 1; } } location V; }
    system Main, Writer;
    property Q : E<> n == 1;
    """
    assert answers(text) == {"Q": "holds"}


def test_who_sends_a_broadcast_is_inside_the_cone(answers: Answers) -> None:
    text = """
    broadcast chan tick;
    process Main() { init location A { to B { sync tick?; } } location B; }
    process Sender() { init location U { to U { sync tick!; } } }
    system Main, Sender;
    property Q : E<> Main.B;
    """
    assert answers(text) == {"Q": "holds"}
