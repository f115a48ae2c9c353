"""Advice is never refused: what a printed help says to write is accepted, or something else is wrong then."""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import Diagnostic
from tests.support.advice import mended, needs_thought
from tests.support.diagnosed_blocks import Block, blocks, reported


def advised() -> list[tuple[Block, Diagnostic]]:
    return [(block, found) for block in blocks() for found in reported(block) if found.help is not None]


def line_of(diagnostic: Diagnostic) -> int:
    return diagnostic.span.source.line_column(diagnostic.span.start)[0]


def test_advice_is_not_rejected() -> None:
    accepted = followed = 0
    for block, diagnostic in advised():
        for text in mended(diagnostic) or ():
            again = reported(Block(block.name, block.line, block.language, text))
            there = [each for each in again if line_of(each) == line_of(diagnostic)]
            same = [each for each in there if (each.code, each.message) == (diagnostic.code, diagnostic.message)]
            assert not same, f"{block}: {diagnostic.message}: {diagnostic.help}\n{text}"
            followed += 1
            accepted += not there
    assert (followed > 190, accepted > 160) == (True, True), (followed, accepted)


def test_every_help_is_followed_or_needs_a_thought() -> None:
    unknown = {
        f"{block}: {diagnostic.code} {diagnostic.help}"
        for block, diagnostic in advised()
        if mended(diagnostic) is None and not needs_thought(diagnostic)
    }
    assert not unknown
