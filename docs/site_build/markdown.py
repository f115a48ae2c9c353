"""Text as Markdown: what is special in it is quoted, and stays what it was."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from textwrap import indent

CODE_OR_LINK = re.compile(
    r"(?P<fence>^(?P<marks>```+|~~~+)[^\n]*\n.*?^(?P=marks)[ ]*$)"
    r"|(?P<code>(?<!`)(?P<ticks>`+)(?!`)[^\n]*?(?<!`)(?P=ticks)(?!`))"
    r"|(?P<before>\]\()(?P<link>[^)\s]+)(?=\))"
    r"|(?P<attribute>\b(?:src|srcset|href)=\")(?P<value>[^\"\s]+)(?=\")",
    re.MULTILINE | re.DOTALL,
)
"""Code, in which nothing is a link, or the target of a link."""


def code(text: str) -> str:
    """Text in backticks, also where it has some itself; not for tables, see `cell`."""
    longest = max((len(run) for run in re.findall("`+", text)), default=0)
    ticks = "`" * (longest + 1)
    room = " " if text.startswith("`") or text.endswith("`") else ""
    return f"{ticks}{room}{text}{room}{ticks}"


def plain(text: str) -> str:
    """Text in which nothing is Markdown or HTML but what stands between backticks."""
    parts = re.split(r"(`[^`\n]+`)", text)
    return "".join(part if number % 2 else _escaped(part) for number, part in enumerate(parts))


def _escaped(text: str) -> str:
    return re.sub(r"([\\*_\[\]<>#{}])", r"\\\1", text)


def cell(text: str) -> str:
    """Markdown that stands in a table: in one line, and without a border in it."""
    return " ".join(text.split()).replace("|", "\\|")


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table, or nothing if it has no rows."""
    lines = [f"| {' | '.join(cell(text) for text in row)} |" for row in rows]
    if not lines:
        return ""
    return "\n".join((f"| {' | '.join(head)} |", f"|{'---|' * len(head)}", *lines))


def fence(text: str, language: str = "", title: str = "") -> str:
    """Text as a block of code."""
    longest = max((len(run) for run in re.findall("`+", text)), default=0)
    marks = "`" * max(3, longest + 1)
    named = f' title="{title}"' if title else ""
    return f"{marks}{language}{named}\n{text.rstrip()}\n{marks}"


def folded(title: str, text: str) -> str:
    """Text that a click opens."""
    return f'??? note "{title}"\n\n{indent(text, "    ")}'


def joined(*parts: str) -> str:
    """Paragraphs, tables and blocks below one another; empty ones are left out."""
    return "\n\n".join(part for part in parts if part) + "\n"


def titled_fences(text: str) -> str:
    """Fences with words after their language, as pages have them: a file name becomes their title, the rest goes."""

    def begin(found: re.Match[str]) -> str:
        file = found["words"] if re.fullmatch(r"[\w/-]+\.[\w.]+", found["words"]) else ""
        return f'{found["begin"]} title="{file}"' if file else found["begin"]

    return re.sub(r"^(?P<begin>```\w+) (?P<words>(?!title=).*)$", begin, text, flags=re.MULTILINE)


def bars_in_tables(text: str) -> str:
    """Tables with plain bars in their code: the Markdown of mkdocs knows no backslash there, code hosts need one."""

    def row(found: re.Match[str]) -> str:
        return re.sub(r"`[^`\n]+`", lambda span: span[0].replace("\\|", "|"), found[0])

    return re.sub(r"^\|.*\|$", row, text, flags=re.MULTILINE)
