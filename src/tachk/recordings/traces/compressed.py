"""Files that are kept compressed, by gzip or Zstandard: read as what is in them."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from io import BufferedReader, RawIOBase
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, cast

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.optional_packages import optional_packages

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

COMPRESSED_SUFFIXES = (".gz", ".zst")
"""Suffixes behind the ending of the compressed file: `log.csv.gz`."""


_PIECE = 1 << 13
"""Bytes that are decompressed at a time: a thousand times as many may come of them."""


def plain_suffix(path: Path) -> str:
    """The ending of the uncompressed file, in lower case."""
    own = path.suffix.lower()
    return path.with_suffix("").suffix.lower() if own in COMPRESSED_SUFFIXES else own


def is_compressed(path: Path) -> bool:
    """True if the name of a file says so."""
    return path.suffix.lower() in COMPRESSED_SUFFIXES


class Decompressor(Protocol):
    """Takes one stream or frame after the other; files may have several, as `cat a.gz b.gz` makes them."""

    @property
    def eof(self) -> bool: ...

    @property
    def unused_data(self) -> bytes: ...

    def decompress(self, data: bytes, /) -> bytes: ...


class TornStream(RawIOBase):
    """The content of a compressed file, up to where it is cut off or damaged.

    Attributes:
        torn: why it ended before its end; None: it has not.
    """

    def __init__(self, path: Path, decompressor: Callable[[], Decompressor]) -> None:
        self._path = path
        self._inner = path.open("rb")
        self._decompressor = decompressor
        self._current: Decompressor | None = None
        self._ready = memoryview(b"")
        self._any = False
        self.torn: str | None = None

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: WriteableBuffer, /) -> int:
        target = memoryview(buffer).cast("B")
        while not self._ready and self._more():
            pass
        count = min(len(target), len(self._ready))
        target[:count] = self._ready[:count]
        self._ready = self._ready[count:]
        return count

    def _more(self) -> bool:
        """Decompresses the next bytes; False: there is no more. Raises UsageError if nothing at all can be read."""
        if self.torn is not None:
            return False
        try:
            piece = self._left() or self._inner.read(_PIECE)
            if not piece:
                if self._current is not None:
                    self.torn = "the compressed data ends before its end"
            else:
                self._current = self._current or self._decompressor()
                self._ready = memoryview(self._current.decompress(piece))
        except Exception as error:  # each library has errors of its own, and Zstandard has several libraries
            if not isinstance(error, zlib.error) and "zstd" not in type(error).__name__.lower():
                raise
            self.torn = str(error) or type(error).__name__
        self._any = self._any or len(self._ready) > 0
        if self.torn is not None and not self._any:
            raise UsageError(f"{self._path} cannot be decompressed: {self.torn}")
        return self.torn is None and bool(piece)

    def _left(self) -> bytes:
        """The stream or frame that follows the one that has just ended."""
        if self._current is None or not self._current.eof:
            return b""
        left = self._current.unused_data
        self._current = None
        return left.lstrip(b"\0")  # gzip allows to fill a file with zeros

    def close(self) -> None:
        self._inner.close()
        super().close()


def open_bytes(path: Path) -> BufferedReader:
    """Opens a file, and decompresses it if its name says that it is compressed.

    The raw stream of a compressed file is a `TornStream`. Raises OSError, and UsageError where no library is there.
    """
    if not is_compressed(path):
        return path.open("rb")
    return BufferedReader(TornStream(path, _gzip if path.suffix.lower() == ".gz" else _zstandard()))


def torn(stream: object) -> str | None:
    """The reason why a stream of `open_bytes` that has been read broke off early; None: it did not."""
    raw = getattr(stream, "raw", None)
    return raw.torn if isinstance(raw, TornStream) else None


def _gzip() -> Decompressor:
    return zlib.decompressobj(16 + zlib.MAX_WBITS)


def _zstandard() -> Callable[[], Decompressor]:
    with suppress(ImportError):  # a part of Python 3.14
        made: Callable[[], Decompressor] = import_module("compression.zstd").ZstdDecompressor
        return made
    with optional_packages():
        library: Any = import_module("zstandard")
    return lambda: cast("Decompressor", library.ZstdDecompressor().decompressobj())
