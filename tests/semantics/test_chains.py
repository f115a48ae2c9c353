"""Chains of hundreds of parts are no nesting: they are read, printed, exported, searched and simulated."""

from __future__ import annotations

from functools import reduce

import pytest

from tachk.api import model as api
from tachk.base.operators import BinaryOperator
from tachk.base.span import Source
from tachk.formats.catalogue import export_model
from tachk.formats.exported import Writing
from tachk.formats.loading.load import load_model
from tachk.syntax.parsing.parser import parse_document
from tachk.syntax.printing.printer import print_document

pytestmark = pytest.mark.drawn

LENGTH = 300


def folded(operator: str, values: list[int]) -> int:
    return reduce(BinaryOperator(operator).compute, values)


def joined(operator: str, values: list[int]) -> str:
    """The values as a chain that is not computed before the run: n is 0."""
    return f" {operator} ".join(f"(n + {value})" for value in values)


SMALL = [number % 3 for number in range(LENGTH)]
CHAINS = [
    *((joined(o, SMALL), folded(o, SMALL)) for o in ("-", "==", "!=", "<=", "imply")),
    *((joined(o, [7, *([1] * LENGTH)]), folded(o, [7, *([1] * LENGTH)])) for o in ("/", "**", "%")),
    *((joined(o, [9, *([0] * LENGTH)]), folded(o, [9, *([0] * LENGTH)])) for o in ("<<", ">>")),
    (" - ".join(f"n + {value}" for value in SMALL), sum(SMALL)),
    ("!" * (2 * LENGTH + 1) + "n", 1),
    ("- " * (2 * LENGTH + 1) + "(n + 5)", -5),
    ("".join(f"n == {number} ? {number} : " for number in range(1, LENGTH)) + "42", 42),
]


def model(body: str, value: int) -> str:
    return f"""
        int n; int[-32768, 32767] result; int a[{LENGTH}];
        void f() {{ {body} }}
        process P() {{ state A, B; init A; trans A -> B {{ assign f(); }}; }}
        system P;
        property Q : A[] P.B imply result == {value};"""


BODIES = [
    *((f"result = {chain};", value) for chain, value in CHAINS),
    ("".join(f"if (n == {i}) result = {i}; else " for i in range(1, LENGTH)) + "result = 7;", 7),
    (" = ".join(f"a[{i}]" for i in range(LENGTH)) + " = 2; result = a[0] + a[150];", 4),
]


@pytest.mark.parametrize(("body", "value"), BODIES)
def test_chains(body: str, value: int) -> None:
    text = model(body, value)
    document, _ = parse_document(Source("model.ta", text))
    assert document is not None
    again, diagnostics = parse_document(Source("again.ta", print_document(document)))
    assert again is not None and diagnostics == () and print_document(again) == print_document(document)
    loaded = load_model(Source("model.ta", text))
    exported = load_model(Source("again.xml", export_model(loaded, "xml", Writing()).text))
    for each in (loaded, exported):
        assert [verdict.answer for verdict in api.Model(each).verify()] == ["holds"]


def test_chains_in_guards_and_queries() -> None:
    chain = " imply ".join(f"n == {number % 7}" for number in range(LENGTH))
    text = f"""
        int n = 3; clock x;
        process P() {{ state A, B; init A; trans A -> B {{ guard ({chain}) && x > 2; }}; }}
        system P;
        property Q : E<> P.B && ({chain}) && x < 3;
        property R : E<> P.B && x <= 2;"""
    loaded = api.Model(load_model(Source("model.ta", text)))
    true = folded("imply", [number % 7 == 3 for number in range(LENGTH)])
    assert [verdict.answer for verdict in loaded.verify()] == ["holds" if true else "fails", "fails"]
