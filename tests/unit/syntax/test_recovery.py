"""After an error the parser goes on, and says as much as is certain."""

from __future__ import annotations

import pytest

from tachk.base.span import Source
from tachk.syntax import ast
from tachk.syntax.parsing.driver import MOST_ERRORS
from tachk.syntax.parsing.parser import parse_document, parse_query


def errors(text: str) -> list[tuple[int, str]]:
    _, diagnostics = parse_document(Source("t.ta", text))
    return [(d.span.source.line_column(d.span.start)[0], d.code) for d in diagnostics]


def test_every_item_with_an_error_is_reported_once() -> None:
    assert errors("int 1;\nint a;\nclock 2;\nvoid f() { a = ; b = ; }\nchan c;\nsystem ;") == [
        (1, "E0101"),
        (3, "E0101"),
        (4, "E0101"),
        (4, "E0101"),
        (6, "E0101"),
    ]


def test_what_is_right_is_still_read() -> None:
    document, _ = parse_document(
        Source("t.ta", "int a;\nint 1;\nprocess P() { clock x; init location A { to ; to A; } }\nsystem P;")
    )
    assert document is not None
    assert [type(item).__name__ for item in document.items] == ["VariableDeclaration", "Template", "SystemLine"]
    template = document.items[1]
    assert isinstance(template, ast.Template)
    assert len(template.locations[0].edges) == 1


def test_an_unclosed_template_does_not_swallow_the_next_one() -> None:
    assert errors(
        "process P() {\n init location A {\n\nprocess Q() {\n init location B { to 3; }\n}\nsystem P, Q;"
    ) == [
        (2, "E0113"),
        (5, "E0101"),
    ]


def test_a_lexical_error_hides_the_syntax_errors_it_causes() -> None:
    assert errors("int a = 3 € 4;\nint b c;") == [(1, "E0002"), (2, "E0101")]


def test_the_number_of_errors_is_limited() -> None:
    assert len(errors("int 1;\n" * 1000)) == MOST_ERRORS


def test_a_range_is_inside_the_text() -> None:
    for text in ("int a", "process P() {", "int a = (", "", "/*", "A", "property p : A[]"):
        _, diagnostics = parse_document(Source("t.ta", text))
        assert all(0 <= d.span.start <= d.span.end <= len(text) for d in diagnostics)


def test_expected_words_are_listed_when_they_are_few() -> None:
    _, diagnostics = parse_document(Source("t.ta", "system P Q;"))
    assert diagnostics[0].message == "expected ',', ';' or '<', found 'Q'"


@pytest.mark.parametrize("text", ["", "   ", "// only a comment"])
def test_an_empty_query(text: str) -> None:
    entry, diagnostics = parse_query(Source("q", text))
    assert entry is None
    assert [d.code for d in diagnostics] == ["E0115"]


@pytest.mark.parametrize("value", ["20", "2 * (3 + 4)"])
def test_a_constant_without_a_type_is_read_once_its_help_is_applied(value: str) -> None:
    text = f"const RETRY = {value};"
    assert errors(text) == [(1, "W0101")], "alone it is the syntax of old models"
    _, found = parse_document(Source("t.ta", f"{text}\nint 1;"))
    assert [diagnostic.code for diagnostic in found] == ["E0101", "E0101"]
    assert found[0].help == f"write `const int RETRY = {value};`"
    assert errors(found[0].help.removeprefix("write ").strip("`")) == []
