"""Runs the documents of this folder: Markdown whose code blocks say which diagnostics they cause.

A ``ta`` block is a model, a ``q`` block a query file, a ``sentence`` block holds a sentence on each line. A comment
``// error: [E0102] "expected ';'"`` (or ``warning``) demands a diagnostic of that code on its line whose message
contains the quoted text; several on one line are separated by blanks. Nothing else may be reported. A model is
elaborated if it can be parsed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.diagnostics.explanation import all_explanations
from tachk.base.span import Source, Span
from tachk.formats.loading.load import load_model
from tachk.syntax.query_files import parse_queries
from tachk.syntax.sentences.parser import parse_sentence

FOLDER = Path(__file__).parent
MARK = re.compile(r'// (?:error|warning):((?: \[[EW]\d{4}\] "(?:[^"\\]|\\.)*")+)')
DEMAND = re.compile(r'\[([EW]\d{4})\] "((?:[^"\\]|\\.)*)"')


@dataclass(frozen=True)
class Block:
    """A code block: ``line`` is that of its opening fence."""

    name: str
    line: int
    language: str
    text: str

    def __str__(self) -> str:
        return f"{self.name}:{self.line}"


def blocks() -> list[Block]:
    found: list[Block] = []
    for path in sorted(FOLDER.glob("*.md")):
        text = path.read_text(encoding="utf-8")
        for match in re.finditer(r"^```(ta|q|sentence)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
            line = text.count("\n", 0, match.start()) + 1
            found.append(Block(path.stem, line, match.group(1), match.group(2)))
    return found


def demanded(block: Block) -> list[tuple[int, str, str]]:
    return [
        (number, code, text.replace('\\"', '"'))
        for number, line in enumerate(block.text.splitlines(), 1)
        for mark in MARK.findall(line)
        for code, text in DEMAND.findall(mark)
    ]


def reported(block: Block) -> tuple[Diagnostic, ...]:
    source = Source(block.name, block.text)
    if block.language == "q":
        return parse_queries(source)[1]
    if block.language == "sentence":
        return tuple(found for line in lines(source) for found in parse_sentence(line)[1])
    try:
        loaded = load_model(source)
        return (*loaded.refusals, *loaded.warnings)
    except InputError as error:
        return error.diagnostics


def lines(source: Source) -> Iterator[Span]:
    start = 0
    for line in source.text.splitlines(keepends=True):
        yield Span(source, start, start + len(line))
        start += len(line)


@pytest.mark.parametrize("block", blocks(), ids=str)
def test_block(block: Block) -> None:
    rest = [(d.span.source.line_column(d.span.start)[0], d.code, d.message) for d in reported(block)]
    missing = []
    for line, code, text in demanded(block):
        found = next((r for r in rest if r[:2] == (line, code) and text in r[2]), None)
        if found is None:
            missing.append((line, code, text))
        else:
            rest.remove(found)
    assert (missing, rest) == ([], [])


@pytest.mark.parametrize("block", blocks(), ids=str)
def test_codes_are_explained(block: Block) -> None:
    assert {diagnostic.code for diagnostic in reported(block)} <= all_explanations().keys()


# ---- advice ---------------------------------------------------------------------------------------------------------

INSERTED = re.compile(r"add ['`](?P<text>[^'`]+)['`]|add (?P<plain>\S+)")
WRITTEN = re.compile(
    r"(?:write |did you mean |the operator is written )[`']?(?P<text>[^`']+?)[`']?(?:[,;:?]| for | in place |$)"
)


def mended(diagnostic: Diagnostic) -> str | None:
    """The text with what the help says to write in place of what is marked; None where it says something else."""
    span, help_ = diagnostic.span, diagnostic.help or ""
    text = span.source.text
    if help_ == "remove it":
        return text[: span.start] + text[span.end :]
    if (added := INSERTED.fullmatch(help_)) is not None and diagnostic.code == "E0102":
        return text[: span.start] + (added["text"] or added["plain"]) + text[span.end :]
    written = WRITTEN.match(help_)
    if written is None or "..." in help_ or diagnostic.code not in WHOLE_SPAN:
        return None
    return text[: span.start] + written["text"] + text[span.end :]


WHOLE_SPAN = frozenset({"E0104", "E0204", "E0207", "E0201"})
"""Codes whose help names what stands in place of what is marked."""


def advised() -> list[tuple[Block, Diagnostic, str]]:
    found = []
    for block in blocks():
        for diagnostic in reported(block):
            text = mended(diagnostic)
            if text is not None:
                found.append((block, diagnostic, text))
    return found


def test_advice_is_not_refused() -> None:
    """What a help says to write is accepted, or what is reported then is something else."""
    advice = advised()
    assert len(advice) > 40
    for block, diagnostic, text in advice:
        again = reported(Block(block.name, block.line, block.language, text))
        line = diagnostic.span.source.line_column(diagnostic.span.start)[0]
        same = [
            each
            for each in again
            if (each.code, each.message) == (diagnostic.code, diagnostic.message)
            and each.span.source.line_column(each.span.start)[0] == line
        ]
        assert not same, f"{block}: {diagnostic.message}: {diagnostic.help}"
