"""The .q format."""

from __future__ import annotations

from tachk.base.span import Source
from tachk.syntax.query_files import parse_queries


def test_queries_comments_continuations_and_expectations() -> None:
    text = """\
/*
 * Mutual exclusion.
 * Always.
 */
A[] not (P.cs and Q.cs) \\
    and true
/* EXPECT:T,100MB,5s */

// found by hand
E<> P.cs /* EXPECT:UNSAT */
p --> q // leads to
/* EXPECT:MT */
Pr[<=10](<> x)
A[] x expect fails
"""
    entries, diagnostics = parse_queries(Source("t.q", text))
    assert diagnostics == ()
    assert [(entry.comment, entry.expectation) for entry in entries] == [
        ("Mutual exclusion.\nAlways.", "holds"),
        ("found by hand", "fails"),
        ("leads to", None),
        ("", None),
        ("", "fails"),
    ]
    assert entries[0].formula.span.text.endswith("and true")


def test_a_wrong_query_does_not_hide_the_others() -> None:
    entries, diagnostics = parse_queries(Source("t.q", "A[] x\nA[] x >\nE<> y\n"))
    assert [entry.formula.span.text for entry in entries] == ["A[] x", "E<> y"]
    assert [str(diagnostic.span) for diagnostic in diagnostics] == ["t.q:2:8"]


def test_carriage_returns_and_empty_files() -> None:
    assert len(parse_queries(Source("t.q", "A[] x\r\n\r\nA[] y \\\r\n  && z\r\n"))[0]) == 2
    assert parse_queries(Source("t.q", "\n// nothing\n")) == ((), ())


def test_a_blank_behind_the_colon_of_an_expectation() -> None:
    entries, _ = parse_queries(Source("t.q", "A[] true\n/* EXPECT: F */\n"))
    assert [entry.expectation for entry in entries] == ["fails"]
