"""The canonical text: stable, complete, and equal when read again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.base.resources import data_root
from tachk.base.span import NOWHERE, Source
from tachk.base.words import QueryKind
from tachk.syntax import ast
from tachk.syntax.parsing.parser import has_errors, parse_document, parse_expression, parse_query
from tachk.syntax.parsing.tables import lexer
from tachk.syntax.printing.expression_printer import print_expression
from tachk.syntax.printing.printer import canonical, print_document
from tachk.syntax.printing.query_printer import print_query


def read(text: str) -> ast.Document:
    document, diagnostics = parse_document(Source("t.ta", text))
    assert not has_errors(diagnostics), diagnostics
    assert document is not None
    return document


def check_round_trip(text: str) -> str:
    """The canonical text, after checking that it is stable, equal, and has every comment."""
    document = read(text)
    printed = print_document(document)
    again = read(printed)
    assert again == canonical(document)
    assert print_document(again) == printed
    assert _squeezed(again) == _squeezed(document)
    return printed


def _squeezed(document: ast.Document) -> list[str]:
    return sorted(" ".join(comment.text.split()) for comment in document.comments)


CLASSIC = """
const int N=3;
// the train
process Train(const int id, chan &c){
clock x; // its clock
state Safe{x<=20&&x'==0},
  // crossing
  Cross { x<5;2:n+1 }, P1;
branchpoint Choice;
commit P1; urgent Cross; init Safe;
trans
  // approach
  Safe -> Cross { select i : int[0,N]; guard x>=i; sync c!; assign x:=0,n++; }, // here
  -> Choice { },
  Choice -> Safe { probability 3; },
  Cross -u-> P1 { };
}
T=Train(1,c);
system T;
"""

CANONICAL = """\
const int N = 3;

// the train
process Train(const int id, chan &c) {
    clock x;  // its clock

    init location Safe {
        invariant x <= 20 && x' == 0;
        // approach
        to Cross { select i : int[0, N]; guard x >= i; sync c!; assign x = 0, n++; }  // here
        to Choice;
    }

    // crossing
    urgent location Cross {
        invariant x < 5;
        exponential_rate 2 : n + 1;
        uncontrollable to P1;
    }

    committed location P1;

    branchpoint Choice {
        to Safe { probability 3; }
    }
}

T = Train(1, c);
system T;
"""


def test_the_classic_form_becomes_location_blocks() -> None:
    assert check_round_trip(CLASSIC) == CANONICAL


def test_the_canonical_form_stays_as_it_is() -> None:
    assert check_round_trip(CANONICAL) == CANONICAL


STATEMENTS = """\
int f(int a, const id_t &b) {
    int i;

    for (i = 0, a = 1; i < 3; i++) a += i;
    for (j : id_t) {
        g(j);
    }
    do {
        a--;
    } while (a > 0);
    if (a == 1) {
        return 1;
    } else if (a == 2) return 2;  // odd
    else {
        // nothing
    }
    {
        ;
    }
    if (a == 3)
        // a comment keeps its line
        a = 4;
    for (i : id_t)
        if (a == i) a = 4;
    while (true) assert a ? b : c;
    return;
}
"""


def test_statements() -> None:
    assert check_round_trip(STATEMENTS) == STATEMENTS


def test_comments_behind_neighbouring_lines_begin_in_one_column() -> None:
    text = """\
int a;             // one
bool longer_name;  // two
chan c;

int b;  // alone
int number_of_things_that_are_waiting_for_their_turn_to_come_up;  // behind long code
int d;                                                            /* a block */
"""
    expected = text.replace(" " * 60 + "/*", "  /*")
    assert check_round_trip(text) == expected
    assert check_round_trip(expected) == expected


DECLARATIONS = """\
/* The head
   of the file. */
import "shared.ta";
time_unit = 10 ms;

typedef int[0, 3] id_t;
typedef struct { int a, b[2]; bool c; } small_t;
typedef struct {
    int a;  // first
    // second
    int b;
} commented_t;
chan priority go[0], b < default < stop;
hybrid clock h;
int a[id_t][int[2, 4]] = { { 1, 2 }, { x: 1, 2 } };
import "libc.so" { int f(int x); };
before_update { a = 1, b++ }

/// how full
signal level = T(1).n + 1;
/// nothing is lost
property safe "never lost" : A[] forall (i : id_t) !T(i).lost expect holds;
property late : sup{ P.A }: x, y;
property odds : Pr[<=10](<> P.A);

system A, B < C;
progress { n; }
gantt { G: a -> 1; }
// the end
"""


def test_declarations() -> None:
    assert check_round_trip(DECLARATIONS) == DECLARATIONS


def test_long_lines_are_broken_where_that_is_possible() -> None:
    condition = " && ".join(f"condition_number_{n} > {n}" for n in range(8))
    values = ", ".join(str(n) for n in range(1000, 1060))
    text = (
        f"int table[60] = {{ {values} }};\n"
        f'property p "title" : A[] {condition} expect fails;\n'
        f"process P() {{ init location A {{ invariant {condition}; to A {{ guard {condition}; assign x = 0; }} }} }}"
    )
    printed = check_round_trip(text)
    assert max(len(line) for line in printed.splitlines() if "property" not in line and "A[]" not in line) <= 100


def test_old_syntax_is_upgraded() -> None:
    document, _ = parse_document(
        Source("t.ta", "const N 5;\nprocess P(clock x; const c) { state A { x <= N, x < 9 }; init A; }")
    )
    assert document is not None
    printed = print_document(document)
    assert parse_document(Source("t.ta", printed), strict_xta=False)[1] == ()
    assert "const int N = 5;" in printed
    assert "process P(clock &x, const int c)" in printed
    assert "invariant x <= N && x < 9;" in printed


@pytest.mark.parametrize("comment", ["/* c */", "// c\n", "\n// c\n", "\n\n/* c\n c */\n"])
@pytest.mark.parametrize("text", [CLASSIC, STATEMENTS, DECLARATIONS], ids=["classic", "statements", "declarations"])
def test_a_comment_survives_wherever_it_stands(text: str, comment: str) -> None:
    tokens = lexer().cut(Source("t.ta", text)).tokens
    for token in tokens[::3]:
        start = token.span.start
        with_comment = text[:start] + comment + text[start:]
        document, diagnostics = parse_document(Source("t.ta", with_comment))
        if document is not None and not has_errors(diagnostics):
            check_round_trip(with_comment)


def _models() -> list[Path]:
    return sorted((data_root() / "models").rglob("*.ta"))


@pytest.mark.parametrize("path", _models(), ids=lambda path: path.stem)
def test_the_models_of_the_project(path: Path) -> None:
    check_round_trip(path.read_text(encoding="utf-8"))


def _node(kind: type[Any], *parts: Any) -> st.SearchStrategy[Any]:
    return st.tuples(*parts).map(lambda values: kind(NOWHERE, *values))


_names = st.sampled_from(["a", "b", "x"]).map(lambda name: ast.NameExpression(NOWHERE, name))
_identifiers = st.sampled_from(["a", "b", "location"]).map(lambda name: ast.Identifier(NOWHERE, name))
_types = st.just(ast.TypeExpression(NOWHERE, (), ast.NamedType(NOWHERE, "T")))


def _compound(inner: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    return st.one_of(
        _node(ast.BinaryExpression, st.sampled_from(BinaryOperator), inner, inner),
        _node(ast.UnaryExpression, st.sampled_from(PrefixOperator), inner),
        _node(ast.IncrementExpression, st.sampled_from(["++", "--"]), st.booleans(), inner),
        _node(
            ast.AssignmentExpression,
            st.sampled_from([None, BinaryOperator.ADD, BinaryOperator.SHIFT_LEFT]),
            inner,
            inner,
        ),
        _node(ast.ConditionalExpression, inner, inner, inner),
        _node(ast.QuantifierExpression, st.sampled_from(["forall", "exists", "sum"]), _identifiers, _types, inner),
        _node(ast.CallExpression, inner, st.lists(inner, max_size=2).map(tuple)),
        _node(ast.IndexExpression, inner, inner),
        _node(ast.MemberExpression, inner, _identifiers),
        _node(ast.RateExpression, inner),
    )


expressions = st.recursive(_names | _node(ast.IntegerLiteral, st.integers(0, 9)), _compound, max_leaves=8)


@settings(max_examples=300, deadline=None)
@given(expressions)
def test_every_expression_is_read_as_it_was(expression: ast.Expression) -> None:
    text = print_expression(expression)
    assert parse_expression(Source("e", text)) == (expression, ())


ONE_PREDICATE = (QueryKind.POSSIBLY, QueryKind.INVARIANTLY, QueryKind.EVENTUALLY, QueryKind.POTENTIALLY_ALWAYS)


@settings(max_examples=100, deadline=None)
@given(expressions, expressions, st.sampled_from(QueryKind))
def test_every_query_is_read_as_it_was(left: ast.Expression, right: ast.Expression, kind: QueryKind) -> None:
    operands = () if kind in ONE_PREDICATE else (right,)
    formula = ast.QueryFormula(NOWHERE, kind, left, operands)
    entry, diagnostics = parse_query(Source("q", print_query(formula)))
    assert diagnostics == ()
    assert entry is not None
    assert entry.formula == formula


def test_latenesses_are_printed_as_they_are_read() -> None:
    text = """recording {
    visible a as input();
    visible b as late();
    tolerance 5 ms;
    late input 1 ms;
    late output 20;
}
"""
    assert check_round_trip(text) == text
    assert check_round_trip(text.replace("late output 20", "late\n    output   20")) == text


def test_hide_is_printed_as_it_is_read() -> None:
    assert check_round_trip("hide Link, Tracker;\n") == "hide Link, Tracker;\n"
