"""The examples of the explanations show what they explain."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.explanation import all_explanations, explain, explanations
from tachk.base.span import Source
from tachk.syntax.parsing.parser import parse_document

SYNTAX_CODES = {
    code: explanation
    for code, explanation in {**explanations("syntax"), **explanations("formulas")}.items()
    if not code.startswith("E05")
}
SHOWN = sorted(code for code, explanation in SYNTAX_CODES.items() if explanation.bad)


def codes(text: str, strict: bool) -> set[str]:
    return {d.code for d in parse_document(Source("t.ta", text), strict_xta=strict)[1]}


@pytest.mark.parametrize("code", SHOWN)
def test_the_bad_example_has_the_defect_and_the_good_one_none(code: str) -> None:
    explanation = SYNTAX_CODES[code]
    strict = code == "E0112"
    assert code in codes(explanation.bad, strict)
    assert codes(explanation.good, strict) == set()


def test_every_code_of_the_sources_is_explained() -> None:
    folder = Path(tachk.__file__).parent
    used = {
        code
        for path in folder.rglob("*.py")
        for code in re.findall(r'"([EW]0\d{3})"', path.read_text(encoding="utf-8"))
    }
    assert used <= all_explanations().keys()


def test_an_explanation_as_text() -> None:
    text = explain("e0102")
    assert text is not None
    assert text.startswith("E0102: something is missing")
    assert explain("E9999") is None
