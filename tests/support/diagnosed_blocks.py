"""The examples of tests/diagnostics, and what is reported about them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.span import Source, Span
from tachk.formats.loading.load import load_model
from tachk.syntax.query_files import parse_queries
from tachk.syntax.sentences.parser import parse_sentence

FOLDER = Path(__file__).parent.parent / "diagnostics"
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
