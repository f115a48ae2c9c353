"""Locations, edges, branchpoints, synchronisation, passing values."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import tachk
from tachk.base.words import Direction
from tachk.model.evaluate import Environment, evaluate, execute
from tachk.model.types import ArrayType, IntType, RecordType
from tachk.model.variable_layout import variable_layout


def process(model: Any) -> Any:
    return model.network.processes[0]


def arrows(model: Any) -> list[tuple[str, str]]:
    p = process(model)
    return [(p.locations[e.source].name, p.locations[e.target].name) for e in p.edges]


CLASSIC = """
chan go;
process P() {
    clock x;
    state A { x <= 5 }, B, C;
    commit B;
    urgent C;
    init B;
    trans A -> B { guard x > 1; sync go!; assign x = 0; }, -> C { sync go?; }, B -> A { }, C -> A { };
}
"""
CENTRIC = """
chan go;
process P() {
    clock x;
    /// where it waits
    location A { invariant x <= 5; to B { guard x > 1; sync go!; assign x = 0; } to C { sync go?; } }
    init committed location B { to A; }
    urgent location C { to A; }
}
"""


@pytest.mark.parametrize("text", [CLASSIC, CENTRIC])
def test_both_forms_give_the_same_process(load: Any, text: str) -> None:
    model = load(text)
    p = process(model)
    assert [(loc.name, loc.urgent, loc.committed) for loc in p.locations] == [
        ("A", False, False),
        ("B", False, True),
        ("C", True, False),
    ]
    assert p.initial == 1
    assert arrows(model) == [("A", "B"), ("A", "C"), ("B", "A"), ("C", "A")]
    first = p.edges[0]
    assert first.synchronisation.direction is Direction.SEND
    assert first.guard.span.text == "x > 1"
    assert [u.span.text for u in first.updates] == ["x = 0"]
    assert p.edges[1].synchronisation.direction is Direction.RECEIVE


def test_doc_comments_reach_the_network(load: Any) -> None:
    assert process(load(CENTRIC)).locations[0].doc == "where it waits"


def test_locations_keep_their_own_invariants(load: Any) -> None:
    model = load("clock x; process P() { state A { x < 5 }, B { x <= 3; 2 }; init A; trans A -> B { }; }")
    assert [loc.invariant.span.text for loc in process(model).locations] == ["x < 5", "x <= 3"]


def test_selects_stay_bound_variables_and_shadow(load: Any) -> None:
    body = "state s; init s; trans s -> s { select n : int[0,3], k : id_t; guard n > k; sync c[n]!; assign a[n] = k; };"
    model = load(f"typedef int[0,1] id_t; int n; int a[4]; broadcast chan c[4]; process P() {{ {body} }}")
    (edge,) = process(model).edges
    assert [(v.name, v.type) for v in edge.selects] == [("n", IntType(0, 3)), ("k", IntType(0, 1))]
    layout = variable_layout(model.network)
    env = Environment(layout, list(layout.initial))
    env.bind(edge.selects[0], 2)
    env.bind(edge.selects[1], 1)
    assert evaluate(edge.guard, env) == 1
    execute(edge.updates, env)
    assert env.values[layout.names.index("a[2]")] == 1


def test_branchpoints_join_every_way_in_with_every_way_out(load: Any) -> None:
    text = """
        int n; broadcast chan c;
        process P() {
            init location A { to choice { select i : int[0,1]; guard n == i; sync c!; assign n = i; } to choice; }
            location B;
            branchpoint choice { to A { probability 3; assign n = n + 1; } to B { probability 0; } }
        }"""
    model = load(text)
    assert arrows(model) == [("A", "A"), ("A", "B"), ("A", "A"), ("A", "B")]
    joined = process(model).edges[0]
    assert [u.span.text for u in joined.updates] == ["n = i", "n = n + 1"]
    assert joined.guard.span.text == "n == i"
    assert len(joined.spans) == 2
    assert process(model).edges[2].synchronisation is None


def test_a_branch_selects_for_itself(load: Any) -> None:
    text = """
        int n; const int W[3] = {1, 2, 3};
        process P() {
            init location A { to choice { select i : int[0,1]; assign n = i; } }
            branchpoint choice { to A { select i : int[0,2]; assign n = n + i; probability W[i]; } }
        }"""
    (joined,) = process(load(text)).edges
    first, second = joined.selects
    assert (first.type, second.type) == (IntType(0, 1), IntType(0, 2))
    assert joined.updates[0].value.variable is first
    assert joined.updates[1].value.right.variable is second


def test_a_branch_may_carry_the_synchronisation(load: Any) -> None:
    text = """
        int n, got; chan c[2], d;
        process P() {
            init location A { to choice { guard n == 0; assign n = 1; } }
            branchpoint choice { to A { select i : int[0,1]; sync c[i]!i + 5; assign n = 2; } to A { sync d?; } to A; }
        }
        process R() { init location s { to s { sync c[0]?got; } to s { sync c[1]?got; } to s { sync d!; } } }
        system P, R;"""
    passing, receiving, silent = process(load(text)).edges
    assert passing.synchronisation.direction is Direction.SEND
    assert [u.span.text for u in passing.updates] == ["c[i]!i + 5", "n = 1", "n = 2"]
    assert receiving.synchronisation.direction is Direction.RECEIVE
    assert silent.synchronisation is None
    assert all(edge.guard.span.text == "n == 0" for edge in (passing, receiving, silent))


def test_edges_to_a_branchpoint_without_branches_are_never_taken(load: Any, tmp_path: Path) -> None:
    text = """
        clock x; urgent chan hurry; broadcast chan b; int heard;
        process P() {
            init location A { to dead { sync hurry!; } to dead { assign heard = 9; } to B { guard x >= 3; sync b!; } }
            location B { to dead; }
            branchpoint dead { }
        }
        process R() {
            branchpoint nowhere { }
            init location s { to s { sync hurry?; } to nowhere { sync b?; assign heard = 1; } }
        }
        system P, R;"""
    model = load(text)
    assert [(warning.code, warning.span.text) for warning in model.warnings if warning.code == "W0412"] == [
        ("W0412", "dead"),
        ("W0412", "nowhere"),
    ]
    assert [len(process.edges) for process in model.network.processes] == [1, 1]
    model = tachk.loads(text)
    reports = [model.verify(query) for query in ("E<> P.B && x > 5", "E<> heard > 0", "A[] deadlock imply P.B")]
    assert [report[0].answer.value for report in reports] == ["holds", "fails", "holds"]
    assert tachk.simulate(model, until=20)[0]["P"][-1] == "B"
    xml = tmp_path / "m.xml"
    xml.write_text(tachk.export(model, "xml"), "utf-8")
    assert tachk.diff(model, xml) == ""


def test_values_are_passed_through_a_hidden_meta_variable(load: Any) -> None:
    text = """
        typedef struct { int a; bool b; } msg_t;
        msg_t m = {7, true};
        int got, seen;
        chan c[2], d;
        process S() { state s; init s; trans s -> s { sync c[1]!3 + 4; assign got = 1; }, s -> s { sync d!m; }; }
        process R() { msg_t q; state s; init s;
            trans s -> s { sync c[1]?got; assign seen = got; }, s -> s { sync d?q; }; }
        system S, R;"""
    model = load(text)
    hidden = {v.name: v for v in model.network.variables if v.name.endswith("_value")}
    assert list(hidden) == ["c_value", "d_value"]
    assert hidden["c_value"].type == ArrayType(IntType(), IntType(0, 1))
    assert isinstance(hidden["d_value"].type, RecordType)
    assert all(v.declared_meta for v in hidden.values())
    layout = variable_layout(model.network)
    env = Environment(layout, list(layout.initial))
    sender, receiver = model.network.processes
    for number in (0, 1):
        execute(sender.edges[number].updates, env)
        execute(receiver.edges[number].updates, env)
    values = dict(zip(layout.names, env.values, strict=True))
    assert (values["got"], values["seen"], values["R.q.a"], values["R.q.b"]) == (7, 7, 7, 1)


def test_the_hidden_variable_takes_a_name_that_is_free(load: Any) -> None:
    text = """int c_value, c_value_1, got;
        chan c;
        process S() { state s; init s; trans s -> s { sync c!3; }; }
        process R() { state s; init s; trans s -> s { sync c?got; }; }
        system S, R;"""
    network = load(text).network
    (hidden,) = (variable for variable in network.variables if variable.carries is not None)
    assert (hidden.name, hidden.carries and hidden.carries.name) == ("c_value_2", "c")


def test_a_receiver_may_ignore_the_value(load: Any) -> None:
    assert (
        load("chan c; process P() { state s; init s; trans s -> s { sync c!1; }, s -> s { sync c?; }; }").warnings == ()
    )


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("process P() { state s, s; init s; }", [("E0202", "s")]),
        ("process P() { int s; state s; init s; }", [("E0202", "s")]),
        ("int s; process P() { state s; init s; }", []),
        ("process P(int[0,1] i) { int i; state s; init s; }", [("E0202", "i")]),
        ("process P() { state s; }", [("E0403", "P")]),
        ("process P() { init location a { to b; } init location b; }", [("E0403", "b")]),
        ("process P() { state idle; init idle; trans idel -> idle { }; }", [("E0209", "idel")]),
        ("chan c; process P() { state s; init s; trans s -> s { sync c; }; }", [("E0750", "c")]),
        ("chan c[2]; process P() { state s; init s; trans s -> s { sync c!; }; }", [("E0401", "c")]),
        (
            "broadcast chan c[2]; int n; process P() { state s; init s; trans s -> s { sync c[n++]!; }; }",
            [("E0313", "n++")],
        ),
        ("int s; process P() { state a; init a; trans a -> a { guard a; }; }", [("E0203", "a")]),
        ("process P() { state s; init s; trans s -> s { select i : int; }; }", [("E0316", "int")]),
        ("process P() { state s; init s; trans s -> s { select i : int[0,1]; assign i = 0; }; }", [("E0303", "i")]),
        ("process P() { state s; branchpoint b; init s; trans s -> b { }; }", [("W0412", "b")]),
        ("process P() { state s; branchpoint b, d; init s; trans s -> b { }, b -> d { }, d -> s { }; }", None),
        (
            "process P() { state s; branchpoint b; init s; trans s -> b { }, b -> s { select i : int; }; }",
            [("E0316", "int")],
        ),
        ("broadcast chan c; int a[2]; process P() { state s; init s; trans s -> s { sync c!a; }; }", [("E0402", "a")]),
        (
            (
                "chan c; struct { int a; } r; "
                "process P() { state s; init s; trans s -> s { sync c!1; }, s -> s { sync c?r; }; }"
            ),
            [("E0402", "r")],
        ),
        (
            "chan c; process P() { state s; init s; trans s -> s { sync c!1; }, s -> s { sync c?2; }; }",
            [("E0303", "2")],
        ),
        ("process P() { chan priority default; state s; init s; }", [("E0405", "chan priority default;")]),
        ("process P() { signal a = 1; init location s; }", [("E0502", "a")]),
        (
            (
                "urgent chan c; clock x; process P() { state s; init s; "
                "trans s -> s { guard x > 1; sync c!; }, s -> s { sync c?; }; }"
            ),
            [("W0403", "x > 1")],
        ),
        (
            (
                "broadcast chan c; clock x; process P() { state s; init s; "
                "trans s -> s { guard x > 1; sync c?; }, s -> s { sync c!; }; }"
            ),
            [],
        ),
        ("broadcast chan c; process P() { state s; init s; trans s -> s { sync c?; }; }", [("W0401", "c?")]),
        ("chan c[2]; process P() { state s; init s; trans s -> s { sync c[1]!; }; }", [("W0402", "c[1]!")]),
        *(
            (
                (
                    f"{declared} chan c; "
                    f"process P() {{ int n; state s; init s; trans s -> s {{ guard {guard}; {sync}; }}; }}"
                ),
                found,
            )
            for declared, guard, sync, found in [
                ("const bool ON = false;", "ON && n > 1", "sync c!", []),
                ("const bool ON = false;", "n > 1 && ON", "sync c!", []),
                ("const bool ON = false;", "ON", "sync c?", []),
                ("const int LAW = 0;", "n == 0 && (LAW == 1 || LAW == 2)", "sync c!", []),
                ("const bool ON = true;", "ON", "sync c!", [("W0402", "c!")]),
                ("const bool ON = false;", "false && n > 1", "sync c!", [("W0402", "c!")]),
                ("const int MOST = 3;", "n < MOST && 1 > 2", "sync c!", [("W0402", "c!")]),
                ("const int MOST = 3;", "false && n < MOST", "sync c?", [("W0401", "c?")]),
            ]
        ),
        ("process P() { state a, b; branchpoint p; init a; trans a -> p { }, p -> b { }; }", []),
    ],
)
def test_findings(find: Any, text: str, expected: list[tuple[str, str]] | None) -> None:
    found = find(text)
    if expected is None:
        assert {code for code, _ in found} == {"E0404"}
    else:
        assert found == expected


def test_a_finding_in_a_template_is_reported_once_for_all_instances(find: Any) -> None:
    assert find("process P(int[0,9] i) { state s; init s; trans s -> s { guard j > i; }; }") == [("E0201", "j")]


def test_templates_that_nothing_uses_are_checked_as_well(find: Any) -> None:
    unused = "process Q(int n, chan &c) { int a[n]; state s; init s; trans s -> s { guard a[0] > k; sync c!; }; }"
    assert find(unused + "\nprocess P() { state s; init s; }") == [("E0201", "k")]
    assert find(unused.replace("> k", "> n") + "\nprocess P() { state s; init s; }") == []


def test_a_template_of_many_locations(load: Any) -> None:
    names = [f"s{i}" for i in range(500)]
    edges = ", ".join(f"{a} -> {b} {{ guard x > 1; }}" for a, b in pairwise(names))
    model = load(f"clock x; process P() {{ state {', '.join(names)}; init s0; trans {edges}; }}")
    assert (len(process(model).locations), len(process(model).edges)) == (500, 499)


def test_a_template_without_locations_does_nothing(load: Any) -> None:
    model = load("process P() { int n = 3; }\nsystem P;\nproperty p : A[] P.n == 3;")
    assert [warning.code for warning in model.warnings] == ["W0410"]
    assert len(process(model).locations) == 1
    assert process(model).edges == ()
    assert [query.name for query in model.queries] == ["p"]
