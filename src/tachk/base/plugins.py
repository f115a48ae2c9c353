"""Objects that tables name as ``module:object``, and that are loaded when they are needed.

Rows of tables that lower packages read and whose modules stand in higher ones, which they do not import; distributions
of their own that tachk calls where they are installed; formats, of which a command line uses one.
"""

from __future__ import annotations

from functools import cache
from importlib import import_module
from typing import Any

from tachk.base.optional_packages import MissingPackageError

_ROWS = {
    "captures": ("tachk.xrce.captures:DDS_XRCE",),
    "adapters": ("tachk.xrce.testing.adapters:ADAPTERS",),
}
_SEPARATE = {"munta export": "tachk_munta.writer:to_muntax", "munta proofs": "tachk_munta.proofs:write_proofs"}


@cache
def plugins(table: str) -> tuple[Any, ...]:
    """The rows of a table, in order."""
    return tuple(map(load_object, _ROWS[table]))


def separate_plugin(use: str) -> Any:
    """The function that a distribution of its own has for a use.

    Raises:
        MissingPackageError: it is not installed; names what to install.
    """
    row = _SEPARATE[use]
    package = row.partition(".")[0]
    try:
        import_module(package)
    except ModuleNotFoundError:
        distribution = package.replace("_", "-")
        raise MissingPackageError(
            f"the plug-in {distribution} is not installed", f"pip install {distribution}"
        ) from None
    return load_object(row)


def load_object(row: str) -> Any:
    """The object that a row names, such as ``tachk.formats.dot:to_dot``."""
    module, _, name = row.partition(":")
    return getattr(import_module(module), name)
