"""What was added to a template whose picture is known gets free places, and the rest stays where it is."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from tachk.formats.layout.completion import complete
from tachk.formats.layout.placement.template import place_template
from tachk.syntax import ast
from tachk.syntax.picture_layout import EdgeKey, LabelLayout, NodeLayout, Point, TemplateLayout

sys.path.insert(0, str(Path(__file__).parent))

from picture_faults import faults, lying_together, missing
from test_placement import parsed, random_template, templates

from tests.support.seeds import seeds


def partial(random: Random, whole: TemplateLayout) -> TemplateLayout:
    """A layout without some of its locations, their edges, some other edges and some labels."""
    kept = {name: node for name, node in whole.nodes.items() if random.random() < 0.7}
    kept = kept or dict([next(iter(whole.nodes.items()))])

    def thinned(labels: dict[str, LabelLayout]) -> dict[str, LabelLayout]:
        return {kind: label for kind, label in labels.items() if random.random() < 0.8}

    nodes = {
        name: replace(node, labels=thinned(dict(node.labels)), name=node.name if random.random() < 0.8 else None)
        for name, node in kept.items()
    }
    edges = {
        key: replace(edge, labels=thinned(dict(edge.labels)))
        for key, edge in whole.edges.items()
        if key.source in kept and key.target in kept and random.random() < 0.7
    }
    return TemplateLayout(nodes=nodes, edges=edges)


@pytest.mark.parametrize("seed", seeds(range(20)))
def test_additions_to_random_templates_overlap_nothing(seed: int) -> None:
    random = Random(seed)
    locations = random.randrange(1, 9)
    template = random_template(random, locations, random.randrange(3 * locations))
    known = partial(random, place_template(template))
    layout = complete(template, known)
    assert missing(template, layout) == []
    assert [fault for fault in faults(template, layout) if "passes through" not in fault] == []
    assert lying_together(layout) == []
    for name, node in known.nodes.items():
        assert layout.nodes[name].position == node.position
        assert node.name in (None, layout.nodes[name].name)
        assert {**layout.nodes[name].labels, **node.labels} == layout.nodes[name].labels
    for key, edge in known.edges.items():
        assert layout.edges[key].nails == edge.nails
        assert {**layout.edges[key].labels, **edge.labels} == layout.edges[key].labels


def template_of(text: str) -> ast.Template:
    (template,) = templates(parsed(f"process P() {{ {text} }}"))
    return template


def placed(**centres: tuple[int, int]) -> TemplateLayout:
    return TemplateLayout(nodes={name: NodeLayout(Point(*centre)) for name, centre in centres.items()})


def test_edges_to_and_from_a_new_location_lie_apart_and_have_their_own_labels() -> None:
    """As where a location `Broken` is added to UPPAAL's train gate, with an edge to it and one back."""
    template = template_of(
        "init location Safe { to Start { guard x >= 3; } }"
        "location Start { invariant x <= 15; to Safe { guard x >= 7; } to Broken { guard x >= 14; assign x = 0; } }"
        "location Broken { invariant x <= 60; to Start { guard x >= 50; assign x = 0; } }"
    )
    layout = complete(template, placed(Safe=(0, 0), Start=(200, 0)))
    assert faults(template, layout) == []
    assert lying_together(layout) == []
    assert abs((layout.nodes["Broken"].position or Point(999, 999)).x - 200) < 200


def test_a_label_added_to_a_known_edge_stands_below_the_others() -> None:
    template = template_of("init location A { to B { guard x >= 3; assign x = 0; } } location B { }")
    key = EdgeKey("A", "B")
    whole = place_template(template)
    guard = whole.edges[key].labels["guard"]
    edge = replace(whole.edges[key], labels={"guard": replace(guard, position=Point(40, -60))})
    added = complete(template, replace(whole, edges={key: edge})).edges[key].labels["assignment"]
    assert added.position == Point(40, -43)


def test_a_location_without_neighbours_stands_beside_the_picture() -> None:
    template = template_of("init location A { } location Alone { }")
    assert complete(template, placed(A=(0, 0))).nodes["Alone"].position == Point(128, 0)
