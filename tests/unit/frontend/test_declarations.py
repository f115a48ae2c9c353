"""Variables, constants, types and their initial values."""

from __future__ import annotations

from typing import Any

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.model.types import ArrayType, BoolType, ChannelType, ClockType, IntType, RecordType, ScalarType
from tachk.model.variable_layout import variable_layout


def variables(model: Any) -> dict[str, Any]:
    return {v.name: v for v in model.network.all_variables()}


@pytest.mark.parametrize(
    ("text", "type_", "slots"),
    [
        ("int v;", IntType(-32768, 32767), (0,)),
        ("int[2,5] v;", IntType(2, 5), (2,)),
        ("int[-3,-1] v = -2;", IntType(-3, -1), (-2,)),
        ("bool v = true;", BoolType(), (1,)),
        ("bool v = 5;", BoolType(), (1,)),
        ("clock v;", ClockType(), (0,)),
        ("clock v = 0;", ClockType(), (0,)),
        ("clock v[2];", ArrayType(ClockType(), IntType(0, 1)), (0, 0)),
        ("chan v;", ChannelType(), (0,)),
        ("urgent broadcast chan v;", ChannelType(True, True), (0,)),
        ("broadcast chan v[2];", ArrayType(ChannelType(True), IntType(0, 1)), (0, 0)),
        ("int v[2][3] = {{1, 2, 3}, {4, 5, 6}};", None, (1, 2, 3, 4, 5, 6)),
        ("typedef int[1,3] t; bool v[t];", ArrayType(BoolType(), IntType(1, 3)), (0, 0, 0)),
        ("int v[int[2,4]] = {7, 8, 9};", None, (7, 8, 9)),
        ("struct { int a; bool b; } v = {b: true, a: 3};", None, (3, 1)),
        ("struct { int a[2]; clock c; } v = {{1, 2}, 0};", None, (1, 2, 0)),
        ("typedef struct { int a; } t; const t K = {4}; t v = K;", RecordType("t", (("a", IntType()),)), (4,)),
        ("typedef scalar[3] t; t v;", ScalarType("t", 3), (0,)),
        ("typedef int row[2]; row v[2] = {{1, 2}, {3, 4}};", None, (1, 2, 3, 4)),
        ("const int n = 2; int v = (n + 3) * 2 ** n - n % 2;", IntType(), (20,)),
        ("int twice(int n) { return 2 * n; } const int four = twice(2); int v = four;", IntType(), (4,)),
        ("const int a[3] = {1, 2, 3}; int v = sum(i : int[0,2]) a[i];", IntType(), (6,)),
        ("uint8_t v = 255;", IntType(0, 255), (255,)),
        ("int v = INT8_MIN;", IntType(), (-128,)),
    ],
)
def test_variables(load: Any, text: str, type_: Any, slots: tuple[int, ...]) -> None:
    variable = variables(load(text))["v"]
    assert variable.initial == slots
    if type_ is not None:
        assert variable.type == type_


def test_index_range_of_an_array_sized_by_a_type(load: Any) -> None:
    names = variable_layout(load("int a[int[2,3]];").network).names
    assert names == ("a[2]", "a[3]")


def test_constants_may_use_32_bits_and_are_listed(load: Any) -> None:
    assert load("const int N = 100000; const bool B = true;").network.constants == (("N", 100000), ("B", 1))


def test_constant_of_3x_has_no_type(load: Any) -> None:
    model = load("const N 5;\nint[0,N] v;")
    assert variables(model)["v"].type == IntType(0, 5)
    assert [w.code for w in model.warnings] == ["W0101"]


def test_names_of_uppaal_5_may_be_declared(load: Any) -> None:
    assert variables(load("typedef int[0,1] int8_t; int8_t v; const int INT8_MAX = 3;"))["v"].type == IntType(0, 1)


def test_meta_variables(load: Any) -> None:
    assert variables(load("meta int v = 3; int w;"))["v"].declared_meta
    assert not variables(load("meta int v = 3; int w;"))["w"].declared_meta


def test_array_constants_are_variables_that_fold(load: Any) -> None:
    model = load("const int a[2] = {5, 6}; int v = a[1];")
    assert variables(model)["v"].initial == (6,)
    assert variables(model)["a"].initial == (5, 6)


def test_local_variables_are_named_with_their_process(load: Any) -> None:
    model = load("process P() { int v; state s; init s; }\nQ = P(); R = P();\nsystem Q, R;")
    assert list(variables(model)) == ["Q.v", "R.v"]
    first, second = variables(model).values()
    assert first is not second


def test_channel_priorities(load: Any) -> None:
    model = load("chan a, b[2], c;\nchan priority a, b[1] < default < b[0];")
    assert model.network.default_priority == 1
    assert {n: v.priorities for n, v in variables(model).items()} == {"a": (0,), "b": (2, 0), "c": ()}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("int[0,3] v = 7;", [("E0603", "7")]),
        ("int v[2] = {1, 40000};", [("E0603", "{1, 40000}")]),
        ("int v = w;", [("E0201", "w")]),
        ("int w; int v = w;", [("E0601", "w")]),
        ("int a[3] = {1, 2, 3, 4};", [("E0318", "{1, 2, 3, 4}")]),
        ("struct { int a; } v = {b: 1};", [("E0205", "b")]),
        ("struct { int a, b; } v = {a: 1, a: 2};", [("E0318", "2")]),
        ("clock v = 3;", []),
        ("clock v[2] = {1, 2};", []),
        ("clock v = -1;", [("E0603", "-1")]),
        ("clock v = true;", [("E0302", "true")]),
        ("clock v = 2.5;", [("E0750", "2.5")]),
        ("int n; clock v = n;", [("E0601", "n")]),
        ("chan v = 0;", [("E0318", "0")]),
        ("urgent int v;", [("E0315", "urgent int")]),
        ("const clock v = 0;", [("E0315", "v = 0")]),
        ("meta clock v;", [("E0315", "v")]),
        ("void v;", [("E0315", "v")]),
        ("struct { chan a; } v;", [("E0315", "a")]),
        ("hybrid clock v;", [("W0406", "v")]),
        ("double v = 1.5;", [("W0406", "v")]),
        ("const int f = 1.5;", [("E0302", "1.5")]),
        ("int v[0];", [("E0604", "0")]),
        ("typedef scalar[0] t;", [("E0604", "scalar[0]")]),
        ("typedef int t; int v[t];", [("E0315", "t")]),
        ("chan a;\nchan priority a < b < default;", [("E0201", "b")]),
        ("int n; chan a;\nchan priority n < default;", [("E0405", "n")]),
        ("chan a;\nchan priority a < a < default;", [("E0405", "a")]),
        ("chan a;\nchan priority a < default; chan priority a < default;", [("E0405", "chan priority a < default;")]),
        ("int before;\nbefore_update { before = 1 }", [("E0750", "before_update { before = 1 }")]),
        ('import "lib.so" { int f(int x); };', [("W0407", None)]),
    ],
)
def test_findings(find: Any, text: str, expected: list[tuple[str, str | None]]) -> None:
    found = find(text)
    assert [code for code, _ in found] == [code for code, _ in expected]
    for (_, underlined), (_, wanted) in zip(found, expected, strict=True):
        assert wanted is None or underlined == wanted


def test_a_broken_declaration_has_no_follow_up_errors(find: Any) -> None:
    text = """
        const int N = M + 1;
        typedef int[0, N] id_t;
        id_t a[N], b = N;
        int f(id_t i) { return a[i] + N; }
        process P(id_t p) { int v = f(p); state s { v < N }; init s; trans s -> s { select i : id_t; assign b = i; }; }
    """
    assert find(text) == [("E0201", "M")]


def test_a_template_with_a_broken_parameter_has_no_follow_up_errors(find: Any) -> None:
    text = """
        process T(int[0, M] i) { init location a { to c; } location b; }
        system T;
        property p : E<> T(0).a && forall (i : int[0,1]) T(i).b;"""
    assert find(text) == [("E0201", "M"), ("E0209", "c")]


def test_all_findings_are_reported_at_once(find: Any) -> None:
    assert [code for code, _ in find("int a = b;\nint c[d];\nfoo e;\nint f() { g = h; return 0; }")] == [
        "E0201",
        "E0201",
        "E0204",
        "E0201",
        "E0201",
    ]


def test_a_misspelt_name_has_a_suggestion(load: Any) -> None:
    with pytest.raises(InputError) as caught:
        load("int heartbeat;\nint f() { return hearbeat; }")
    assert caught.value.diagnostics[0].help == "did you mean `heartbeat`?"


@pytest.mark.parametrize("text", ["int a = N;\nconst int N = 1;", "id_t a;\ntypedef int[0,1] id_t;"])
def test_a_declaration_that_comes_too_late(load: Any, text: str) -> None:
    with pytest.raises(InputError) as caught:
        load(text)
    assert "further down" in str(caught.value.diagnostics[0].help)


def test_an_endless_constant_computation_ends_in_a_finding(find: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tachk.model.evaluate.STEP_LIMIT", 1000)
    assert find("int f() { int i; while (true) { i = 0; } return 1; }\nconst int n = f();")[0][0] == "E0602"
