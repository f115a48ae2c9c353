"""The examples of docs/language.md load, or are refused as they say."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

DOCUMENT = Path(__file__).resolve().parents[3] / "docs" / "language.md"
EXAMPLES = re.findall(r"^```ta(?: refused (\w+))?\n(.*?)^```", DOCUMENT.read_text("utf-8"), re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize(("code", "text"), EXAMPLES)
def test_example(find: Callable[[str], list[tuple[str, str]]], code: str, text: str) -> None:
    errors = [found for found, _ in find(text) if found.startswith("E")]
    assert errors == ([code] if code else [])
