"""One rule for run-time errors (docs/semantics.md): engine, oracles, concretiser and replay evaluate the same."""

from __future__ import annotations

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.engine.options import Engine, Extrapolation, LocalTimes, Options, SearchOrder
from tachk.formats.loading.load import load_model
from tachk.model.fault import RuntimeErrorKind
from tachk.verify.fault_explanation import diagnostic_of
from tachk.verify.verdict import Verdict
from tachk.verify.verify import verify


def verdict(text: str, query: str) -> Verdict:
    loaded = load_model(Source("model.ta", f"{text}\nproperty Q : {query};"))
    (found,) = verify(loaded.network, loaded.queries)
    return found


CONDITIONAL_RESET = """
    clock x, y; bool flag = true;
    process P() {
        init location I { to A { guard x >= 7; assign flag = false; } }
        location A { to B { assign flag ? (x = 0) : (y = 0); } }
        location B { to C { guard x <= 5; } to D { guard y <= 2 && x >= 9; } }
        location C; location D;
    }
    system P;
"""


@pytest.mark.parametrize(("query", "answer"), [("E<> P.B", "holds"), ("E<> P.C", "fails"), ("E<> P.D", "holds")])
def test_an_update_may_choose_the_clock_that_it_sets(query: str, answer: str) -> None:
    found = verdict(CONDITIONAL_RESET, query)
    assert found.answer.value == answer
    assert (found.trace is not None) is (answer == "holds")


BUFFER = """
    int[0,3] buf[4]; int len = 0; {urgent} chan get;
    process Consumer() {{ init location Idle {{ to Busy {{ guard buf[len - 1] == 0; sync get?; }} }} location Busy; }}
    process Producer() {{
        clock x;
        init location Wait {{ invariant x <= 5; to Full {{ guard x >= 2; assign buf[0] = 0, len = 1; }} }}
        location Full {{ to Wait {{ sync get!; assign x = 0, len = 0; }} }}
    }}
    system Consumer, Producer;
"""


@pytest.mark.parametrize("urgent", ["urgent", ""])
@pytest.mark.parametrize(
    ("query", "answer"),
    [("E<> Consumer.Busy", "holds"), ("A[] not Producer.Full", "fails"), ("A[] not deadlock", "fails")],
)
def test_the_guard_of_a_receiver_is_evaluated_only_for_a_sender(urgent: str, query: str, answer: str) -> None:
    found = verdict(BUFFER.format(urgent=urgent), query)
    assert found.answer.value == answer
    assert found.trace is not None


BESIDE = """
    int a[2], n = 2; chan c;
    process P() { init location A { to A { guard a[n] == 0; sync c?; } to B; } location B; }
    process Q() { init location A; location B { to A { sync c!; } } }
    system P, Q;
"""


@pytest.mark.parametrize(("query", "answer"), [("E<> P.B", "holds"), ("A[] not P.B", "fails"), ("G !P.B", "fails")])
def test_a_guard_that_nobody_asks_for_does_not_spoil_a_run(query: str, answer: str) -> None:
    found = verdict(BESIDE, query)
    assert found.answer.value == answer
    assert found.trace is not None


def test_a_delay_asks_urgent_senders_only() -> None:
    text = """
        int a[2], n = 2; clock x; urgent chan u;
        process P() { init location A { to A { guard a[n] == 0; } } }
        process Q() { init location A { to A { sync u!; } } }
        system P, Q;
    """
    found = verdict(text, "E<> x >= 3 && P.A")
    assert found.answer.value == "holds"
    assert found.trace is not None


SENDER = """
    int a[2], n = 2; chan c;
    process P() { init location A { to A { guard a[n] == 0; sync c!; } to B; } location B; }
    process Q() { init location A; }
    system P, Q;
"""


def test_the_guard_of_a_sender_is_evaluated_also_where_nobody_receives() -> None:
    found = verdict(SENDER, "A[] P.A || P.B")
    assert found.answer.value == "unknown"
    assert found.fault is not None


FAULTY_ACTION = """
    int a[2], n = 2;
    process P() { init location A { to A { assign a[n] = 1; } } location B; }
    system P;
"""


@pytest.mark.parametrize(
    ("query", "answer"),
    [
        ("E<> deadlock || P.A", "holds"),
        ("E<> P.A || deadlock", "holds"),
        ("A[] not deadlock && not P.A", "fails"),
        ("E<> deadlock || P.B", "unknown"),
        ("A[] not deadlock", "unknown"),
    ],
)
def test_what_decides_without_deadlock_needs_no_action(query: str, answer: str) -> None:
    found = verdict(FAULTY_ACTION, query)
    assert found.answer.value == answer
    assert (found.fault is not None) is (answer == "unknown")
    assert (found.trace is not None) is (answer != "unknown")


def of_channel(guard: str) -> str:
    return f"""
        chan c[2]; int n = 2;
        process P() {{
            clock x;
            init location A {{
                invariant x < 3;
                to A {{ guard {guard}; sync c[n]!; }}
                to A {{ guard x >= 1; assign x = 0; }}
            }}
        }}
        system P;
    """


@pytest.mark.parametrize(
    ("guard", "answer"), [("x >= 3", "holds"), ("x >= 3 && n < 2", "holds"), ("n < 2", "holds"), ("x >= 2", "unknown")]
)
def test_a_channel_index_counts_only_where_the_guard_holds(guard: str, answer: str) -> None:
    assert verdict(of_channel(guard), "A[] not deadlock").answer.value == answer


def of_receiver(guard: str, kind: str) -> str:
    return f"""
        {kind} chan c[2], d; int n = 2; clock x;
        process P() {{ init location A {{ to A {{ guard {guard}; sync c[n]?; }} }} }}
        process Q() {{
            init location A {{ invariant x <= 3; to B {{ sync c[0]!; }} to D {{ sync d!; }} }}
            location B; location D;
        }}
        system P, Q;
    """


@pytest.mark.parametrize("kind", ["broadcast", ""])
@pytest.mark.parametrize(("guard", "answer"), [("x >= 4", "fails"), ("x >= 2", "unknown"), ("n < 2", "fails")])
def test_the_channel_index_of_a_receiver_counts_only_where_its_guard_holds(kind: str, guard: str, answer: str) -> None:
    assert verdict(of_receiver(guard, kind), "E<> x >= 4 && Q.A && P.A").answer.value == answer


def test_a_sender_on_another_channel_does_not_ask() -> None:
    text = of_receiver("x >= 0", "broadcast").replace("to B { sync c[0]!; }", "")
    assert verdict(text, "E<> Q.B && P.A").answer.value == "fails"


def test_a_receiver_whose_channel_is_known_beforehand_is_asked_on_that_only() -> None:
    text = """
        chan c[2]; int a[2], n = 2; int k = 1;
        process P() { init location A { to A { guard a[n] == 1; sync c[k]?; } } }
        process Q() { init location A { to B { sync c[0]!; } } location B; }
        system P, Q;
    """
    assert verdict(text, "A[] P.A").answer.value == "holds"
    assert verdict(text.replace("sync c[0]!", "sync c[1]!"), "A[] P.A").answer.value == "unknown"
    assert verdict(text.replace("sync c[0]!;", "sync c[0]!; assign k = 1;"), "A[] P.A").answer.value == "unknown"


def test_an_initial_invariant_that_is_false_before_it_can_fail_is_an_input_error() -> None:
    text = "int a[2], n = 2; clock x; process P() { init location A { invariant x <= a[n] && n < 2; } } system P;"
    with pytest.raises(InputError, match="E0409"):
        verdict(text, "A[] P.A")


ORDER = """
    int a[2], n = 2, m = 0; clock x;
    process P() {{ init location A {{ to B {{ guard {guard}; assign n = 2, m = 0; }} }} location B; }}
    system P;
"""


@pytest.mark.parametrize(
    ("guard", "answer"),
    [
        ("n < 2 && a[n] == 1", "fails"),
        ("a[n] == 1 && n < 2", "unknown"),
        ("a[n] == 1 && m == 5", "unknown"),
        ("x <= a[n] && n < 2", "fails"),
        ("(x <= a[n] || n == 2) && x >= 1", "holds"),
        ("x >= 3 && a[n] == 1", "unknown"),
        ("m == 0 || a[n] == 1", "holds"),
        ("n == 2 || (x <= 3 && m == 5)", "holds"),
        ("(x <= 3 && a[n] == 1) || n == 2", "holds"),
        ("m == 0 ? x <= 3 : x <= a[n]", "holds"),
    ],
)
def test_a_guard_is_evaluated_from_left_to_right_clocks_last(guard: str, answer: str) -> None:
    found = verdict(ORDER.format(guard=guard), "E<> P.B")
    assert found.answer.value == answer


@pytest.mark.parametrize("stored", ["i - 1", "i + 4"])
def test_a_value_outside_the_range_of_a_slot_is_an_error(stored: str) -> None:
    text = f"""
    int[0,3] a[2]; int[0,1] i = 0;
    process P() {{
        init location A {{ to B {{ assign a[i] = {stored}, i = 1; }} }}
        location B {{ to A {{ assign i = 0; }} }}
    }}
    system P;
    """
    found = verdict(text, "E<> P.B")
    assert found.answer.value == "unknown"
    assert found.fault is not None
    assert found.fault.kind is RuntimeErrorKind.RANGE


@pytest.mark.parametrize("operator", ["<<", ">>"])
@pytest.mark.parametrize(("distance", "fails"), [(-1, True), (0, False), (31, False), (32, True)])
def test_a_shift_beyond_31_bits_is_an_error(operator: str, distance: int, fails: bool) -> None:
    text = f"""
    int n = 1; int[-1,32] k = {distance}, other = 0;
    process P() {{
        init location A {{ to B {{ assign n = (n {operator} k) == 0 ? 0 : 1, k = other; }} }}
        location B {{ to A {{ assign other = 1 - other; }} }}
    }}
    system P;
    """
    fault = verdict(text, "E<> P.B").fault
    assert (fault is not None) is fails
    assert fault is None or fault.kind is RuntimeErrorKind.SHIFT


def test_nobody_asks_a_receiver_whose_computed_channel_is_another_one() -> None:
    text = """
    int[0,3] buf[4]; int len = 0; int[0,1] n = 0; broadcast chan tick; chan other[2];
    process S() { init location A { to B { sync tick!; assign n = 1; } } location B { to A { assign n = 0; } } }
    process R() { init location L { to L { guard buf[len - 1] == 0; sync other[n]?; } } }
    system S, R;
    """
    found = verdict(text, "E<> S.B")
    assert found.answer.value == "holds"
    assert found.trace is not None


NEIGHBOURS = """
    int d; clock x;
    process A() { init location s { to t { assign d = 1; } } location t; }
    system A;
    property reached : E<> A.t;
    property wrong : A[] 1 / d == 1;
    property kept : A[] d <= 1;
    property stuck : E<> deadlock && d == 1;
    property stuck_wrong : E<> deadlock && 1 / (d - 1) == 1;
    property alive : A[] not deadlock;
    property met : A<> A.t;
    property met_wrong : A<> 1 / d == 1;
    property least : inf{A.t}: d;
    property least_wrong : inf: 1 / d;
"""


@pytest.mark.parametrize("engine", Engine)
def test_an_error_in_a_query_leaves_the_others_their_answers(engine: Engine) -> None:
    loaded = load_model(Source("model.ta", NEIGHBOURS))
    queries = [query for query in loaded.queries if engine is Engine.ZONE or query.target is not None]
    together = {v.query.name: v for v in verify(loaded.network, queries, Options(engine=engine))}
    for query in queries:
        (alone,) = verify(loaded.network, [query], Options(engine=engine))
        assert together[query.name].answer is alone.answer, query.name
        assert (alone.fault is not None) is query.name.endswith("wrong")
    for name, found in together.items():
        assert (found.answer.value == "unknown") is name.endswith("wrong")
        if found.fault is not None:
            assert found.reason == "run-time error"
            assert found.fault.kind is RuntimeErrorKind.DIVISION
            assert found.fault.of_query
            assert "in the query" in (diagnostic_of(found.fault).help or "")
    path = together["stuck_wrong"].fault
    assert path is not None
    assert len(path.path) == 1
    assert path.run is not None


@pytest.mark.parametrize(
    "options",
    [
        Options(order=SearchOrder.DFS),
        Options(shortest=True),
        Options(local_times=LocalTimes.ALWAYS),
        Options().off("unblocked", "sliced", "symmetry", "cone"),
        Options(extrapolation=Extrapolation.MAX).off("merging"),
    ],
)
def test_however_states_are_searched_only_the_query_with_an_error_is_open(options: Options) -> None:
    text = """
        int[0,3] d = 3; clock x;
        process A() { clock y; init location s { invariant y <= 2; to s { guard y >= 1; assign y = 0; } } }
        process B() { init location s { to s { guard x > 1 && d > 0; assign d = d - 1, x = 0; } to t; } location t; }
        a = A(); b = A(); system a, b, B;
        property found : E<> B.t && d == 0;
        property none : E<> B.t && d == 0 && x < 0;
        property wrong : E<> B.t && 6 / d == 7;
        property stuck : E<> deadlock; property stuck_wrong : E<> deadlock && 6 / d == 7;
    """
    loaded = load_model(Source("model.ta", text))
    answers = {v.query.name: v.answer.value for v in verify(loaded.network, loaded.queries, options)}
    assert answers == {
        "found": "holds",
        "none": "fails",
        "wrong": "unknown",
        "stuck": "fails",
        "stuck_wrong": "unknown",
    }


def test_an_error_in_the_model_counts_for_every_query() -> None:
    text = """
        int d; int[0,1] n;
        process A() {
            init location s { to s { guard n == 0; assign n = 1; } to t { guard n == 1 && 1 / d == 1; } }
            location t;
        }
        system A;
        property one : E<> A.t; property other : A[] n <= 1; property wrong : E<> 1 / d == 1;
    """
    loaded = load_model(Source("model.ta", text))
    for found in verify(loaded.network, loaded.queries):
        assert (found.answer.value, found.reason) == ("unknown", "run-time error")
        assert found.fault is not None
        assert found.fault.of_query is (found.query.name == "wrong")


def test_a_run_time_error_leaves_no_wrong_note_about_a_left_side() -> None:
    text = """
        int d;
        process A() { init location s { to t { assign d = 1; } } location t; }
        system A;
        property q : A[] (1 / d == 1 imply A.s);
    """
    loaded = load_model(Source("model.ta", text))
    (found,) = verify(loaded.network, loaded.queries)
    assert (found.answer.value, found.notes) == ("unknown", ())


@pytest.mark.parametrize(
    ("bound", "kind"),
    [
        ("5 / D", RuntimeErrorKind.DIVISION),
        ("5 % D", RuntimeErrorKind.DIVISION),
        ("n / D", RuntimeErrorKind.DIVISION),
        ("1 << (D - 1)", RuntimeErrorKind.SHIFT),
        ("2 ** (D - 1)", RuntimeErrorKind.NEGATIVE_EXPONENT),
    ],
)
def test_a_bound_of_a_clock_that_never_has_a_value(bound: str, kind: RuntimeErrorKind) -> None:
    """It was refused for its range."""
    for text in ("const int D = 0;", "int d; const int D = 0;"):
        process = f"process P() {{ state A, B; init A; trans A -> B {{ guard x >= {bound}; assign n = 1; }}; }}"
        found = verdict(f"{text} clock x; int n; {process} system P;", "E<> P.B")
        assert found.fault is not None and found.fault.kind is kind
        assert found.fault.span.text == bound


def test_a_bound_of_a_clock_may_divide_by_a_variable() -> None:
    """The quotient lies in -10..10, whatever the range of the divisor."""
    text = """
        int d; clock x;
        process P() {
            state A, B, C; init A;
            trans A -> B { guard d == 0; assign d = 3; }, B -> C { guard x >= 10 / d; };
        }
        system P;
    """
    assert verdict(text, "E<> P.C && x < 3").answer.value == "fails"
    assert verdict(text, "E<> P.C && x <= 3").answer.value == "holds"
