"""Docstrings as griffe reads them: this project writes some lists of attributes and parameters more briefly."""

from __future__ import annotations

import re
from textwrap import indent
from typing import Any

_GROUP = re.compile(r"^(?P<indent> +)(?P<names>\w+(?:, \w+)+):(?P<text>.*(?:\n(?P=indent) +\S.*)*)", re.MULTILINE)
_FLUSH = re.compile(r"\AAttributes:\n(?P<items>(?! ).*)\Z", re.DOTALL)


def readable(docstring: str) -> str:
    """A docstring with an entry for each name: `low, high: bounds` becomes two with the same text.

    The entries of a list that begins on the first line are not indented in this project; here they are.
    """

    def entries(found: re.Match[str]) -> str:
        return "\n".join(f"{found['indent']}{name}:{found['text']}" for name in found["names"].split(", "))

    flush = _FLUSH.match(docstring)
    return _GROUP.sub(entries, f"Attributes:\n{indent(flush['items'], '    ')}" if flush else docstring)


try:
    from griffe import Extension
except ImportError:  # only a build of the site has it
    Extension = object


class ReadableDocstrings(Extension):  # type: ignore[misc]
    """What griffe calls for each object that it has read."""

    def on_object(self, *, obj: Any, **_: Any) -> None:
        if obj.docstring is not None:
            obj.docstring.value = readable(obj.docstring.value)
