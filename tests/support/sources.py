"""The syntax trees of Python files, each parsed once for all tests of a process."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path


@cache
def tree_of(path: Path) -> ast.Module:
    """The syntax tree of a file. Tests must not change it."""
    return ast.parse(path.read_text(encoding="utf-8"))
