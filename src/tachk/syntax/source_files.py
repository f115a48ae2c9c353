"""Reading a model or query file: what is not text is refused at once, what is only odd is tolerated."""

from __future__ import annotations

import os
import re

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.base.span import Source, Span

LARGEST_FILE = 8 * 1024 * 1024
"""Bytes. The largest public model has less than two megabytes."""

_TCHECKER = re.compile(r"(?:\s|#[^\n]*\n)*system[ \t]*:")
_PROBE = 64 * 1024
_CONTROL = frozenset(range(32)) - frozenset(b"\t\n\r\f\v\x1a")


LARGEST_RUN = 1024 * 1024 * 1024
"""Bytes. A run of ten million steps has 400 megabytes."""


def read_source(path: str | os.PathLike[str], what: str = "a model", most: int = LARGEST_FILE) -> Source:
    """The text of a file, in UTF-8 with or without a byte order mark, or else Latin-1.

    Args:
        what: it holds, for messages.
        most: bytes.

    Raises:
        UsageError: there is no such file, it cannot be read, it is a directory, or it is too large.
        InputError: E0001, it is not text; E0006, there is nothing in it.
    """
    name = os.fspath(path)
    try:
        with open(name, "rb") as stream:
            start = stream.read(_PROBE)
            _refuse_binary(name, start)
            size = os.fstat(stream.fileno()).st_size
            if size > most:
                raise UsageError(f"{name} is too large for {what}: {size} bytes, at most {most}")
            data = start + stream.read(most + 1 - len(start))
    except FileNotFoundError:
        raise UsageError(f"there is no file {name}") from None
    except IsADirectoryError:
        raise UsageError(f"{name} is a directory", "name a file in it") from None
    except (PermissionError, OSError) as error:
        raise UsageError(f"{name} cannot be read: {error.strerror or error}") from None
    except ValueError as error:
        raise UsageError(f"{name!r} is not a file name: {error}") from None
    if len(data) > most:
        raise UsageError(f"{name} is too large for {what}: at most {most} bytes")
    source = Source(name, _decode(name, data))
    if not source.text.strip():
        raise InputError([Diagnostic("E0006", "the file is empty", Span(source, 0, 0))])
    return source


def is_xml(source: Source) -> bool:
    """True if a text looks like XML: no model written as text begins with ``<``."""
    return source.text.lstrip("\ufeff \t\r\n").startswith("<")


def is_tchecker(source: Source) -> bool:
    """True if a text begins as TChecker's files do; no model of another kind does."""
    return _TCHECKER.match(source.text) is not None


def _refuse_binary(name: str, data: bytes) -> None:
    """Refuses content that no text has: null bytes (unless UTF-16) and other control characters in number."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise _no_text(name, "it is UTF-16 text", "save it as UTF-8")
    controls = sum(byte in _CONTROL for byte in data)
    if b"\0" in data or controls > len(data) // 100:
        raise _no_text(name, "it holds binary data", "is it an archive, or a compiled file?")


def _decode(name: str, data: bytes) -> str:
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
        controls = sum(0x80 <= byte < 0xA0 for byte in data)
        if controls > 8 + len(data) // 50:
            raise _no_text(name, "it is neither UTF-8 nor Latin-1", "save it as UTF-8") from None
    if "\0" in text:
        raise _no_text(name, "it holds binary data", None)
    return text


def _no_text(name: str, what: str, help: str | None) -> InputError:
    return InputError([Diagnostic("E0001", f"this is not a model: {what}", Span(Source(name, ""), 0, 0), help)])
