"""Tables that lower packages read and whose rows stand in higher ones, which they do not import.

A row is named ``module:object`` and loaded when its table is first read.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import Any

_ROWS = {"captures": ("tachk.xrce.captures:DDS_XRCE",)}


@cache
def plugins(table: str) -> tuple[Any, ...]:
    """The rows of a table, in order."""
    return tuple(map(_loaded, _ROWS[table]))


def _loaded(row: str) -> Any:
    module, _, name = row.partition(":")
    return getattr(import_module(module), name)
