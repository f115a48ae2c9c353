"""Every code has one explanation, which is data and is read when it is asked for."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter

import pytest

from tachk.base.diagnostics.explanation import all_explanations, explanations, groups

WITHOUT_EXAMPLE = {
    "E0001",
    "E0006",
    "E0111",
    "E0115",
    "E0120",
    "E0121",
    "E0122",
    "E0123",
    "E0124",
    "E0125",
    "E0416",
    "E0608",
    "E0702",
    "E0707",
    "E0708",
    "E0709",
    "E0723",
    "E0729",
    "E0732",
    "E0769",
    "E0802",
    "E0803",
    "E0815",
    "E0819",
    "E0901",
    "E0902",
    "E0903",
    "E0904",
    "E0905",
    "E0906",
    "E0907",
    "E0917",
    "W0120",
    "W0121",
    "W0122",
    "W0123",
    "W0130",
    "W0501",
}
"""Codes whose defect a short text cannot show: of files, bytes, sizes, formats and command lines."""


def test_no_code_is_explained_twice() -> None:
    explained = Counter(code for group in groups() for code in explanations(group))
    assert [code for code, times in explained.items() if times > 1] == []
    assert set(explained) == set(all_explanations())


@pytest.mark.parametrize("group", groups())
def test_the_codes_of_a_group_are_complete_and_sorted(group: str) -> None:
    found = explanations(group)
    assert list(found) == sorted(found)
    for code, explanation in found.items():
        assert len(code) == 5 and code[0] in "EW" and code[1:].isdigit()
        assert explanation.title and explanation.why, code
        assert not explanation.title.endswith("."), code


def test_every_code_but_those_that_a_text_cannot_show_has_an_example() -> None:
    assert {code for code, found in all_explanations().items() if not found.bad} == WITHOUT_EXAMPLE
    assert {code for code, found in all_explanations().items() if found.good and not found.bad} == set()


def test_verifying_reads_no_explanation() -> None:
    program = """
import sys
import tachk
from tachk.cli.main import app
tachk.loads("process P() { init location a; } system P;").verify()
print("tomllib" in sys.modules)
"""
    printed = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    assert printed.strip() == "False"
