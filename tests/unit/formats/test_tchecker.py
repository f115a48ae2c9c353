"""Models in TChecker's words: the text, what is refused, and that reading it back gives the same behaviour."""

from __future__ import annotations

import pytest

from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.span import Source
from tachk.engine.options import Limits, Options
from tachk.formats.loading.load import load_model
from tachk.formats.tchecker.writer import TCheckerModel, to_tchecker


def export(text: str) -> TCheckerModel:
    model = load_model(Source("model.ta", text))
    return to_tchecker(model.network, model.queries, "model")


def states(text: str, name: str) -> tuple[int, int]:
    model = api.Model(load_model(Source(name, text)), name)
    report = model.verify("E<> false", limits=Limits(states=50_000), options=Options().off("cone"))
    statistics = report[0].statistics
    return statistics.states_stored, statistics.transitions


def assert_same_state_space(text: str) -> str:
    written = export(text).text
    assert states(written, "model.tck") == states(text, "model.ta")
    return written


TRAINS = """\
typedef int[0, 1] id_t;
const int LIMIT[2] = { 5, 8 };
chan enter[2], leave[2];
int[0, 2] count = 0;
bool busy;

process Train(const id_t id) {
    clock x;
    init location Far { to Near { guard count < 2 || !busy; sync enter[id]!; assign x = 0; } }
    location Near {
        invariant x <= LIMIT[id];
        to Far { guard x >= 3 && (busy imply count == 1); sync leave[id]!; }
    }
}

process Gate() {
    init location Open {
        to Open { select t : id_t; sync enter[t]?; assign count = count + 1, busy = count; }
        to Open { select t : id_t; sync leave[t]?; assign count--, busy = count > 0; }
    }
}

system Train, Gate;
property both : E<> forall (t : id_t) Train(t).Near;
property full : A[] count < 2;
"""


def test_a_model() -> None:
    assert (
        export(TRAINS).text
        == """\
system:model

event:enter_0_send
event:leave_0_send
event:enter_1_send
event:leave_1_send
event:enter_0_receive
event:enter_1_receive
event:leave_0_receive
event:leave_1_receive

int:1:0:2:0:count
int:1:0:1:0:busy
clock:1:Train_0_x
clock:1:Train_1_x

process:Train_0
location:Train_0:Far{initial:}
location:Train_0:Near{invariant: Train_0_x <= 5 : labels: q1_1}
edge:Train_0:Far:Near:enter_0_send{provided: (if count < 2 then 1 else (if busy == 0 then 1 else 0)) != 0 : \
do: Train_0_x = 0}
edge:Train_0:Near:Far:leave_0_send{provided: (if busy == 0 then 1 else (if count == 1 then 1 else 0)) != 0 && \
Train_0_x >= 3}

process:Train_1
location:Train_1:Far{initial:}
location:Train_1:Near{invariant: Train_1_x <= 8 : labels: q1_2}
edge:Train_1:Far:Near:enter_1_send{provided: (if count < 2 then 1 else (if busy == 0 then 1 else 0)) != 0 : \
do: Train_1_x = 0}
edge:Train_1:Near:Far:leave_1_send{provided: (if busy == 0 then 1 else (if count == 1 then 1 else 0)) != 0 && \
Train_1_x >= 3}

process:Gate
location:Gate:Open{initial:}
edge:Gate:Open:Open:enter_0_receive{do: count = (count + 1); busy = (if count != 0 then 1 else 0)}
edge:Gate:Open:Open:enter_1_receive{do: count = (count + 1); busy = (if count != 0 then 1 else 0)}
edge:Gate:Open:Open:leave_0_receive{do: count = count - 1; busy = (if count > 0 then 1 else 0)}
edge:Gate:Open:Open:leave_1_receive{do: count = count - 1; busy = (if count > 0 then 1 else 0)}

sync:Train_0@enter_0_send:Gate@enter_0_receive
sync:Train_0@leave_0_send:Gate@leave_0_receive
sync:Train_1@enter_1_send:Gate@enter_1_receive
sync:Train_1@leave_1_send:Gate@leave_1_receive

# both: E<> forall (t : id_t) Train(t).Near
#     holds if TChecker reaches -l q1_1,q1_2
# full: A[] count < 2
#     labels cannot ask it: it asks for more than locations
"""
    )


def test_it_comes_back_with_the_same_states() -> None:
    assert_same_state_space(TRAINS)


def test_a_computed_channel_becomes_an_edge_for_each() -> None:
    written = assert_same_state_space("""\
chan c[3];
int[0, 2] turn;
process S() { init location A { to A { sync c[turn]!; assign turn = (turn + 1) % 3; } } }
process R(const int[0, 2] i) { int[0, 5] n; init location A { to A { guard n < 5; sync c[i]?; assign n++; } } }
system S, R;
""")
    assert "edge:S:A:A:c_1_send{provided: turn == 1 : do: turn = ((turn + 1) % 3)}" in written


def test_arrays_with_computed_indices_stay_arrays() -> None:
    written = assert_same_state_space("""\
int[0, 3] a[2][3];
int[0, 2] i;
const int step[3] = { 1, 2, 0 };
process P() { init location A { to A { guard a[1][i] < 2; assign a[1][i]++, i = step[i]; } } }
system P;
""")
    assert "int:6:0:3:0:a" in written
    assert "a[(3 + i)] < 2" in written
    assert "i = (if i == 0 then 1 else (if i == 1 then 2 else 0))" in written


def test_broadcasts_are_weak_and_updates_keep_their_order() -> None:
    written = assert_same_state_space("""\
broadcast chan go;
int[0, 9] n;
process B() { init location A { to C { sync go?; assign n = n + 1; } } location C; }
process S() { init location A { to C { sync go!; assign n = 4; } } location C; }
process D() { init location A { to C { sync go?; assign n = 2 * n < 10 ? 2 * n : n; } } location C; }
system B, S, D;
""")
    assert "sync:S@go_send:B@go_receive?:D@go_receive?" in written


def test_meta_variables_begin_every_transition_afresh() -> None:
    written = assert_same_state_space("""\
chan c;
process S() { int[0, 3] k; init location A { to A { guard k < 3; sync c!k + 1; assign k++; } } }
process R() { int[0, 9] n; init location A { to A { sync c?n; } } }
system S, R;
""")
    assert "do: R_n = c_value; c_value = 0" in written


def test_a_clock_condition_behind_a_disjunction_gives_two_edges() -> None:
    written = assert_same_state_space("""\
clock x;
bool b;
process P() {
    init location A { invariant x <= 9; to B { guard b || x > 4; } to A { guard !b; assign b = true; } }
    location B;
}
system P;
""")
    assert "edge:P:A:B:tau{provided: b == 0 && x > 4}" in written
    assert written.count("edge:P:A:B:tau") == 2


def test_copies_of_clocks_are_written_with_the_number_first() -> None:
    written = assert_same_state_space("""\
clock x, y, z[2];
int[0, 3] n;
process P() {
    init location A { invariant x <= 3; to B { guard x >= 2; assign y = x, x = y + 1, z[1] = n; } }
    location B { invariant y <= 5; to A { assign x = n + z[1] + 1, n = (n + 1) % 3, z[0] = y; } }
}
system P;
""")
    assert "do: y = x; x = 1 + y; z_1 = 0 + n" in written
    assert "do: x = (n + 1) + z_1; n = ((n + 1) % 3); z_0 = y" in written


def test_edges_without_a_partner_are_left_out() -> None:
    written = assert_same_state_space("""\
chan c;
broadcast chan d;
process P() { init location A { to B { sync c!; } to B { sync d!; } to B { sync d?; } } location B; }
system P;
""")
    assert written.count("edge:") == 1
    assert "sync:" not in written


REFUSALS = {
    "urgent channels": "urgent chan c; process P() { init location A { to A { sync c!; } } } system P;",
    "priorities of channels": "chan c; chan priority c < default; process P() { init location A; } system P;",
    "priorities of processes": "process P() { init location A; } process Q() { init location A; } system P < Q;",
    "clocks that stand still": "clock x; process P() { init location A { invariant x' == 0; } } system P;",
    "functions: `f` is called": "void f() { } process P() { init location A { to A { assign f(); } } } system P;",
    "comparison of two clocks": "clock x, y; process P() { init location A { to A { guard x < y; } } } system P;",
    "guards on edges that receive a broadcast": """
        broadcast chan c; int n;
        process P() { init location A { to A { sync c!; assign n = 1; } } }
        process Q() { init location A { to A { guard n > 0; sync c?; } } } system P, Q;""",
    "arrays with different initial values: `a`": """
        int a[2] = { 1, 2 }; int[0, 1] i;
        process P() { init location A { to A { assign a[i] = 1, i = 1 - i; } } } system P;""",
    "operator `&`": "int n; process P() { init location A { to A { guard (n & 1) == 0; assign n = 1; } } } system P;",
    "assignment inside an expression": """
        int n, m; process P() { init location A { to A { assign n = (m = 1); } } } system P;""",
    "invariants in which a clock condition depends on variables": """
        clock x; bool b;
        process P() { init location A { invariant b || x < 3; to A { assign b = true; } } } system P;""",
}


@pytest.mark.parametrize("what", REFUSALS)
def test_what_tchecker_has_no_words_for_is_rejected_by_name(what: str) -> None:
    with pytest.raises(UnsupportedError) as caught:
        export(REFUSALS[what])
    diagnostic = caught.value.diagnostic
    assert diagnostic.code == "E0802"
    assert what in diagnostic.message
    assert diagnostic.span.source.name == "model.ta"


def test_a_rejection_names_all_places() -> None:
    with pytest.raises(UnsupportedError) as caught:
        export("void f() { } process P() { init location A { to A { assign f(); } to A { assign f(); } } } system P;")
    assert len(caught.value.diagnostic.labels) == 1


def test_queries_as_labels() -> None:
    model = export("""\
process P() { init location A { to B; } location B { to C; } location C; }
process Q() { init location A { to B; } location B; }
system P, Q;
property one : A[] !(P.B && Q.B);
property two : E<> P.C || Q.B && !P.A;
property never : E<> P.A && P.B;
property clocks : A<> P.C;
""")
    one, two, never, eventually = model.labels
    assert one.alternatives == (("q1_1", "q1_2"),)
    assert two.alternatives == (("q2_1",), ("q2_2", "q2_3"))
    assert never.alternatives == ()
    assert never.reason == ""
    assert eventually.reason == "TChecker does not check A<>"
    assert "location:P:B{labels: q1_1,q2_2}" in model.text
