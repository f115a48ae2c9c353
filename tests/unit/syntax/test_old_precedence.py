"""Conditions of old texts that early versions of UPPAAL grouped in another way."""

from __future__ import annotations

import pytest

from tachk.base.span import Source
from tachk.syntax.parsing.parser import parse_document


def warned(guard: str, assign: str = "a := 1", first: str = "const N 5;") -> list[str]:
    text = (
        f"{first}\nint a, b, v[2]; bool c;\n"
        f"process P() {{ state s; init s; trans s -> s {{ guard {guard}; assign {assign}; }}; }}\nsystem P;"
    )
    document, diagnostics = parse_document(Source("old.xta", text))
    assert document is not None
    return [found.span.text for found in diagnostics if found.code == "W0102"]


@pytest.mark.parametrize(
    ("guard", "places"),
    [
        ("not a == b", ["not a =="]),
        ("not v[a + 1] == b", ["not v[a + 1] =="]),
        ("c and not (a == 1) && c", ["not (a == 1) &&"]),
        ("not (a == b)", []),
        ("not c and a == b", []),
        ("not not c or c", []),
        ("a == 1 and b == 2 || c", ["and b == 2 ||"]),
        ("a == 1 imply b == 2 || c", ["imply b == 2 ||"]),
        ("(a == 1 and b == 2) || c", []),
        ("a == 1 or b == 2 || c", []),
        ("a == 1 or b == 2 && c", []),
        ("a == 1 and b == 2, c || c", []),
        ("c and c ? a == 1 : c", ["and c ?"]),
    ],
)
def test_guards(guard: str, places: list[str]) -> None:
    assert warned(guard) == places


def test_an_assignment_took_in_less() -> None:
    assert warned("c", "c := a == 1 and b == 2") == [":= a == 1 and"]
    assert warned("c", "c := a == 1 && b == 2") == []


def test_modern_texts_are_not_old() -> None:
    assert warned("not a == b", first="const int N = 5;") == []
