"""Pictures in which nothing covers anything else, for the project's models and for random templates."""

from __future__ import annotations

import sys
from pathlib import Path
from random import Random

import pytest

from tachk.base.span import Source
from tachk.formats.layout.placement.template import place_template
from tachk.syntax import ast
from tachk.syntax.parsing.parser import parse_document
from tachk.syntax.source_files import read_source

sys.path.insert(0, str(Path(__file__).parent))

from picture_faults import faults, lying_together, missing

from tests.support.seeds import seeds

pytestmark = pytest.mark.drawn

MODELS = sorted((Path(__file__).parents[4] / "models").rglob("*.ta"))


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
        invariant = f"invariant x <= {number} && {'y' * random.randrange(1, 20)} > 1;"
        kind = "init " if number == 0 else random.choice(("", "urgent ", "committed "))
        lines = []
        for _ in range(edges // locations + (number < edges % locations)):
            clauses = (
                f"select i : int[0, {random.randrange(99)}];" if random.random() < 0.2 else "",
                f"guard x >= 1 {'&& y < 2' * random.randrange(7)};" if random.random() < 0.5 else "",
                f"sync c{'z' * random.randrange(9)}!;" if random.random() < 0.5 else "",
                f"assign x = 0{', y = 0, n = n + 1' * random.randrange(4)};" if random.random() < 0.5 else "",
            )
            doc = f"/// {'a word ' * random.randrange(1, 20)}\n" if random.random() < 0.3 else ""
            lines.append(f"{doc}to {random.choice(names)} {{ {' '.join(clauses)} }}")
        body.append(f"{kind}location {name} {{ {random.choice((invariant, ''))} {' '.join(lines)} }}")
    return templates(parsed(f"process P() {{ {' '.join(body)} }}"))[0]


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_nothing_overlaps_in_the_models(path: Path) -> None:
    document, _ = parse_document(read_source(path))
    assert document is not None
    for template in templates(document):
        drawn = place_template(template)
        assert missing(template, drawn) == []
        assert faults(template, drawn) == []


@pytest.mark.parametrize("seed", seeds(range(12)))
def test_nothing_overlaps_in_random_templates(seed: int) -> None:
    random = Random(seed)
    locations = random.randrange(1, 12)
    template = random_template(random, locations, random.randrange(3 * locations))
    layout = place_template(template)
    assert missing(template, layout) == []
    assert faults(template, layout) == []
    assert lying_together(layout) == []


def chain(length: int) -> ast.Template:
    locations = (f"location L{i} {{ to L{(i + 1) % length} {{ guard x >= {i}; }} }}" for i in range(length))
    return templates(parsed(f"process P() {{ init {' '.join(locations)} }}"))[0]


@pytest.mark.parametrize("length", [80, 4000])
def test_long_chains_are_set_out_in_rows_that_fit_a_screen(length: int) -> None:
    template = chain(length)
    layout = place_template(template)
    assert missing(template, layout) == []
    points = [node.position for node in layout.nodes.values() if node.position is not None]
    width, height = (max(each) - min(each) for each in zip(*points, strict=True))
    assert 0.5 < width / height < 4
    assert len(set(points)) == length


def test_texts_in_rows_do_not_overlap() -> None:
    template = random_template(Random(5), 60, 500)
    assert [fault for fault in faults(template, place_template(template)) if "passes through" not in fault] == []


def test_a_template_without_locations_has_an_empty_picture() -> None:
    assert place_template(templates(parsed("process P() { }"))[0]).nodes == {}


def test_the_same_document_gets_the_same_layout() -> None:
    template = random_template(Random(3), 8, 16)
    assert place_template(template) == place_template(template)


def test_the_flow_leads_in_one_direction() -> None:
    template = chain(6)
    points = [place_template(template).nodes[f"L{i}"].position for i in range(6)]
    assert points == sorted(points) or points == sorted(points, key=lambda point: (point.y, point.x))
    assert points[0] == (0, 0)


def test_a_tall_invariant_keeps_clear_of_the_name() -> None:
    invariant = " && ".join(f"clock_number_{i} <= {i}" for i in range(12))
    edges = " ".join(f"to L{i} {{ guard clock_number_{i} >= 1; sync c!; }} to A;" for i in range(6))
    others = " ".join(f"location L{i} {{ to A {{ sync c?; }} }}" for i in range(6))
    text = f"process P() {{ init location A {{ invariant {invariant}; {edges} }} {others} }}"
    template = templates(parsed(text))[0]
    assert faults(template, place_template(template)) == []


def test_edges_between_the_same_locations_lie_apart() -> None:
    text = "process P() { init location A { to B; to B; } location B { to A; to B; to B; } }"
    layout = place_template(templates(parsed(text))[0])
    assert len(layout.edges) == 5
    assert lying_together(layout) == []


def test_long_labels_are_broken_into_lines_and_mean_the_same() -> None:
    text = "process P() { init location A { to A { guard n == 111111111 && m == 222222222 && k == 333333333; } } }"
    layout = place_template(templates(parsed(text))[0])
    (edge,) = layout.edges.values()
    written = edge.labels["guard"].text
    assert written is not None and written.count("\n") == 1
    assert written.replace("\n", " ") == "n == 111111111 && m == 222222222 && k == 333333333"
