"""Standard input, awaited until the time is over. A value change dump is kept in a file, for it is read twice."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from tachk.base.awaited_pipe import awaited_pipe
from tachk.base.job import check_job

_PIECE = 1 << 16


class StandardInput:
    """A stream of bytes. Reading raises OutOfTimeError where nothing comes before the time is over."""

    def __init__(self) -> None:
        self._read1 = _reader()
        self._waiting = b""
        self._ended = False

    def begins_dump(self) -> bool:
        """Whether it begins as a value change dump does, with a keyword such as ``$date``."""
        while not self._waiting.strip() and self._take():
            pass
        return self._waiting.lstrip().startswith(b"$")

    def readline(self, size: int = -1, /) -> bytes:
        pieces = [self._waiting]
        length = len(self._waiting)
        while b"\n" not in pieces[-1] and not 0 <= size <= length:
            self._waiting = b""
            if not self._take():
                break
            pieces.append(self._waiting)
            length += len(self._waiting)
        whole = b"".join(pieces)
        end = whole.find(b"\n") + 1 or len(whole)
        end = min(end, size) if size >= 0 else end
        line, self._waiting = whole[:end], whole[end:]
        return line

    def read1(self, size: int = -1, /) -> bytes:
        if not self._waiting:
            self._take()
        size = size if size >= 0 else len(self._waiting)
        piece, self._waiting = self._waiting[:size], self._waiting[size:]
        return piece

    def close(self) -> None:
        """It belongs to the program."""

    def _take(self) -> bool:
        """Adds what comes next; False at the end."""
        while not self._ended:
            check_job()
            piece = self._read1(_PIECE)
            if piece is not None:
                self._waiting += piece
                self._ended = not piece
                return not self._ended
        return False


@contextmanager
def dump_in_a_file(stream: StandardInput) -> Iterator[str]:
    """Reads standard input to its end; gives the path of a file that has it, as long as it is used."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "standard_input.vcd"
        with path.open("wb") as file:
            while piece := stream.read1():
                file.write(piece)
        yield str(path)


def _reader() -> Callable[[int], bytes | None]:
    buffer = sys.stdin.buffer
    try:
        descriptor = buffer.fileno()
    except OSError:  # a stream that lives in memory
        return getattr(buffer, "read1", buffer.read)
    return awaited_pipe(descriptor).read1
