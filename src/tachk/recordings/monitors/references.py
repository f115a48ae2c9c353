"""Formulas of a file that name each other: ``both: answered && G ready`` beside ``answered: G (p -> F[0, 5] q)``."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import cache
from typing import Any

from tachk.recordings.monitors.compiler import columns_read
from tachk.syntax import ast
from tachk.syntax.formula import Atom, Formula
from tachk.syntax.rewrite import rewrite


def expanded(formula: Formula, named: Mapping[str, Formula], columns: Collection[str] = ()) -> Formula:
    """The formula with other formulas in place of their names.

    Args:
        named: the formulas that can be named.
        columns: of the trace; a name of one means the column.

    A name that occurs in what it names, directly or through others, means a column everywhere.
    """
    known = {name: named[name] for name in references(formula, named) if name not in columns}
    if not known:
        return formula

    @cache
    def whole(name: str) -> Formula:
        return rewrite(known[name], change)

    def change(node: Any) -> Any:
        match node:
            case Atom(expression=ast.NameExpression(name=name)) if name in known:
                return whole(name)
            case _:
                return node

    return rewrite(formula, change)


def references(formula: Formula, named: Mapping[str, Formula]) -> frozenset[str]:
    """The names in a formula, and in those that it names, which mean formulas if no column has them."""
    found: set[str] = set()
    pending = [formula]
    while pending:
        for name in (columns_read(pending.pop()) & named.keys()) - found:
            if name not in _inside(name, named):
                found.add(name)
                pending.append(named[name])
    return frozenset(found)


def circle(name: str, named: Mapping[str, Formula]) -> tuple[str, ...]:
    """The formulas by which one names itself, from it to itself in as few steps as there are; empty if it does not."""
    paths: dict[str, tuple[str, ...]] = {}
    pending: list[tuple[str, ...]] = [(name,)]
    for path in pending:
        for inner in sorted(columns_read(named[path[-1]])):
            if inner == name:
                return (*path, name)
            if inner in named and inner not in paths:
                paths[inner] = (*path, inner)
                pending.append(paths[inner])
    return ()


def _inside(name: str, named: Mapping[str, Formula]) -> frozenset[str]:
    """The names in a formula, and in those that it names."""
    found: set[str] = set()
    pending = [name]
    while pending:
        for inner in columns_read(named[pending.pop()]) - found:
            found.add(inner)
            if inner in named:
                pending.append(inner)
    return frozenset(found)
