"""What a version of UPPAAL would refuse or treat otherwise."""

from __future__ import annotations

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import Severity, UnsupportedError
from tachk.base.diagnostics.explanation import explanations
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.formats.plain.expansion import expand
from tachk.formats.uppaal.export import print_xta
from tachk.formats.uppaal.portability import portability
from tachk.formats.uppaal.versions import UppaalVersion

PLAIN = "process P() { state a; init a; }\nsystem P;"


def found(text: str, version: UppaalVersion = UppaalVersion.UPPAAL_5_0) -> list[tuple[str, str]]:
    model = load_model(Source("model.ta", text))
    return [(d.code, d.span.text) for d in portability(model, version)]


def process(inside: str, declarations: str = "") -> str:
    return f"{declarations} process P() {{ {inside} }} system P;"


def test_plain_xta_has_no_findings() -> None:
    assert found(PLAIN) == []
    assert found(PLAIN, UppaalVersion.UPPAAL_4_1) == []


def test_additions_of_tachk() -> None:
    text = "time_unit = 1 s;\nprocess P() { init location a; }\nsignal s = P.a;\nsystem P;\nproperty p : E<> s;"
    assert found(text) == [("E0810", "time_unit = 1 s;"), ("E0810", "a"), ("E0810", "s"), ("E0810", "p")]


@pytest.mark.parametrize(
    ("text", "place"),
    [
        (process("state exit; init exit;"), "exit"),
        (process("state a; init a;", "int random;"), "random"),
        (process("state a; init a;", "typedef int[0,3] int16_t;"), "int16_t"),
        (process("state a; init a;", "const int M_PI = 3;"), "M_PI"),
    ],
)
def test_names_that_version_5_took(text: str, place: str) -> None:
    assert found(text) == [("E0811", place)]
    assert found(text, UppaalVersion.UPPAAL_4_1) == []


def test_names_that_cannot_be_requested() -> None:
    text = process("state X; init X;")
    assert found(text) == []
    assert ("E0811", "X") in found(text + "\nproperty p : E<> P.X;")


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        (process("state a; init a;", "int8_t n;"), "E0812", "int8_t"),
        (process("state a; init a;", "const int N = INT16_MAX;"), "E0812", "INT16_MAX"),
        (process("state a; init a;", "const bool b = true xor false;"), "E0813", "true xor false"),
        (process("state a; init a;", "const int n = 2 ** 3;"), "E0813", "2 ** 3"),
        (process("state a; init a;", "void f() { assert true; }"), "E0813", "assert true;"),
    ],
)
def test_what_4_1_does_not_know(text: str, code: str, place: str) -> None:
    assert found(text, UppaalVersion.UPPAAL_4_1) == [(code, place)]
    assert found(text) == []


def test_order_of_prefixes() -> None:
    assert found(process("state a; init a;", "broadcast urgent chan c;")) == [("E0814", "broadcast urgent chan")]


def test_types_used_as_names() -> None:
    text = process("state slot, b; init slot;", "typedef int[0, 3] slot;")
    assert found(text) == [("E0816", "slot")]


DEADLOCK = "\nproperty p : A[] not deadlock;"


def test_deadlock_where_uppaal_does_not_check_it() -> None:
    text = process("state a; init a;", "chan c; chan priority c < default;") + DEADLOCK
    assert ("E0815", "deadlock") in found(text)
    text = process(
        "clock x; state a; init a; trans a -> a { sync c!; }, a -> a { guard x > 1; sync c?; };", "broadcast chan c;"
    )
    assert ("E0815", "deadlock") in found(text + DEADLOCK)
    assert ("E0815", "deadlock") not in found(process("state a; init a;") + DEADLOCK)
    assert ("E0815", "deadlock") in found(process("state a; init a;") + "\nproperty p : A<> deadlock;")


@pytest.mark.parametrize(
    ("inside", "place"),
    [
        ("clock x; state a { x' == 0 }; init a;", "0"),
        ("clock x; state a { x < 3 }; init a;", "x < 3"),
        ("clock x; state a, b { x >= 3 }; init a; trans a -> b { guard x > 4; };", "x >= 3"),
        ("clock x, y; state a; init a; trans a -> a { assign x = y + 1; };", "x = y + 1"),
    ],
)
def test_what_is_treated_otherwise(inside: str, place: str) -> None:
    assert [(code, text) for code, text in found(process(inside)) if text == place] == [("W0501", place)]


def test_meta_variables_mean_the_same_everywhere() -> None:
    text = (
        "meta int[0, 3] m; int[0, 3] n; state a, b; init a; trans a -> b { assign m = 2; }, b -> a { assign n = m; };"
    )
    assert found(process(text)) == []


def test_the_exported_model_has_no_errors() -> None:
    text = """\
time_unit = 1 s;
broadcast urgent chan c;
int8_t exit;
process query(const int[0, 1] i) { init location IO { to IO { sync c!i; } to IO { sync c?exit; } } }
system query;
"""
    written = print_xta(expand(load_model(Source("model.ta", text))))
    for version in UppaalVersion:
        model = load_model(Source("model.xta", written))
        assert [d for d in portability(model, version) if d.code.startswith("E")] == []


FORMS = """\
string s = "a", t;
const string c = "b";
int f() { while (true) {} }
int first(int[0, 3] n) { for (i : int[0, 3]) { return i; } }
bool early(int n) { return n > 1; n++; }
int both(int n) { if (n > 1) return 1; else do { return 2; } while (n > 0); }
void g(int n) { if (n > 1) return; }
struct_t h() { struct_t unreached; while (1) return unreached; }
process P() { state a, b; commit a; urgent a, b; init b; trans b -> a { guard first(2) == 0; }; }
system P;
""".replace("struct_t h", "typedef struct { int x; } struct_t;\nstruct_t h")


def test_the_form_of_functions_texts_and_locations() -> None:
    """UTAP 2.1.1 wants a return at the end, constant texts, and one word about a location."""
    codes = [(code, text) for code, text in found(FORMS) if code in ("E0824", "E0825", "E0826")]
    functions = [("E0824", name) for name in ("f", "first", "early", "h")]
    assert codes == [("E0825", "string"), *functions, ("E0826", "a")]
    plain = expand(load_model(Source("model.ta", FORMS)))
    assert [step.kind for step in plain.steps] == ["text", "return", "return", "return", "return"]
    written = print_xta(plain)
    assert 'const string s = "a", t = "";' in written
    assert found(written) == []
    assert "        int unreached_1;" in written  # another name than that of the struct's


def test_the_written_return_changes_no_answer() -> None:
    written = print_xta(expand(load_model(Source("model.ta", FORMS))))
    for query in ("E<> P.a", "E<> both(2) == 2", "E<> h().x == 1"):
        first, again = (tachk.loads(each).verify(query)[0] for each in (FORMS, written))
        assert first.answer == again.answer


@pytest.mark.parametrize(
    "text",
    [
        'string s = "a"; process P() { state a; init a; trans a -> a { assign s = "b"; }; } system P;',
        'string s[2] = {"a", "b"}; process P() { state a; init a; } system P;',
        "struct { string s; } r; process P() { state a; init a; } system P;",
    ],
)
def test_a_text_that_cannot_be_constant_is_not_exported(text: str) -> None:
    with pytest.raises(UnsupportedError, match="texts as constants only"):
        expand(load_model(Source("model.ta", text)))


EXPLAINED = {
    code: explanation
    for code, explanation in explanations("other_tools").items()
    if (code.startswith("E081") or "E0822" <= code <= "E0826") and explanation.bad
}


@pytest.mark.parametrize("code", EXPLAINED)
def test_examples_of_the_explanations(code: str) -> None:
    for text, expected in ((EXPLAINED[code].bad, True), (EXPLAINED[code].good, False)):
        declared = text if "process" in text else f"{text} process P() {{ state a; init a; }}"
        source = text if "system" in text else f"{declared} system P;"
        assert (code in [found_code for found_code, _ in found(source, UppaalVersion.UPPAAL_4_1)]) == (
            expected and code != "E0811"
        )
        assert code != "E0811" or (code in [found_code for found_code, _ in found(source)]) == expected


@pytest.mark.parametrize(
    ("text", "places"),
    [
        ("P(int[1, 2] i) := T(i); process T(int[1, 2] i) { state a; init a; } system P;", ["i"]),
        ("P(const int[1, 2] i) := T(i); process T(const int[1, 2] i) { state a; init a; } system P;", []),
        ("const int x = 2; S = R(x); process R(const int &i) { int k = i; state a; init a; } system S;", ["i"]),
        ("process R(int[0, 1] i) { int[0, 3] a[2] = {i, 1}; state s; init s; } system R;", ["i"]),
        ("process R(const int[0, 1] i) { int k = i; state s; init s; } system R;", []),
        ("process R(int[0, 1] i, int[0, 1] &n) { state s; init s; trans s -> s { assign n = i; }; } system R;", None),
    ],
)
def test_values_that_uppaal_wants_to_know(text: str, places: list[str] | None) -> None:
    """The first and the third are err-01, err-02 and tmpl-binding-03 of the tests of uppaal-to-tchecker."""
    if places is None:
        text = text.replace("system R;", "int[0, 1] m; S = R(0, m); system S;")
    for version in UppaalVersion:
        assert found(text, version) == [("E0817", place) for place in places or []]


@pytest.mark.parametrize(
    ("text", "places"),
    [
        ("process P() { state a; init a; } system P; const int N = 3; progress { 1; }", ["const int N = 3;"]),
        ("process P() { state a; init a; } system P; gantt { G : 1 -> 2; } progress { 1; }", ["progress { 1; }"]),
        ("system P; process P() { state a; init a; }", ["process P() { state a; init a; }"]),
        ("process P() { state a; init a; } system P; progress { 1; } gantt { G : 1 -> 2; }", []),
    ],
)
def test_order_of_sections(text: str, places: list[str]) -> None:
    for version in UppaalVersion:
        assert found(text, version) == [("E0822", place) for place in places]


def test_what_the_export_does_with_an_addition() -> None:
    model = load_model(Source("model.ta", f"{PLAIN}\nproperty p : E<> P.a;"))
    assert [d.help for d in portability(model, UppaalVersion.UPPAAL_5_0)] == [
        "`tachk convert` writes it as a query, its name and expectation beside it"
    ]


def test_equalities_in_invariants() -> None:
    text = process("clock x[2]; int n; state a { x[0] == 0 && n == 0 }, b { x[1] <= 0 }; init a;")
    for version in UppaalVersion:
        assert found(text, version) == [("E0818", "x[0] == 0")]


def test_names_that_were_put_right() -> None:
    names = "".join(
        f'<location id="l{i}"><name>{name}</name></location>' for i, name in enumerate(("A", "A", "B-1", "C"))
    )
    text = f'<nta><template><name>P</name>{names}<init ref="l0"/></template><system>system P;</system></nta>'
    findings = portability(load_model(Source("m.xml", text)), UppaalVersion.UPPAAL_5_0)
    assert [(d.code, d.message.split("`")[1]) for d in findings] == [("E0819", "A"), ("E0819", "B-1")]


def test_floating_point_numbers_outside_functions() -> None:
    function = "int n; bool low(int k) { double d = k; return d / 2 < 1.5; }\n"
    inside = function + process("state a; init a; trans a -> a { guard low(n); };") + "property p : A[] low(n);"
    assert not {"E0815", "W0501"} & {code for code, _ in found(inside)}
    guard = function + process("state a; init a; trans a -> a { guard n < 1.5; };")
    assert ("W0501", "n") in found(guard)
    query = function + process("state a; init a;") + "property p : A[] n < 1.5;"
    assert ("E0815", "n") in found(query)


STRUCTS = {
    "struct { double d; int n; } r;": [("W0406", "d")],
    "struct { const int n; double d; } r;": [("E0827", "const int"), ("W0406", "d")],
    "typedef struct { const double d; } R; R r; const R c = {0.5};": [("E0827", "const double"), ("W0406", "r")],
    "int f() { struct { string s; double d; } r; return 1; }": [("E0825", "string")],
    "int f() { struct { double d; const string s; } r; return 1; }": [("E0825", "const string")],
    "int f() { struct { struct { double d; string s; } a[2]; } r; return 1; }": [("E0825", "string")],
    "void g(struct { double d; string s; } r) {}": [("E0825", "string")],
    "typedef struct { double d; } R; int f(R r) { string t; return 1; }": [("E0825", "string")],
}


@pytest.mark.parametrize("text", STRUCTS)
def test_structs_with_texts_doubles_and_constants(text: str) -> None:
    """Texts in structs outside of functions refuse the model, so that UPPAAL's rules do not matter."""
    codes = ("E0825", "E0827", "W0406")
    model = load_model(Source("model.ta", f"{text} {process('state a; init a;')}"))
    findings = (*portability(model, UppaalVersion.UPPAAL_5_0), *model.warnings)
    assert sorted((d.code, d.span.text) for d in findings if d.code in codes) == sorted(STRUCTS[text])
    if "string s" in text:
        with pytest.raises(UnsupportedError, match="texts as constants only"):
            expand(model)
    else:
        written = print_xta(expand(model))
        assert "E0827" not in {
            d.code for d in portability(load_model(Source("m.xta", written)), UppaalVersion.UPPAAL_5_0)
        }


@pytest.mark.parametrize(
    "text",
    [
        "struct { string s; double d; } r;",
        'const struct { string s; double d; } r = {"a", 0.5};',
        "typedef struct { double d; string s; } R;",
        "typedef struct { double d; const string s; } R; R r;",
        "typedef string T;",
    ],
)
def test_texts_in_structs_reject_the_model_before_its_portability_is_checked(text: str) -> None:
    model = load_model(Source("model.ta", f"{text} {process('state a; init a;')}"))
    assert [d.code for d in model.refusals if d.severity is Severity.ERROR] == ["E0750"]
