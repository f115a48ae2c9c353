"""Whether the files that a server has loaded, or may load, are still the same."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator

from tachk.base.resources import data_root
from tachk.cli.server.identity import package_folder

_DATA = ("grammar", "templates")
"""Folders of data that stay in memory once they are read."""

_Stamp = tuple[int, int, int] | None


def loaded_files() -> set[str]:
    """The files of tachk, and of all modules that are loaded now."""
    folders = (package_folder(), *(os.path.join(data_root(), name) for name in _DATA))
    loaded = (getattr(module, "__file__", None) for module in [*sys.modules.values()])
    return {path for folder in folders for path in _below(folder)} | {path for path in loaded if path is not None}


class Sources:
    """Files as they are now."""

    def __init__(self, paths: Iterable[str]) -> None:
        self._stamps = {path: _stamp(path) for path in paths}

    def changed(self) -> bool:
        """True once one of them is another file, or none."""
        return any(_stamp(path) != stamp for path, stamp in self._stamps.items())


def _below(folder: str) -> Iterator[str]:
    """The files in a folder, without those in which Python stores what it has compiled."""
    for path, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if name != "__pycache__"]
        yield from (os.path.join(path, name) for name in files)


def _stamp(path: str) -> _Stamp:
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino
