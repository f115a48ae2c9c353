"""Files that are written whole or not at all: a program that is interrupted leaves the file of before."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, BinaryIO, TextIO

from tachk.base.unfinished_files import UNFINISHED, own_prefix, remove

if TYPE_CHECKING:
    from pathlib import Path

_TRIES = 100


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """The path of a new file, which takes the place of ``path`` where the block ends well and is removed elsewhere.

    A device or a pipe is written to as it is, and so is a file in a folder that takes no new ones. Raises OSError.
    """
    from pathlib import Path

    target = Path(os.path.realpath(path))
    part = _empty_part(target) if target.is_file() or not target.exists() else None
    if part is None:
        yield path
        return
    try:
        yield part
        if part.exists():
            os.replace(part, target)
    finally:
        remove(str(part))


@contextmanager
def whole_text(path: Path, encoding: str = "utf-8", newline: str | None = None) -> Iterator[TextIO]:
    """A text that becomes the content of a file where the block ends well. Raises OSError."""
    with whole_file(path) as part, part.open("w", encoding=encoding, newline=newline) as file:
        yield file


@contextmanager
def whole_bytes(path: Path) -> Iterator[BinaryIO]:
    """As `whole_text`, of bytes."""
    with whole_file(path) as part, part.open("wb") as file:
        yield file


def write_whole(path: Path, content: str | bytes, newline: str | None = None) -> None:
    """Gives a file a content, all of it at once. A text is written in UTF-8. Raises OSError."""
    if isinstance(content, bytes):
        with whole_bytes(path) as file:
            file.write(content)
    else:
        with whole_text(path, newline=newline) as text:
            text.write(content)


def _empty_part(target: Path) -> Path | None:
    """A new file beside another one, with its permissions; None where there can be none."""
    if target.exists() and not os.access(target, os.W_OK):
        return None
    for number in range(_TRIES):
        part = target.with_name(f"{own_prefix()}{number}.part")
        if str(part) in UNFINISHED:
            continue
        UNFINISHED.add(str(part))  # before it is there: an interrupt may come in between
        try:
            os.close(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        except FileExistsError:
            UNFINISHED.discard(str(part))
            continue
        except OSError:
            UNFINISHED.discard(str(part))
            return None
        with suppress(OSError):
            os.chmod(part, stat.S_IMODE(target.stat().st_mode))
        return part
    return None
