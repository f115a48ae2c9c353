"""Tables that lower packages read and whose rows stand in higher ones, which they do not import; and distributions of
their own that tachk calls where they are installed.

A row is named ``module:object`` and loaded when its table is first read.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError

_ROWS = {"captures": ("tachk.xrce.captures:DDS_XRCE",)}
_SEPARATE = {"munta export": "tachk_munta.writer:to_muntax", "munta proofs": "tachk_munta.proofs:write_proofs"}


@cache
def plugins(table: str) -> tuple[Any, ...]:
    """The rows of a table, in order."""
    return tuple(map(_loaded, _ROWS[table]))


def separate_plugin(use: str) -> Any:
    """The function that a distribution of its own has for a use.

    Raises:
        UsageError: it is not installed; names what to install.
    """
    row = _SEPARATE[use]
    package = row.partition(".")[0]
    try:
        import_module(package)
    except ModuleNotFoundError:
        distribution = package.replace("_", "-")
        raise UsageError(f"the plug-in {distribution} is not installed", f"pip install {distribution}") from None
    return _loaded(row)


def _loaded(row: str) -> Any:
    module, _, name = row.partition(":")
    return getattr(import_module(module), name)
