"""The language: what is read, and as what."""

from __future__ import annotations

from typing import Any

import pytest

from tachk.base.diagnostics.diagnostic import Severity
from tachk.base.operators import BinaryOperator
from tachk.base.span import NOWHERE, Source
from tachk.base.words import Direction, QueryKind
from tachk.syntax import ast
from tachk.syntax.parsing import parser
from tachk.syntax.parsing.contextual import SPELLING
from tachk.syntax.printing.expression_printer import print_expression


def document(text: str) -> ast.Document:
    result, diagnostics = parser.parse_document(Source("t.ta", text))
    assert diagnostics == ()
    assert result is not None
    return result


def expression(text: str) -> Any:
    result, diagnostics = parser.parse_expression(Source("e", text))
    assert diagnostics == ()
    return result


def template(body: str) -> ast.Template:
    (item,) = document(f"process P() {{ {body} }}").items
    assert isinstance(item, ast.Template)
    return item


def bracketed(node: Any) -> str:
    """An expression with every binary, unary and conditional operation in parentheses."""
    match node:
        case ast.BinaryExpression(operator=operator, left=left, right=right):
            return f"({bracketed(left)} {operator} {bracketed(right)})"
        case ast.UnaryExpression(operator=operator, operand=operand):
            return f"({operator}{bracketed(operand)})"
        case ast.AssignmentExpression(operator=operator, target=target, value=value):
            return f"({bracketed(target)} {operator or ''}= {bracketed(value)})"
        case ast.ConditionalExpression(condition=condition, then=then, otherwise=otherwise):
            return f"({bracketed(condition)} ? {bracketed(then)} : {bracketed(otherwise)})"
        case ast.QuantifierExpression(kind=kind, variable=variable, body=body):
            return f"({kind} {variable.name}. {bracketed(body)})"
        case _:
            return print_expression(node)


@pytest.mark.parametrize(
    ("text", "grouped"),
    [
        ("a imply b or c imply d", "(((a imply b) || c) imply d)"),
        ("a or b and c", "(a || (b && c))"),
        ("not a and b", "((!a) && b)"),
        ("not a == b", "((!a) == b)"),
        ("a xor b || c", "((a xor b) || c)"),
        ("a & b == c", "(a & (b == c))"),
        ("a | b ^ c & d", "(a | (b ^ (c & d)))"),
        ("a < b == c < d", "((a < b) == (c < d))"),
        ("a <? b < c", "((a <? b) < c)"),
        ("a <? b + c", "(a <? (b + c))"),
        ("a << b <? c", "((a << b) <? c)"),
        ("a - b - c", "((a - b) - c)"),
        ("a + b * c ** d", "(a + (b * (c ** d)))"),
        ("a ** b ** c", "((a ** b) ** c)"),
        ("-a ** b", "((-a) ** b)"),
        ("a ? b : c ? d : e", "(a ? b : (c ? d : e))"),
        ("a = b += c", "(a = (b += c))"),
        ("a := b", "(a = b)"),
        ("a ? b : c = d", "((a ? b : c) = d)"),
        ("forall (i : T) a && b || c", "(forall i. ((a && b) || c))"),
        ("a && forall (i : T) b || c", "(a && (forall i. (b || c)))"),
        ("exists (i : T) a imply sum (j : T) b", "(exists i. (a imply (sum j. b)))"),
        ("!forall (i : T) a && b", "(!(forall i. (a && b)))"),
        ("forall (i : T) a = b", "(forall i. (a = b))"),
    ],
)
def test_precedence_is_that_of_uppaal(text: str, grouped: str) -> None:
    assert bracketed(expression(text)) == grouped


def test_postfix_operations() -> None:
    assert expression("P(1).a[i].b") == ast.MemberExpression(
        NOWHERE,
        ast.IndexExpression(
            NOWHERE,
            ast.MemberExpression(
                NOWHERE,
                ast.CallExpression(NOWHERE, ast.NameExpression(NOWHERE, "P"), (ast.IntegerLiteral(NOWHERE, 1),)),
                ast.Identifier(NOWHERE, "a"),
            ),
            ast.NameExpression(NOWHERE, "i"),
        ),
        ast.Identifier(NOWHERE, "b"),
    )
    assert expression("x[1]' == 0").left == ast.RateExpression(NOWHERE, expression("x[1]"))
    assert expression("a++ + ++b") == ast.BinaryExpression(
        NOWHERE,
        BinaryOperator.ADD,
        ast.IncrementExpression(NOWHERE, "++", False, expression("a")),
        ast.IncrementExpression(NOWHERE, "++", True, expression("b")),
    )


def test_spans_cover_exactly_the_text_of_a_node() -> None:
    text = "int v = f( 1 )[2] +\n  (a && b) ;"
    (declaration,) = document(text).items
    assert isinstance(declaration, ast.VariableDeclaration)
    sum_ = declaration.declarators[0].initialiser
    assert isinstance(sum_, ast.BinaryExpression)
    assert declaration.span.text == text
    assert declaration.declarators[0].span.text == text[4:-2]
    assert sum_.span.text == "f( 1 )[2] +\n  (a && b)"
    assert sum_.left.span.text == "f( 1 )[2]"
    assert sum_.right.span.text == "(a && b)"


def test_declarations() -> None:
    items = document(
        """
        typedef int[0, N - 1] id_t;
        typedef struct { int a, b[2]; clock c; } record;
        const record R = { 1, { 2, 3 } }, S = { a: 1, b: { 0, 0 } };
        urgent broadcast chan go[id_t][int[2,4]], stop[scalar[3]];
        meta int[0, 5] m := 3; hybrid clock h; double d = 1.5e3; string s = "x";
        chan priority go[0] < default < stop[1], b;
        scalar[4] t;
        before_update { a = 1, b++ } after_update { }
        import "libc.so" { int f(int x); };
        """
    ).items
    record = items[1]
    assert isinstance(record, ast.TypedefDeclaration)
    assert isinstance(record.type.base, ast.StructType)
    assert [len(field.declarators) for field in record.type.base.fields] == [2, 1]
    constants = items[2]
    assert isinstance(constants, ast.VariableDeclaration)
    designated = constants.declarators[1].initialiser
    assert isinstance(designated, ast.InitialiserList)
    assert [name.name for name, _ in designated.items if name] == ["a", "b"]
    channels = items[3]
    assert isinstance(channels, ast.VariableDeclaration)
    assert channels.type is not None
    assert channels.type.prefixes == ("urgent", "broadcast")
    assert [type(d).__name__ for d in channels.declarators[0].dimensions] == ["NameExpression", "TypeExpression"]
    assert [item.type.base.name for item in items[5:8]] == ["clock", "double", "string"]  # type: ignore[union-attr]
    priority = items[8]
    assert isinstance(priority, ast.ChannelPriorityDeclaration)
    assert [len(group) for group in priority.groups] == [1, 1, 2]
    assert priority.groups[1][0] == expression("default")
    assert [type(item).__name__ for item in items[10:]] == ["UpdateHook", "UpdateHook", "ForeignImport"]


def test_functions_and_statements() -> None:
    (function,) = document(
        """
        int f(int a, const id_t &b, int c[3]) {
            int i = 0; typedef int[0,1] bit;
            for (i = 0, a = 1; i < 3; i++) a += i;
            for (;;) ;
            for (j : id_t) { g(j); }
            while (true) do { a--; } while (a > 0);
            if (a) if (b) return 1; else return 2;
            assert a > 0;
            assert(b);
            return;
        }
        """
    ).items
    assert isinstance(function, ast.FunctionDeclaration)
    assert [parameter.reference for parameter in function.parameters] == [False, True, False]
    assert len(function.body.declarations) == 2
    kinds = [type(statement).__name__.removesuffix("Statement") for statement in function.body.statements]
    assert kinds == ["For", "For", "Iteration", "While", "If", "Assert", "Assert", "Return"]
    outer = function.body.statements[4]
    assert isinstance(outer, ast.IfStatement)
    assert outer.otherwise is None
    assert isinstance(outer.then, ast.IfStatement)
    assert outer.then.otherwise is not None


def test_classic_template() -> None:
    classic = template(
        """
        clock x;
        state A { x <= 5 && x' == 0 }, B, C { x < 3; 4 }, D { ; 1 + n : n * n };
        branchpoint P;
        commit B; urgent C, D; init A;
        trans A -> B { select i : int[0,3]; guard x > i; sync c[i]!; assign x = 0, n++; },
              -> P { },
              B -u-> A { },
              P -> A { probability 3; };
        """
    )
    assert classic.classic
    flags = [(n.name.name, n.initial, n.urgent, n.committed) for n in classic.locations]
    assert flags == [
        ("A", True, False, False),
        ("B", False, False, True),
        ("C", False, True, False),
        ("D", False, True, False),
    ]
    assert classic.locations[2].exponential_rate == expression("4")
    assert classic.locations[3].exponential_rate == expression("1 + n")
    assert classic.locations[3].rate_divisor == expression("n * n")
    assert [(e.source and e.source.name, e.target.name, e.controllable) for e in classic.edges] == [
        ("A", "B", True),
        ("A", "P", True),
        ("B", "A", False),
        ("P", "A", True),
    ]
    assert len(classic.edges[0].updates) == 2
    assert [b.name.name for b in classic.branchpoints] == ["P"]


def test_location_blocks() -> None:
    blocks = template(
        """
        clock x;
        /// where it
        /// begins
        init location A {
            invariant x <= 20; exponential_rate 3 : 4;
            to B { guard x >= 10; }
            /// leave
            uncontrollable to C { select i : T; sync c[i]!v + 1; assign x = 0; }
        }
        urgent location B;
        init urgent committed location C { to P; }
        branchpoint P { to A { probability 3; assign n = 0; } to B; }
        """
    )
    first, _, third = blocks.locations
    assert (first.exponential_rate, first.rate_divisor) == (expression("3"), expression("4"))
    assert not blocks.classic
    assert first.doc == "where it\nbegins"
    assert [edge.doc for edge in first.edges] == ["", "leave"]
    assert [edge.controllable for edge in first.edges] == [True, False]
    assert all(edge.source is None for edge in first.edges)
    assert (third.initial, third.urgent, third.committed) == (True, True, True)
    assert first.edges[1].synchronisation == ast.SynchronisationLabel(
        NOWHERE, expression("c[i]"), "!", expression("v + 1")
    )
    assert blocks.branchpoints[0].edges[0].probability == expression("3")


def test_additions_at_the_top() -> None:
    items = document(
        """
        import "shared.ta";
        time_unit = 10 ms;
        /// how full
        signal level = T(1).n + 1;
        /// no loss
        property safe "never lost" : A[] forall (i : id_t) not T(i).lost expect holds;
        property live : p --> q expect fails;
        property late : sup{P.A}: x, y;
        property odds : Pr[<=10; 50](<> P.A) expect holds;
        """
    ).items
    assert items[0] == ast.ImportDeclaration(NOWHERE, "shared.ta")
    assert items[1] == ast.TimeUnitDeclaration(NOWHERE, 10, "ms")
    assert isinstance(items[2], ast.SignalDeclaration)
    assert items[2].doc == "how full"
    properties = items[3:]
    assert all(isinstance(p, ast.PropertyDeclaration) for p in properties)
    safe, live, late, odds = properties
    assert (safe.title, safe.expectation, safe.doc) == ("never lost", "holds", "no loss")  # type: ignore[union-attr]
    assert live.formula == ast.QueryFormula(NOWHERE, QueryKind.LEADS_TO, expression("p"), (expression("q"),))  # type: ignore[union-attr]
    assert late.formula.operands == (expression("x"), expression("y"))  # type: ignore[union-attr]
    assert odds.formula == ast.UncheckedFormula(NOWHERE, "Pr[<=10; 50](<> P.A)", "statistical")  # type: ignore[union-attr]
    assert odds.expectation == "holds"  # type: ignore[union-attr]


def test_system_section() -> None:
    items = document(
        "P = T(1, x); Q(const int[0,3] i) := T(i, y);\nsystem P, Q < R;\nprogress { n; m + 1; }\ngantt { G: a -> 1; }"
    ).items
    partial = items[1]
    assert isinstance(partial, ast.Instantiation)
    assert [parameter.name.name for parameter in partial.parameters] == ["i"]
    assert isinstance(items[2], ast.SystemLine)
    assert [[name.name for name in group] for group in items[2].groups] == [["P", "Q"], ["R"]]
    assert items[4] == ast.GanttDeclaration(NOWHERE, "{ G: a -> 1; }")


@pytest.mark.parametrize("word", sorted(set(SPELLING.values()) - {"urgent", "init"}))
def test_no_contextual_keyword_is_reserved(word: str) -> None:
    """Each of them can be a variable, a type, a function, a template, a location, a field and a parameter."""
    text = f"""
        typedef struct {{ int {word}; }} record;
        int {word} = 1, a[2];
        int f(int {word}) {{ {word} = {word} + 1; {word}++; return {word}; }}
        int g() {{ int {word}; return f({word}) + a[{word}] + r.{word}; }}
        process T(int &{word}) {{
            state {word} {{ {word} <= 3 }}, other;
            init {word};
            trans {word} -> other {{ select {word} : int[0,1]; guard {word} > 0; sync {word}!; assign {word} = 1; }},
                  other -> {word} {{ }};
        }}
        process {word}(const int a) {{
            int {word};
            init location {word} {{ invariant {word} < 3; to {word}; to other {{ guard {word} == 1; }} }}
            location other {{ to {word} {{ sync {word}?; assign {word}--; }} }}
        }}
        P = {word}({word});
        system P, {word};
        property {word} : A[] {word}.{word} && P.{word} > 0;
        signal {word} = P.{word};
    """
    items = document(text).items
    assert [type(item).__name__ for item in items] == [
        *("TypedefDeclaration", "VariableDeclaration", "FunctionDeclaration", "FunctionDeclaration"),
        *("Template", "Template", "Instantiation", "SystemLine", "PropertyDeclaration", "SignalDeclaration"),
    ]
    location_names = [node.name.name for t in items[4:6] if isinstance(t, ast.Template) for node in t.locations]
    assert location_names == [word, "other", word, "other"]


@pytest.mark.parametrize("word", ["property", "signal", "location", "branchpoint", "hybrid", "assert", "to", "import"])
def test_a_contextual_keyword_can_name_a_type(word: str) -> None:
    items = document(
        f"typedef int[0,3] {word};\n{word} x = 1;\nprocess P({word} y) {{ {word} z; state A; init A; }}"
    ).items
    assert isinstance(items[1], ast.VariableDeclaration)
    assert isinstance(items[2], ast.Template)
    assert items[2].declarations == document(f"{word} z;").items


@pytest.mark.parametrize("word", ["A", "E", "U", "Pr", "simulate", "control"])
def test_words_of_the_query_language_are_names(word: str) -> None:
    entry, diagnostics = parser.parse_query(Source("q", f"A[] {word}[1] == {word}.{word} && {word} > 1"))
    assert diagnostics == ()
    assert entry is not None
    assert isinstance(entry.formula, ast.QueryFormula)


def test_deadlock_is_a_name_outside_queries_and_behind_a_dot() -> None:
    assert document("int deadlock = deadlock;").items
    entry, _ = parser.parse_query(Source("q", "E<> P.deadlock && deadlock"))
    assert entry is not None
    assert isinstance(entry.formula, ast.QueryFormula)
    assert entry.formula.predicate == ast.BinaryExpression(
        NOWHERE, BinaryOperator.AND, expression("P.deadlock"), ast.DeadlockExpression(NOWHERE)
    )


@pytest.mark.parametrize(
    ("text", "family"),
    [
        ("Pr[<=100](<> P.A)", "statistical"),
        ("Pr[x<=3;100]([] y > 1) >= 0.5", "statistical"),
        ("simulate [<=10] { x, y }", "statistical"),
        ("simulate 10 [<=10] { x }", "statistical"),
        ("E[<=10; 100](max: x)", "statistical"),
        ("control: A[] not P.bad", "game"),
        ("{ P.x, y } control: A<> P.win", "game"),
        ("minE(cost)[<=10] : <> P.done", "learning"),
        ("strategy S = control: A<> P.win", "learning"),
        ("A[] P.ok under S", "learning"),
        ('saveStrategy("f", S)', "learning"),
        ("scenario: Obs", "scenario"),
    ],
)
def test_queries_of_other_families_are_kept_as_text(text: str, family: str) -> None:
    entry, diagnostics = parser.parse_query(Source("q", text))
    assert diagnostics == ()
    assert entry is not None
    assert entry.formula == ast.UncheckedFormula(NOWHERE, text, family)


def test_old_syntax_is_read_as_a_whole_with_a_warning() -> None:
    text = """
        const N 5, M -3;
        process P(int v, w; const c; clock z) {
            const D 10;
            state A { z =< 5, v >= 1 }, B;
            init A;
            trans A -> B { guard z > 1, v => N; sync a!; assign z := 0, v := 0; };
        }
    """
    result, diagnostics = parser.parse_document(Source("t.ta", text))
    assert [diagnostic.code for diagnostic in diagnostics] == ["W0101"]
    assert result is not None
    assert result.legacy
    constants, old = result.items
    assert isinstance(constants, ast.VariableDeclaration)
    assert constants.type is None
    assert isinstance(old, ast.Template)
    assert [(p.name.name, p.reference) for p in old.parameters] == [
        ("v", True),
        ("w", True),
        ("c", False),
        ("z", True),
    ]
    assert old.locations[0].invariant == expression("z <= 5 && v >= 1")
    assert old.edges[0].guard == expression("z > 1 && v >= N")
    assert len(old.edges[0].updates) == 2


def test_a_comma_in_a_modern_guard_is_not_taken_silently() -> None:
    text = "typedef int id_t;\nprocess P() { state A; init A; trans A -> A { guard x > 1, y > 2; }; }\nint x y;"
    _, diagnostics = parser.parse_document(Source("t.ta", text))
    assert parser.has_errors(diagnostics)


@pytest.mark.parametrize(
    "text",
    [
        'import "a.ta";',
        "time_unit = 1 ms;",
        "signal s = x;",
        "property p : A[] x;",
        "process P() { init location A; }",
        "process P() { state A; init A; trans A -> A { sync c!1; }; }",
    ],
)
def test_strict_xta_rejects_the_additions(text: str) -> None:
    assert parser.parse_document(Source("t.ta", text))[1] == ()
    _, diagnostics = parser.parse_document(Source("t.ta", text), strict_xta=True)
    assert [diagnostic.code for diagnostic in diagnostics] == ["E0112"]


def test_fragments_of_uppaal_xml() -> None:
    def read(function: Any, text: str) -> Any:
        value, diagnostics = function(Source("label", text))
        assert not parser.has_errors(diagnostics)
        return value

    assert len(read(parser.parse_declarations, "clock x; int f() { return 1; }\nP = T(x);")) == 3
    assert len(read(parser.parse_system, "P = T(1);\nsystem P;")) == 2
    assert [p.name.name for p in read(parser.parse_parameters, "const id_t i, chan &c, int a[3]")] == ["i", "c", "a"]
    assert [b.name.name for b in read(parser.parse_select, "i : id_t, j : int[0,3]")] == ["i", "j"]
    assert read(parser.parse_constraint, "x > 1 && y < 2") == expression("x > 1 && y < 2")
    assert read(parser.parse_constraint, "x > 1, y < 2") == expression("x > 1 && y < 2")
    assert read(parser.parse_synchronisation, "c[i]?") == ast.SynchronisationLabel(
        NOWHERE, expression("c[i]"), Direction.RECEIVE
    )
    assert read(parser.parse_synchronisation, "a").direction is None
    assert len(read(parser.parse_assignment, "x := 0, f(), y++")) == 3
    assert read(parser.parse_rate, "3 : 4") == (expression("3"), expression("4"))
    assert read(parser.parse_rate, "3") == (expression("3"), None)
    for empty in (parser.parse_constraint, parser.parse_synchronisation, parser.parse_rate):
        assert read(empty, " // nothing\n") is None
    for empty_list in (
        parser.parse_parameters,
        parser.parse_select,
        parser.parse_assignment,
        parser.parse_declarations,
    ):
        assert read(empty_list, "") == ()


@pytest.mark.parametrize("text", ["const int[0, 1+= id", "const int[0, 1", "(", "x[", "const int id {", "a)"])
def test_brackets_of_parameters_that_do_not_match_are_an_error(text: str) -> None:
    """Read again as an old text they are no more than that either."""
    _, diagnostics = parser.parse_parameters(Source("p", text))
    assert {found.severity for found in diagnostics} == {Severity.ERROR}


def test_comments_line_ends_and_byte_order_marks_are_tolerated() -> None:
    result = document("\ufeffint a; // é\r\n/* two\r\nlines */ int b;\r\n/// nobody's\n\nint c;")
    assert [comment.own_line for comment in result.comments] == [False, True, True]
    assert result.comments[0].text == "// é"
    assert len(result.items) == 3


def test_documentation_of_what_has_none_stays_a_comment() -> None:
    assert [comment.text for comment in document("/// a variable\nint a;").comments] == ["/// a variable"]


@pytest.mark.parametrize(
    "text",
    [
        "int a = " + "(" * 3000 + "1" + ")" * 3000 + ";",
        "int a = " + "!" * 9000 + "1;",
        "int a = " + "1 - " * 9000 + "1;",
        "int a = " + "a ? 1 : " * 9000 + "1;",
        "int a = " + "a ? " * 300 + "1" + " : 1" * 300 + ";",
        "int a = " + "forall (i : int[0,1]) " * 3000 + "1;",
        "int a = " + "f(1, 2) - " * 9000 + "1;",
        "int a = f" + "(1)" * 3000 + ";",
        "void f() " + "{" * 3000 + "}" * 3000,
        "void f() { " + "if (a) " * 3000 + "; }",
        "void f() { " + "if (a) ; else " * 9000 + "; }",
        "typedef " + "struct { " * 3000,
    ],
)
def test_absurd_nesting_is_rejected(text: str) -> None:
    _, diagnostics = parser.parse_document(Source("t.ta", text))
    assert "E0111" in {diagnostic.code for diagnostic in diagnostics}


@pytest.mark.parametrize(
    "text",
    [
        "int a = " + "!" * 1000 + "1;",
        "int a = " + "1 - " * 1000 + "1;",
        "int a = " + "a ? 1 : " * 1000 + "1;",
        "void f() { " + "if (a) ; else " * 1000 + "; }",
        "void f() { " + "a = " * 1000 + "1; }",
    ],
)
def test_chains_are_no_nesting(text: str) -> None:
    assert document(text).items


def test_a_small_stack_takes_shorter_chains(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tachk.syntax.parsing.depth._stack_size", lambda: 2**20)
    _, diagnostics = parser.parse_document(Source("t.ta", "int a = " + "1 - " * 1000 + "1;"))
    assert [(d.code, d.message) for d in diagnostics] == [("E0111", "this chain has more than 512 parts")]


def test_long_flat_texts_are_fine() -> None:
    values = ", ".join(["1"] * 3000)
    assert document(f"int a[3000] = {{ {values} }};\nvoid f() {{ {'a[0] = 1; ' * 3000} }}").items


def test_the_place_of_an_array_ends_behind_its_bracket() -> None:
    text = (
        "int a[2][ N ], b; void f(int &c[3] /* ] */, const int d[(N)]) { } process P(clock &e[2]) { state s; init s; }"
    )
    array, function, template = document(text).items
    assert isinstance(array, ast.VariableDeclaration)
    assert isinstance(function, ast.FunctionDeclaration)
    assert isinstance(template, ast.Template)
    assert [each.span.text for each in array.declarators] == ["a[2][ N ]", "b"]
    assert [each.span.text for each in function.parameters] == ["int &c[3]", "const int d[(N)]"]
    assert [each.span.text for each in template.parameters] == ["clock &e[2]"]
