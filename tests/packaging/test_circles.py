"""No module needs itself in the end, not even for the sake of its types, and no package of modules either."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from pathlib import Path

import grimp
import networkx as nx
import pytest

from tests.support.sources import tree_of

SOURCES = Path(__file__).parents[2] / "src/tachk"

FACE = "tachk"
"""The package names what it offers, for type checkers; grimp takes `from tachk import _core` for an import of it."""

ONE_LANGUAGE = {f"tachk.syntax.{name}" for name in ("building", "formulas", "parsing", "printing")}
"""Formulas are a part of the language: its parser reads them, its builder builds them, its queries are printed with
them. Their own room has what is about nothing else."""


@pytest.fixture(scope="module")
def imports() -> list[tuple[str, str]]:
    graph = grimp.build_graph("tachk", exclude_type_checking_imports=False, cache_dir=None)
    return [
        (module, other)
        for module in graph.modules
        for other in graph.find_modules_directly_imported_by(module)
        if FACE not in (module, other)
    ]


def circles(arrows: Iterable[tuple[str, str]]) -> list[set[str]]:
    return [found for found in nx.strongly_connected_components(nx.DiGraph(arrows)) if len(found) > 1]


def room(module: str) -> str:
    """The package that a module is in, or that it is."""
    path = SOURCES.parent / module.replace(".", "/")
    return module if path.is_dir() else module.rpartition(".")[0]


def test_no_module_is_in_a_circle(imports: list[tuple[str, str]]) -> None:
    assert circles(imports) == []


def test_no_package_is_in_a_circle(imports: list[tuple[str, str]]) -> None:
    arrows = {(room(module), room(other)) for module, other in imports}
    apart = [(one, two) for one, two in arrows if not f"{one}.".startswith(f"{two}.") and not two.startswith(f"{one}.")]
    assert [circle for circle in circles(apart) if not circle <= ONE_LANGUAGE] == []


def test_modules_come_through_their_own_doors() -> None:
    """Nothing below imports what the package itself offers."""
    for path in SOURCES.rglob("*.py"):
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.ImportFrom) and node.module == "tachk":
                assert {alias.name for alias in node.names} <= {"_core", *(p.stem for p in SOURCES.iterdir())}, path
