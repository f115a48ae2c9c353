"""Every object that a table names as ``module:object`` is there."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

import tachk
from tachk.base.plugins import load_object

ROOT = Path(tachk.__file__).parent
_ROW = re.compile(r"tachk\.[\w.]+:\w+")
ROWS = sorted(
    {
        str(node.value)
        for path in ROOT.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and _ROW.fullmatch(str(node.value))
    }
)


@pytest.mark.parametrize("row", ROWS)
def test_a_row_names_an_object(row: str) -> None:
    assert load_object(row) is not None


def test_tables_are_found() -> None:
    assert {"tachk.formats.dot:export_dot", "tachk.report.json_report:JsonReport"} <= set(ROWS)
