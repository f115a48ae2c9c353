"""The text of a value change dump, from which a half-written end is left out."""

from __future__ import annotations

import re
from collections.abc import Collection
from io import RawIOBase
from pathlib import Path
from typing import TYPE_CHECKING, Final

from tachk.recordings.traces.compressed import open_bytes, torn

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

_BEYOND_ASCII = bytes(byte if byte < 128 else ord("?") for byte in range(256))
_LONGEST_LINE: Final = 1 << 20
"""Bytes that are held back of a last line."""

_TIME = re.compile(rb"#\d+")
_SCALAR = re.compile(rb"[01xXzZuUwWlLhH-](?P<code>.+)")
_VALUES = (b"b", b"B", b"r", b"R", b"s", b"S")


class VcdStream(RawIOBase):
    """A file in which each byte beyond ASCII reads as a question mark. The standard knows ASCII only, yet localised
    dates and names of people stand in comments, in whatever encoding.

    A last line without a line break may be half written: its last word is left out unless it is whole, whatever might
    follow. A time is read, for its first digits are no later than the whole time.

    Attributes:
        half_written: something of the last line was left out.
        open_line: the number of the last line, where that has no line break and has been read.
        open_time: that line ends with a time.
        open_instant: the file is cut off before all changes of its last instant are known to be there.
    """

    def __init__(self, name: str, codes: Collection[str] = ()) -> None:
        """Opens a file. Raises OSError.

        Args:
            codes: of all variables; a change is whole that ends with one with which no other begins.
        """
        self._stream = open_bytes(Path(name))
        self._codes = frozenset(code.encode() for code in codes)
        self._ready = b""
        self._tail = b""
        self._line = 1
        self._ended = False
        self.half_written = False
        self.open_line: int | None = None
        self.open_time = False
        self.open_instant = False

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: WriteableBuffer, /) -> int:
        seen = memoryview(buffer)
        while not self._ready and not self._ended:
            self._take(self._stream.read1(seen.nbytes))
        piece, self._ready = self._ready[: seen.nbytes], self._ready[seen.nbytes :]
        seen[: len(piece)] = piece
        return len(piece)

    def _take(self, read: bytes) -> None:
        if not read:
            self._ended = True
            self.open_instant = self.torn is not None
            # pyvcd would read the name for ever with which a file ends: a line break follows
            self._ready = self._whole(self._tail) + b"\n"
            return
        whole, line_break, tail = (self._tail + read.translate(_BEYOND_ASCII)).rpartition(b"\n")
        if len(tail) > _LONGEST_LINE:
            whole, tail = whole + line_break + tail[:-_LONGEST_LINE], tail[-_LONGEST_LINE:]
            line_break = b""
        self._line += whole.count(b"\n") + len(line_break)
        self._ready, self._tail = whole + line_break, tail

    def _whole(self, line: bytes) -> bytes:
        """The complete part of a last line without a line break."""
        words = line.split()
        if not words:
            return b""
        self.open_line = self._line
        place = 0
        while place < len(words) - 1:
            place += 2 if words[place].startswith(_VALUES) else 1
        last = words[-1]
        if place == len(words) - 1:  # a word of its own
            change = _SCALAR.fullmatch(last)
            self.open_time = _TIME.fullmatch(last) is not None and line.endswith(last)
            complete = self.open_time or last == b"$end" or (change is not None and self._is_code(change["code"]))
            needs_code = last.startswith(_VALUES)
        else:  # the code behind a value
            complete, needs_code = self._is_code(last), False
        if complete or (line[-1:].isspace() and not needs_code):
            return line
        self.half_written = True
        self.open_instant = not last.startswith(b"#")
        return line[: line.rindex(last)]

    def _is_code(self, word: bytes) -> bool:
        return word in self._codes and not any(code != word and code.startswith(word) for code in self._codes)

    @property
    def torn(self) -> str | None:
        """The reason why a compressed file that has been read broke off early."""
        return torn(self._stream)

    def close(self) -> None:
        self._stream.close()
        super().close()
