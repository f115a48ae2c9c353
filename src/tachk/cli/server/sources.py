"""Whether the files that a server has loaded are still the same."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable

from tachk.base.resources import data_root

_Stamp = tuple[int, int, int] | None


def loaded_files() -> set[str]:
    """The files of which something is in the memory of this process, but for those of Python itself.

    A copy loads what else it needs from the files that are there then, as every program does.
    """
    library = os.path.dirname(os.path.abspath(os.__file__))
    packages = os.path.join(library, "site-packages")
    loaded = {getattr(module, "__file__", None) or "" for module in [*sys.modules.values()]}
    others = {path for path in loaded if path and (not path.startswith(library) or path.startswith(packages))}
    grammar = os.path.join(data_root(), "grammar")
    return {sys.executable, *others, *(os.path.join(grammar, name) for name in os.listdir(grammar))}


class Sources:
    """Files as they are now."""

    def __init__(self, paths: Iterable[str]) -> None:
        self._stamps = {path: _stamp(path) for path in paths}

    def changed(self) -> bool:
        """True once one of them is another file, or none."""
        return any(_stamp(path) != stamp for path, stamp in self._stamps.items())


def _stamp(path: str) -> _Stamp:
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino
