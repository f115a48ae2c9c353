"""Light pictures that are dark where the reader prefers it."""

from __future__ import annotations

import re

_DARK = re.compile(r"\n@media \(prefers-color-scheme:dark\)\{\n(?:[^}\n]*\}\n)*\}")


def with_dark(light: str, dark: str) -> str:
    """A style sheet with other rules for dark screens, each rule on a line of its own."""
    return f"{light}\n@media (prefers-color-scheme:dark){{\n{dark}\n}}"


def always_light(svg: str) -> str:
    """The picture without its rules for dark screens: for paper, and for programs that know no such rules."""
    return _DARK.sub("", svg)
