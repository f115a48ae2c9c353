"""Every code that elaboration reports: its bad example has it, its good example loads without it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.diagnostics.explanation import explanations
from tachk.base.span import Source
from tachk.formats.loading.load import load_model

TACHK = Path(__file__).resolve().parents[3] / "src" / "tachk"
MODEL_CODES = {
    code: explanation
    for group in ("names", "types", "systems", "recordings")
    for code, explanation in explanations(group).items()
}


def findings(text: str) -> tuple[Diagnostic, ...]:
    """What is found in an example; a process and a system line are added where they are missing."""
    if "process" not in text:
        text += "\nprocess P() { state s; init s; }"
    if "system" not in text:
        text += "\nsystem P;"
    try:
        loaded = load_model(Source("example.ta", text))
        return (*loaded.refusals, *loaded.warnings)
    except InputError as error:
        return error.diagnostics


@pytest.mark.parametrize("code", [code for code, e in MODEL_CODES.items() if e.bad])
def test_bad_example_has_exactly_its_finding(code: str) -> None:
    assert {d.code for d in findings(MODEL_CODES[code].bad)} == {code}


@pytest.mark.parametrize("code", [code for code, e in MODEL_CODES.items() if e.good])
def test_good_example_has_no_finding(code: str) -> None:
    assert findings(MODEL_CODES[code].good) == ()


def test_every_reported_code_is_explained() -> None:
    reported = {
        code
        for room in ("frontend", "formats/loading")
        for path in (TACHK / room).rglob("*.py")
        for code in re.findall(r'"([EW]0\d{3})"', path.read_text("utf-8"))
    }
    others = {code for group in ("observers", "semantic_lint", "statistics") for code in explanations(group)}
    assert reported - others == set(MODEL_CODES)
