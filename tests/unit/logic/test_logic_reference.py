"""What docs/logic.md shows is read, or refused, as it says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.syntax.formulas.parser import parse_formula

DOCUMENT = (Path(__file__).resolve().parents[3] / "docs" / "logic.md").read_text("utf-8")
SECTIONS = dict(re.findall(r"^## ([^\n]+)\n(.*?)(?=^## |\Z)", DOCUMENT, re.MULTILINE | re.DOTALL))
MODEL = "int x;\nbool p, q;\nprocess P() { init location a; }\nsystem P;\nproperty shown : %s;\n"


def shown(section: str) -> list[str]:
    """The codes of the first column of the table of a section, and of its text behind a colon or a parenthesis."""
    rows = [line.split(" | ")[0] for line in SECTIONS[section].splitlines() if line.startswith("| `")]
    return [code.replace("\\|", "|") for row in rows for code in re.findall(r"`([^`]+)`", row)]


@pytest.mark.parametrize("text", shown("Formulas"))
def test_formula(text: str) -> None:
    if text not in ("not", "and", "or", "imply", "xor"):
        formula, diagnostics = parse_formula(Source("docs", text))
        assert formula is not None, diagnostics


@pytest.mark.parametrize("text", [code for code in shown("When a formula is refused") if code != "time_unit"])
def test_rejected(text: str) -> None:
    written = text.removeprefix("property p : ").removesuffix(";")
    with pytest.raises(InputError):
        load_model(Source("docs.ta", MODEL % written))
