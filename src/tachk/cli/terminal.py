"""The abilities of the program's streams (colours, characters, width), and its end by a signal."""

from __future__ import annotations

import codecs
import os
import re
import signal
import sys
from typing import IO, TYPE_CHECKING, NoReturn, TextIO, cast

from tachk.base.exact_numbers import is_whole

if TYPE_CHECKING:
    from rich.console import Console

_WIDTH = 1000
"""Columns of a report that does not go to a terminal: wide enough for no line to be broken."""

_BLANKS = re.compile(r" +(?=\n)")

_SPELLINGS = {
    "→": "->",
    "←": "<-",
    "✓": "+",
    "✗": "x",
    "≤": "<=",
    "≥": ">=",
    "≠": "!=",
    "−": "-",
    "–": "-",
    "—": "-",
    "…": "...",
    "·": ".",
    "∞": "inf",
    "µ": "u",
    "μ": "u",
    "“": '"',
    "”": '"',
    "‘": "'",
    "’": "'",
}
"""Replacements for characters that tachk itself writes, for streams whose encoding lacks them."""


def prepare_streams() -> None:
    """Lets the standard streams replace characters that their encoding does not have, and what is not a text in it,
    instead of raising errors.

    A stream that is closed, as by ``>&-``, becomes one that drops everything: its output is not wanted, and its
    number must not become that of the next file that is opened.
    """
    codecs.register_error("tachk", _spelled)
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115
    for stream, errors in ((sys.stdin, "replace"), (sys.stdout, "tachk"), (sys.stderr, "tachk")):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors=errors)


def _spelled(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    text = error.object[error.start : error.end]
    return "".join(_SPELLINGS.get(character, "?") for character in text), error.end


def wants_colour(stream: TextIO) -> bool:
    """True if to colour: not with NO_COLOR, always with FORCE_COLOR, else on terminals that are not dumb."""
    if os.environ.get("NO_COLOR"):
        return False
    if os.environ.get("FORCE_COLOR", "0") not in ("", "0"):
        return stream in (sys.stdout, sys.stderr)
    return can_rewrite_lines(stream)


def can_rewrite_lines(stream: TextIO) -> bool:
    """True if a stream is a terminal that understands escape sequences."""
    return stream.isatty() and os.environ.get("TERM") != "dumb"


def width_of(stream: TextIO) -> int:
    """The columns of a terminal, `COLUMNS` of the environment first."""
    columns = os.environ.get("COLUMNS", "")
    if is_whole(columns) and int(columns) > 0:
        return int(columns)
    try:
        return os.get_terminal_size(stream.fileno()).columns or 80
    except (OSError, ValueError):
        return 80


class _WithoutBlanksAtEnds:
    """A stream that drops what only fills the last column of a table."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self.encoding = stream.encoding

    def write(self, text: str) -> int:
        self._stream.write(_BLANKS.sub("", text))
        return len(text)

    def flush(self) -> None:
        self._stream.flush()

    def isatty(self) -> bool:
        return False


def console(stream: TextIO) -> Console:
    """The console that prints reports on a stream."""
    from tachk.report.plain_console import ReportConsole

    plain = not stream.isatty() and not wants_colour(stream)
    return ReportConsole(
        file=cast("IO[str]", _WithoutBlanksAtEnds(stream)) if plain else stream,
        highlight=False,
        emoji=False,
        color_system="standard" if wants_colour(stream) else None,
        force_terminal=wants_colour(stream) or None,
        force_jupyter=False,
        width=width_of(stream) if stream.isatty() else _WIDTH,
    )


def end_by(number: signal.Signals) -> NoReturn:
    """Ends the program as the signal does by itself: a shell that sees this ends its loop, too."""
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
    sys.exit(128 + number)
