"""Files that are kept compressed, by gzip or Zstandard: read as what is in them."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from io import BufferedReader, RawIOBase
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

from tachk.base.diagnostics.diagnostic import UsageError

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

COMPRESSED_SUFFIXES = (".gz", ".zst")
"""That stand behind the ending of what is compressed: `log.csv.gz`."""


def plain_suffix(path: Path) -> str:
    """The ending of what is in a file, in lower case."""
    own = path.suffix.lower()
    return path.with_suffix("").suffix.lower() if own in COMPRESSED_SUFFIXES else own


def is_compressed(path: Path) -> bool:
    """Whether the name of a file says so."""
    return path.suffix.lower() in COMPRESSED_SUFFIXES


class TornStream(RawIOBase):
    """What is in a compressed file, up to where that is cut off or damaged.

    Attributes:
        torn: why it ended before its end; None: it has not.
    """

    def __init__(self, inner: IO[bytes]) -> None:
        self._inner = inner
        self.torn: str | None = None

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: WriteableBuffer, /) -> int:
        try:
            piece = self._inner.read(memoryview(buffer).nbytes) if self.torn is None else b""
        except (EOFError, OSError, zlib.error, ValueError) as error:
            self.torn = str(error) or type(error).__name__
            return 0
        except Exception as error:  # each library of Zstandard has errors of its own
            if "zstd" not in type(error).__name__.lower():
                raise
            self.torn = str(error) or type(error).__name__
            return 0
        memoryview(buffer).cast("B")[: len(piece)] = piece
        return len(piece)

    def close(self) -> None:
        self._inner.close()
        super().close()


def open_bytes(path: Path) -> BufferedReader:
    """Opens a file, and decompresses it if its name says that it is compressed.

    The raw stream of a compressed file is a `TornStream`. Raises OSError, and UsageError where no library is there.
    """
    if not is_compressed(path):
        return path.open("rb")
    opened: Callable[..., Any] = import_module("gzip").open if path.suffix.lower() == ".gz" else _zstandard()
    return BufferedReader(TornStream(opened(path, "rb")))


def torn(stream: object) -> str | None:
    """Why a stream of `open_bytes` that has been read ended before its end; None: it has not."""
    raw = getattr(stream, "raw", None)
    return raw.torn if isinstance(raw, TornStream) else None


def _zstandard() -> Callable[..., Any]:
    for library in ("compression.zstd", "zstandard"):  # the first one is part of Python 3.14
        with suppress(ImportError):
            opened: Callable[..., Any] = import_module(library).open
            return opened
    message = "files compressed by Zstandard are read by zstandard, which is not installed"
    raise UsageError(message, "pip install zstandard")
