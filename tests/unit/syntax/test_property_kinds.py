"""A property line, a query file and the command line take queries, formulas and sentences, and distinguish them."""

from __future__ import annotations

import pytest

from tachk.base.span import Source
from tachk.syntax import ast
from tachk.syntax.parsing.parser import parse_document, parse_query
from tachk.syntax.printing.printer import print_document
from tachk.syntax.query_files import parse_queries

SENTENCE = "whenever T(1).sleeping, within 50 s, it's not - at all: must be true."


def kind(text: str) -> str:
    entry, diagnostics = parse_query(Source("q", text))
    assert entry is not None, diagnostics
    assert diagnostics == ()
    match entry.formula:
        case ast.TemporalFormula(formula=None):
            return "sentence"
        case ast.TemporalFormula():
            return "formula"
        case ast.UncheckedFormula(family=family):
            return family
        case ast.QueryFormula():
            return "query"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("A[] p", "query"),
        ("A[] P.G && S == F", "query"),
        ("E<> F && U", "query"),
        ("p --> q", "query"),
        ("G --> F", "query"),
        ("sup: S, F", "query"),
        ("inf{G}: x", "query"),
        ("A[] not deadlock", "query"),
        ("G p", "formula"),
        ("G(p -> q)", "formula"),
        ("p -> F q", "formula"),
        ("rise(p)", "formula"),
        ("p U[0,5] q", "formula"),
        ("!(p S q)", "formula"),
        ("G p expect holds", "formula"),
        ("inf == 3 && F p", "formula"),
        (SENTENCE, "sentence"),
        (f"{SENTENCE} expect fails", "sentence"),
        ("Globally, p must be true.", "sentence"),
        ("Pr[<=10](<> p)", "statistical"),
        ("A[p U q]", "game"),
    ],
)
def test_kinds(text: str, expected: str) -> None:
    assert kind(text) == expected


def test_a_sentence_is_kept_with_its_blanks_settled() -> None:
    entry, _ = parse_query(Source("q", "whenever p,\n    q   must be true.  expect holds"))
    assert entry is not None
    assert entry.expectation == "holds"
    assert entry.formula == ast.TemporalFormula(entry.span, None, "whenever p, q must be true.")


def test_query_files() -> None:
    text = "// the first\nG (p -> F[0, 5 s] q)\nwhenever p, \\\n  q must be true.\n/* EXPECT:F */\nA[] p\n"
    entries, diagnostics = parse_queries(Source("m.q", text))
    assert diagnostics == ()
    assert [type(entry.formula) for entry in entries] == [ast.TemporalFormula, ast.TemporalFormula, ast.QueryFormula]
    assert entries[0].comment == "the first"
    assert entries[1].expectation == "fails"


def test_formatting_keeps_the_way_a_property_is_written() -> None:
    text = f"""\
property a "title":G(p   imply F[0,5)not q)expect holds;
/// about b
property b : {SENTENCE} expect fails;
property c : A[]  G . F;
"""
    document, diagnostics = parse_document(Source("m.ta", text))
    assert document is not None, diagnostics
    assert diagnostics == ()
    formatted = print_document(document)
    assert formatted == (
        f'property a "title" : G (p -> F[0, 5) !q) expect holds;\n/// about b\nproperty b : {SENTENCE} expect fails;\n'
        "property c : A[] G.F;\n"
    )
    again, _ = parse_document(Source("m.ta", formatted))
    assert again == document


def test_letters_stay_names_everywhere_else() -> None:
    text = (
        "int F, G, U, rise, inf, s;\nvoid f() { F = G + U * rise(inf); }\nsignal S = F[0] > s && W;\n"
        "process P() { init location G { to G { guard F > U && S; } } }\nsystem P;\n"
    )
    document, diagnostics = parse_document(Source("m.ta", text))
    assert document is not None
    assert diagnostics == ()
