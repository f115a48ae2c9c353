"""The side file of a layout."""

from __future__ import annotations

from pathlib import Path

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.formats.layout_json import layout_from_json, layout_path, layout_to_json, read_layout_beside
from tachk.syntax.picture_layout import (
    EdgeKey,
    EdgeLayout,
    LabelLayout,
    Layout,
    NodeLayout,
    Point,
    QueryLayout,
    TemplateLayout,
)

LAYOUT = Layout(
    {
        "P": TemplateLayout(
            Point(5, 5),
            {
                "A": NodeLayout(Point(0, -1), Point(2, 3), {"invariant": LabelLayout(Point(4, 5))}, "#ff0000", "id0"),
                "_id1": NodeLayout(written_name=""),
            },
            {
                EdgeKey("A", "_id1"): EdgeLayout((Point(1, 2), Point(3, 4)), {"guard": LabelLayout(None, "x\n> 1")}),
                EdgeKey("A", "_id1", 1): EdgeLayout(colour="#0f0", attributes={"action": "a"}),
            },
            ("<simulator/>",),
        ),
        "Q": TemplateLayout(),
    },
    "1.6",
    (("--diagnostic", "0"),),
    (QueryLayout("", "heading"), QueryLayout("q1", None, "A[] x", (("k", "v"),), ('<result outcome="success"/>',))),
    ("<lsc/>",),
)


def test_there_and_back() -> None:
    assert layout_from_json(Source("l", layout_to_json(LAYOUT))) == LAYOUT
    assert layout_from_json(Source("l", layout_to_json(Layout()))) == Layout()


def test_every_location_and_edge_has_a_line() -> None:
    lines = layout_to_json(LAYOUT).splitlines()
    assert (
        '      "A": {"at": [0, -1], "name": [2, 3], "labels": {"invariant": [4, 5]}, "colour": "#ff0000", "id": "id0"},'
        in (lines)
    )
    assert sum('"source": "A"' in line for line in lines) == 2


def test_beside_the_model(tmp_path: Path) -> None:
    model = tmp_path / "door.ta"
    assert read_layout_beside(model) is None
    layout_path(model).write_text(layout_to_json(LAYOUT), encoding="utf-8")
    assert (tmp_path / "door.layout.json").is_file()
    assert read_layout_beside(model) == LAYOUT


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "not JSON"),
        ("[]", "the file is not an object"),
        ('{"layout": 9}', "version 9 is unknown"),
        ('{"layout": 1, "templates": {"P": {"nodes": {"A": {"at": [1]}}}}}', "a point is not a pair of integers"),
        ('{"layout": 1, "templates": {"P": {"edges": [{"source": "A"}]}}}', "`target` is not a text"),
        ('{"layout": 1, "options": [["a"]]}', "an option is not a pair of texts"),
        ("[" * 100_000, ""),
    ],
)
def test_a_broken_file_is_an_error(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        layout_from_json(Source("door.layout.json", text))
    (found,) = caught.value.diagnostics
    assert found.code == "E0125"
    assert message in found.message
