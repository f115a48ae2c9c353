"""Docstrings name what there is."""

from __future__ import annotations

import ast
import builtins
import re
from pathlib import Path

import pytest

import tachk
from tests.support.sources import tree_of

PACKAGE = Path(tachk.__file__).parent
MODULES = sorted(PACKAGE.rglob("*.py"))


def names_in_code(path: Path) -> set[str]:
    """What a module defines, uses or imports."""
    found = {path.stem}
    for node in ast.walk(tree_of(path)):
        match node:
            case ast.Name(id=name) | ast.Attribute(attr=name) | ast.arg(arg=name) | ast.alias(name=name):
                found.update(name.split("."))
            case ast.ClassDef(name=name) | ast.FunctionDef(name=name) | ast.keyword(arg=str(name)):
                found.add(name)
    return found


def test_exceptions_exist() -> None:
    there = {name for path in MODULES for name in names_in_code(path)} | set(dir(builtins))
    missing = []
    for path in MODULES:
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
                said = re.findall(r"\b[A-Z]\w*(?:Error|Exception)\b", ast.get_docstring(node) or "")
                missing += [(path.name, name) for name in said if name not in there]
    assert missing == []


@pytest.mark.parametrize(
    "package", [path.parent for path in MODULES if path.name == "__init__.py"], ids=lambda path: path.name
)
def test_the_modules_that_a_package_names_exist(package: Path) -> None:
    """A name in the docstring of a package is a module or a folder in it, or stands in its code."""
    said = re.findall(r"`([a-z_]+)`", ast.get_docstring(tree_of(package / "__init__.py")) or "")
    there = {path.name.removesuffix(".py") for path in package.iterdir()}
    for path in package.rglob("*.py"):
        there |= names_in_code(path)
    assert [name for name in said if name not in there] == []
