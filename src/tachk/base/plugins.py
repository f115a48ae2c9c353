"""What extends tachk from above: rows of tables that lower packages read and do not import.

A row is named ``module:object`` and loaded when its table is first read. Packages that are installed beside tachk add
rows by entry points of the group ``tachk.GROUP``.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from typing import Any

_BUILT_IN = {"captures": ("tachk.xrce.captures:DDS_XRCE",)}


@cache
def plugins(group: str) -> tuple[Any, ...]:
    """The rows of a table: those that come with tachk, then those of other packages in the order of their names."""
    own = (_loaded(row) for row in _BUILT_IN.get(group, ()))
    others = (each.load() for each in sorted(entry_points(group=f"tachk.{group}"), key=lambda each: each.name))
    return (*own, *others)


def _loaded(row: str) -> Any:
    module, _, name = row.partition(":")
    return getattr(import_module(module), name)
