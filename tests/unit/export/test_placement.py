"""Pictures in which nothing covers anything else, for the project's models and for random templates."""

from __future__ import annotations

import sys
from pathlib import Path
from random import Random

import pytest

from tachk.diagnostics.span import Source
from tachk.export.placement import place, place_template
from tachk.syntax import ast
from tachk.syntax.parser import parse_document
from tachk.syntax.source_files import read_source

sys.path.insert(0, str(Path(__file__).parent))

from picture_faults import faults, missing

MODELS = sorted((Path(__file__).parents[3] / "models").rglob("*.ta"))


def parsed(text: str) -> ast.Document:
    document, diagnostics = parse_document(Source("model.ta", text))
    assert document is not None, diagnostics
    return document


def templates(document: ast.Document) -> list[ast.Template]:
    return [item for item in document.items if isinstance(item, ast.Template)]


def random_template(random: Random, locations: int, edges: int) -> ast.Template:
    """A template with labels of all kinds and lengths, self-loops, parallel edges and branchpoints."""
    names = [random.choice("ABCD") + "x" * random.randrange(12) + str(i) for i in range(locations)]
    body = []
    for number, name in enumerate(names):
        invariant = (
            f"{{ invariant x <= {number} && {'y' * random.randrange(1, 20)} > 1; }}" if random.random() < 0.4 else ";"
        )
        kind = "init " if number == 0 else random.choice(("", "urgent ", "committed "))
        lines = []
        for _ in range(edges // locations + (number < edges % locations)):
            clauses = (
                f"select i : int[0, {random.randrange(99)}];" if random.random() < 0.2 else "",
                f"guard x >= 1 {'&& y < 2' * random.randrange(7)};" if random.random() < 0.5 else "",
                f"sync c{'z' * random.randrange(9)}!;" if random.random() < 0.5 else "",
                f"assign x = 0{', y = 0, n = n + 1' * random.randrange(4)};" if random.random() < 0.5 else "",
            )
            lines.append(f"to {random.choice(names)} {{ {' '.join(clauses)} }}")
        body.append(f"{kind}location {name} {{ {random.choice((invariant, ''))} {' '.join(lines)} }}")
    return templates(parsed(f"process P() {{ {' '.join(body)} }}"))[0]


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_nothing_overlaps_in_the_models(path: Path) -> None:
    document, _ = parse_document(read_source(path))
    assert document is not None
    layout = place(document)
    for template in templates(document):
        drawn = layout.templates[template.name.name]
        assert missing(template, drawn) == []
        assert faults(template, drawn) == []


@pytest.mark.parametrize("seed", range(12))
def test_nothing_overlaps_in_random_templates(seed: int) -> None:
    random = Random(seed)
    locations = random.randrange(1, 12)
    template = random_template(random, locations, random.randrange(3 * locations))
    layout = place_template(template)
    assert missing(template, layout) == []
    assert faults(template, layout) == []
