"""Parameters, instantiation, the system line, process priorities."""

from __future__ import annotations

from typing import Any

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError
from tachk.model.expressions import Constant, Index, Reference

TEMPLATE = """
process T(const int n, int[0,3] k, bool b, chan &c, clock &x, const int &limit, int &out[2]) {
    int v = n + k;
    state s { x <= limit };
    init s;
    trans s -> s { guard b && x > k; sync c!; assign out[k] = n; };
}
"""
GLOBALS = "const int L = 9; int lim, o[2][2]; broadcast chan c[2]; clock x[2];"


def names(model: Any) -> list[str]:
    return [p.name for p in model.network.processes]


def test_parameters_are_replaced_by_their_arguments(load: Any) -> None:
    model = load(GLOBALS + TEMPLATE + "P = T(3, 1, true, c[1], x[0], lim, o[1]);\nsystem P;")
    (process,) = model.network.processes
    (edge,) = process.edges
    assert (process.name, process.template) == ("P", "T")
    assert process.variables[0].initial == (4,)
    assert isinstance(edge.synchronisation.channel, Index)
    assert edge.synchronisation.channel.index == Constant(1)
    assert edge.updates[0].value.value == 3
    assert edge.updates[0].target.base.base.variable.name == "o"
    assert process.locations[0].invariant.right == Reference(model.network.variables[0])


def test_plain_integer_parameters_are_as_wide_as_constants(load: Any) -> None:
    text = """
        process T(const int n, int a[2]) { clock x; state s { x <= n + a[1] }; init s; }
        const int A[2] = {0, 50000};
        P = T(240000, A);
        system P;
    """
    (process,) = load(text).network.processes
    assert process.locations[0].invariant.right.value == 290000


def test_constant_reference_takes_a_value(load: Any) -> None:
    model = load(GLOBALS + TEMPLATE + "P = T(3, 1, true, c[1], x[0], L + 1, o[1]);\nsystem P;")
    assert model.network.processes[0].locations[0].invariant.right.value == 10


def test_array_and_struct_parameters(load: Any) -> None:
    text = """
        typedef struct { int a[2]; } r_t;
        const r_t K = {{4, 5}};
        const int A[2] = {6, 7};
        process T(const r_t r, int a[2]) { int v = r.a[1] + a[0]; state s; init s; }
        P = T(K, A);
        system P;"""
    (process,) = load(text).network.processes
    assert process.variables[-1].initial == (11,)


@pytest.mark.parametrize(
    ("parameters", "expected"),
    [
        ("int[1,3] i", ["T(1)", "T(2)", "T(3)"]),
        ("const int[1,2] i, id_t j", ["T(1,0)", "T(1,1)", "T(2,0)", "T(2,1)"]),
        ("const sym_t q", ["T(0)", "T(1)"]),
        ("int[0,1] i, int[0,i] j", ["T(0,0)", "T(1,0)", "T(1,1)"]),
    ],
)
def test_free_parameters(load: Any, parameters: str, expected: list[str]) -> None:
    text = f"typedef int[0,1] id_t; typedef scalar[2] sym_t; process T({parameters}) {{ state s; init s; }}\nsystem T;"
    assert names(load(text)) == expected


@pytest.mark.parametrize("parameters", ["int i", "bool b", "const int i", "int[0,1] &i", "chan &c", "int a[2]"])
def test_parameters_that_cannot_stay_free(find: Any, parameters: str) -> None:
    assert find(f"process T({parameters}) {{ state s; init s; }}\nsystem T;") == [("E0413", "T")]


def test_partial_instantiation(load: Any) -> None:
    text = """
        process T(int[0,3] i, int n, int m) { int v = 100 * i + 10 * n + m; state s; init s; }
        Q(const int[0,1] k) = T(k + 1, 5, k);
        R(int n) = Q(n);
        S = R(1);
        system Q, S;"""
    model = load(text)
    assert names(model) == ["Q(0)", "Q(1)", "S"]
    assert [p.variables[0].initial for p in model.network.processes] == [(150,), (251,), (251,)]
    assert [p.variables[0].name for p in model.network.processes] == ["Q(0).v", "Q(1).v", "S.v"]


def test_references_through_partial_instantiation(load: Any) -> None:
    text = """
        broadcast chan a, b;
        process T(chan &c, chan &d) { state s; init s; trans s -> s { sync c!; }, s -> s { sync d!; }; }
        Q(chan &e) = T(e, b);
        P = Q(a);
        system P;"""
    (process,) = load(text).network.processes
    assert [e.synchronisation.channel.variable.name for e in process.edges] == ["a", "b"]


def test_process_priorities_and_order(load: Any) -> None:
    declarations = "process A() { state s; init s; } process B(int[0,1] i) { state s; init s; } C = A();"
    model = load(f"{declarations}\nsystem A < C, B;")
    assert [(p.name, p.priority) for p in model.network.processes] == [("A", 0), ("C", 1), ("B(0)", 1), ("B(1)", 1)]


def test_local_functions_are_one_object_per_process(load: Any) -> None:
    body = "int v; int f() { return v; } state s; init s; trans s -> s { assign v = f(); };"
    model = load(f"process T(int[0,1] i) {{ {body} }}\nsystem T;")
    first, second = (p.edges[0].updates[0].value.function for p in model.network.processes)
    assert first is not second


@pytest.mark.parametrize(
    ("system", "expected"),
    [
        ("P = T(1);\nsystem P, P;", [("E0414", "P")]),
        ("P = U(1);\nsystem P;", [("E0206", "U")]),
        ("system U;", [("E0206", "U")]),
        ("system n;", [("E0206", "n")]),
        ("P = T();\nsystem P;", [("E0412", "P = T();")]),
        ("P = T(1, 2);\nsystem P;", [("E0412", "P = T(1, 2);")]),
        ("P = T(n);\nsystem P;", [("E0601", "n")]),
        ("P = T(7);\nsystem P;", [("E0603", "7")]),
        ("P = T(x);\nsystem P;", [("E0309", "x")]),
        ("P = R(3);\nsystem P;", [("E0317", "3")]),
        ("P = R(x);\nsystem P;", [("E0309", "x")]),
        ("P = R(K);\nsystem P;", [("E0317", "K")]),
        ("P = R(a[n]);\nsystem P;", [("E0601", "n")]),
        ("P = R(a[K]);\nsystem P;", []),
        ("P = C(x);\nsystem P;", [("E0315", "clock c")]),
        ("T = R(n);\nsystem T;", [("E0202", "T")]),
        ("system T;\nsystem T;", [("E0411", "system T;")]),
        ("P = T(7);\nsystem T;", [("E0603", "7")]),
    ],
)
def test_findings(find: Any, system: str, expected: list[tuple[str, str]]) -> None:
    templates = """
        const int K = 1; int n, a[2]; clock x;
        process T(int[0,3] i) { state s; init s; }
        process R(int &r) { state s; init s; trans s -> s { assign r = 1; }; }
        process C(clock c) { state s; init s; }
    """
    if "C(x)" not in system:
        templates = templates[: templates.index("process C")]
    assert find(f"{templates}\n{system}") == expected


@pytest.mark.parametrize("system", ["system T;", "A = T(1); B = T(2);\nsystem A, B;"])
def test_a_value_parameter_that_is_assigned_is_a_variable_of_the_process(load: Any, system: str) -> None:
    text = "process T(int[1,2] i) { state s; init s; trans s -> s { assign i = 1; }; }\n" + system
    network = load(text).network
    assert [[(v.name.rpartition(".")[2], v.initial) for v in p.variables] for p in network.processes] == [
        [("i", (1,))],
        [("i", (2,))],
    ]
    assert len({process.edges[0].updates for process in network.processes}) == 2


def test_assigning_to_a_constant_parameter_is_rejected(find: Any) -> None:
    text = "process T(const int[0,3] i) { state s; init s; trans s -> s { assign i = 0; }; }\nsystem T;"
    assert find(text) == [("E0303", "i")]


def test_a_name_of_a_function_is_not_the_parameter(load: Any) -> None:
    text = "process T(int[1,2] i) { int a[i]; void f(int i) { i = 0; } state s; init s; }\nsystem T;"
    assert [v.name.rpartition(".")[2] for v in load(text).network.processes[1].variables] == ["a"]


@pytest.mark.parametrize(
    ("text", "help"),
    [
        ("process T(int[0,3] a, int b) { state s; init s; }\nQ = T(1);\nsystem Q;", "add a value for `int b`"),
        ("process T(int a) { state s; init s; }\nQ = T(1, 2);\nsystem Q;", "remove 1 argument"),
        ("int f(int a, int b) { return a; }\nint g() { return f(); }", "add a value for `a`, `b`"),
        ("int f() { return 1; }\nint g() { return f(1, 2); }", "remove 2 arguments"),
    ],
)
def test_what_is_missing_is_named(load: Any, text: str, help: str) -> None:
    with pytest.raises(InputError) as caught:
        load(text)
    assert [found.help for found in caught.value.diagnostics] == [help]


OWN_CLOCKS = """
clock g;
int n;
process P(clock x, const int k) {
    state A { x <= 5 }, B;
    init A;
    trans A -> B { guard x >= k; assign x = 0, n = n + 1; };
}
Q(const int[3,4] k) = P(k - 2, k);
p = P(2, 3);
system p, Q;
"""


def test_a_clock_passed_by_value_is_a_clock_of_the_process_that_begins_with_the_argument() -> None:
    model = tachk.loads(OWN_CLOCKS)
    assert [[(v.name, v.initial) for v in process.variables] for process in model.network.processes] == [
        [("p.x", (2,))],
        [("Q(3).x", (1,))],
        [("Q(4).x", (2,))],
    ]
    answers = {
        "E<> p.B && g == 1": "holds",
        "E<> p.B && g < 1": "fails",
        "A[] n == 0 imply g <= 3": "holds",
        "E<> Q(3).B && Q(4).B && Q(4).x > p.x && Q(3).x > Q(4).x": "holds",
        "A[] g - p.x <= 3": "holds",
        "E<> g - p.x == 3": "holds",
    }
    for query, answer in answers.items():
        assert model.verify(query)[0].answer.value == answer, query


@pytest.mark.parametrize(
    ("text", "code", "named"),
    [
        ("clock g;\nprocess P(clock x) { state s; init s; }\np = P(g);\nsystem p;", "E0315", "clock x"),
        ("process P(clock x) { state s; init s; }\np = P(-1);\nsystem p;", "E0603", "-1"),
        ("process P(clock x) { state s; init s; }\np = P(true);\nsystem p;", "E0302", "true"),
        ("int n;\nprocess P(clock x) { state s; init s; }\np = P(n);\nsystem p;", "E0601", "n"),
        ("process P(clock x) { state s; init s; trans s -> s { assign x = 0; }; }\nsystem P;", "E0413", "P"),
    ],
)
def test_what_a_clock_passed_by_value_cannot_begin_with(load: Any, text: str, code: str, named: str) -> None:
    with pytest.raises(InputError) as caught:
        load(text)
    assert [(found.code, found.span.text) for found in caught.value.diagnostics] == [(code, named)]
