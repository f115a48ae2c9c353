"""Runs the documents of this folder: Markdown whose code blocks say which diagnostics they cause.

A ``ta`` block is a model, a ``q`` block a query file, a ``sentence`` block holds a sentence on each line. A comment
``// error: [E0102] "expected ';'"`` (or ``warning``) demands a diagnostic of that code on its line whose message
contains the quoted text; several on one line are separated by blanks. Nothing else may be reported. A model is
elaborated if it can be parsed.
"""

from __future__ import annotations

import pytest

from tachk.base.diagnostics.explanation import all_explanations
from tests.support.diagnosed_blocks import Block, blocks, demanded, reported


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
