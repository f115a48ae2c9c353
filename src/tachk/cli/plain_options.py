"""Options of `tachk verify` that can also be read without click, whose import takes as long as a small verification.

`tachk.cli.options` makes the options of the command of the same rows.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping, Sequence
from enum import Enum

from tachk.base.records import dataclass


class Kind(Enum):
    """What an option takes."""

    FLAG = "nothing"
    TEXT = "text"
    FILE = "file"


@dataclass(frozen=True, slots=True)
class PlainOption:
    """An option whose value is taken as it is.

    Attributes:
        parameter: the name of its value.
        names: as one types it.
        metavar: its value in the help.
        several: it can be given several times, and the value has them all.
    """

    parameter: str
    names: tuple[str, ...]
    kind: Kind = Kind.TEXT
    metavar: str = ""
    several: bool = False


DEFINITIONS = PlainOption("definitions", ("-D", "--define"), metavar="NAME=EXPR", several=True)
PROPERTIES = PlainOption("properties", ("--property",), metavar="NAME", several=True)
QUERY_FILES = PlainOption("query_files", ("-q", "--queries"), Kind.FILE, "FILE", several=True)
QUIET = PlainOption("quiet", ("--quiet",), Kind.FLAG)
FORM = PlainOption("form", ("--format",))

_OPTIONS = {name: option for option in (DEFINITIONS, PROPERTIES, QUERY_FILES, QUIET, FORM) for name in option.names}


def plain_values(words: Sequence[str], forms: Collection[str]) -> Mapping[str, object] | None:
    """The values of the parameters of `tachk verify` that are given, as click would read them.

    None for whatever is not only models, queries and the options above, each in a word of its own and with its value in
    the next one: click reads it, or says what is wrong.

    Args:
        words: behind the name of the command.
        forms: of reports.
    """
    arguments: list[str] = []
    given: dict[str, object] = {}
    left = iter(words)
    for word in left:
        if not word.startswith("-"):
            arguments.append(word)
            continue
        option = _OPTIONS.get(word)
        if option is None:
            return None
        if option.kind is Kind.FLAG:
            given[option.parameter] = True
            continue
        text = next(left, "-")
        if text.startswith("-") or (option is FORM and text not in forms):
            return None
        value: object = text
        if option.kind is Kind.FILE:
            if _is_unreadable(text):
                return None
            from pathlib import Path  # takes as long as twenty modules here

            value = Path(text)
        before = given.get(option.parameter, ())
        assert isinstance(before, tuple | str)
        given[option.parameter] = (*before, value) if option.several else value
    if not arguments or any(map(_is_unreadable, arguments)):
        return None
    return {**given, "arguments": tuple(arguments)}


def _is_unreadable(path: str) -> bool:
    """True for a file or folder that may not be read: click says so, of queries that are names of such files, too."""
    return not os.access(path, os.R_OK) and os.path.exists(path)
