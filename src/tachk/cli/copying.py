"""Copying files that come with tachk to where a user wants them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.whole_files import write_whole


def copy_files(targets: Mapping[Path, Path], overwrite: bool, help: str) -> None:
    """Copies each file to its target, and prints the targets.

    Args:
        overwrite: replace files with other contents.
        help: what to do about such a file.

    Raises UsageError, before anything is written, for a file that is different and would be lost.
    """
    for path, target in targets.items():
        if not overwrite and target.exists() and target.read_bytes() != path.read_bytes():
            raise UsageError(f"{target} is there and different", help)
    for path, target in targets.items():
        target.parent.mkdir(parents=True, exist_ok=True)
        write_whole(target, path.read_bytes())
        print(f"written: {target}")
