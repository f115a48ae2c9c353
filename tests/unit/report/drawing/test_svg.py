"""Pictures show what UPPAAL shows, are well-formed, and hold everything inside their frame."""

from __future__ import annotations

from itertools import combinations
from math import dist
from xml.etree import ElementTree

from tachk.base.span import Source
from tachk.formats.layout.placement.template import place_template
from tachk.report.drawing.png import to_png
from tachk.report.drawing.svg import Picture, draw_template, together
from tachk.report.drawing.themes import always_light
from tachk.syntax import ast
from tachk.syntax.parsing.parser import parse_document
from tachk.syntax.picture_layout import EdgeKey, EdgeLayout, NodeLayout, Point, TemplateLayout

SVG = "{http://www.w3.org/2000/svg}"
MODEL = """
process Lamp(const int[0, 3] id) {
    clock x;
    init location Off { to Choice { select i : int[0, 1]; guard x < 5 && id > 0; sync press?; assign x = 0; } }
    committed location Dim { invariant x <= 10; to Off; }
    urgent location Bright { to Off; to Bright { guard x > 1; } }
    branchpoint Choice { to Dim { probability 3; } to Bright { probability 1; } }
}
"""


def template(text: str = MODEL) -> ast.Template:
    document, _ = parse_document(Source("lamp.ta", text))
    assert document is not None
    (item,) = document.items
    assert isinstance(item, ast.Template)
    return item


def drawn(text: str = MODEL) -> Picture:
    return draw_template(template(text), place_template(template(text)))


def texts(picture: Picture, kind: str) -> list[str | None]:
    return [e.text for e in ElementTree.fromstring(picture.svg).iter(f"{SVG}text") if e.get("class") == kind]


def test_every_text_is_shown_in_the_colour_of_its_kind() -> None:
    picture = drawn()
    assert texts(picture, "name") == ["Off", "Dim", "Bright"]
    assert texts(picture, "invariant") == ["x <= 10"]
    assert texts(picture, "select") == ["i : int[0, 1]"]
    assert texts(picture, "guard") == ["x < 5 && id > 0", "x > 1"]
    assert texts(picture, "synchronisation") == ["press?"]
    assert texts(picture, "assignment") == ["x = 0"]
    assert texts(picture, "probability") == ["3", "1"]
    assert texts(picture, "title") == ["Lamp(const int[0, 3] id)"]
    assert texts(picture, "mark") == ["C", "∪"]


def test_the_initial_location_is_a_double_circle_and_the_branchpoint_a_dot() -> None:
    circles = list(ElementTree.fromstring(drawn().svg).iter(f"{SVG}circle"))
    assert [circle.get("class") for circle in circles] == ["node"] * 4 + ["head"]
    assert circles[0].get("cx") == circles[1].get("cx") and circles[0].get("r") != circles[1].get("r")


def test_edges_end_at_the_rim_of_their_locations() -> None:
    layout = TemplateLayout(nodes={"A": NodeLayout(Point(0, 0)), "B": NodeLayout(Point(100, 0))})
    picture = draw_template(template("process P() { init location A { to B; } location B; }"), layout)
    (head,) = ElementTree.fromstring(picture.svg).iter(f"{SVG}polygon")
    assert (head.get("points") or "").split()[0] == "88,0"


def test_everything_is_inside_the_frame() -> None:
    picture = drawn()
    for element in ElementTree.fromstring(picture.svg).iter():
        x, y = element.get("cx") or element.get("x"), element.get("cy") or element.get("y")
        if x and y:
            assert picture.left <= float(x) < picture.left + picture.width
            assert picture.top <= float(y) < picture.top + picture.height


def test_what_has_no_place_is_left_out() -> None:
    picture = draw_template(template(), TemplateLayout())
    assert texts(picture, "name") == []
    assert texts(picture, "title") == ["Lamp(const int[0, 3] id)"]


def test_a_colour_of_the_layout_cannot_inject_markup() -> None:
    layout = TemplateLayout(nodes={"A": NodeLayout(Point(0, 0), colour='red"/><script>')})
    picture = draw_template(template("process P() { init location A; }"), layout)
    assert not list(ElementTree.fromstring(picture.svg).iter(f"{SVG}script"))


def test_pictures_one_below_the_other_keep_their_sizes() -> None:
    one = drawn()
    both = together("both", [one, one])
    assert (both.width, both.height) == (one.width, 2 * one.height)
    inner = list(ElementTree.fromstring(both.svg).iter(f"{SVG}svg"))[1:]
    assert [e.get("y") for e in inner] == ["0", str(one.height)]


def test_a_loop_without_nails_shows_beside_its_location() -> None:
    layout = TemplateLayout(nodes={"A": NodeLayout(Point(0, 0))})
    picture = draw_template(template("process P() { init location A { to A; } }"), layout)
    (line,) = ElementTree.fromstring(picture.svg).iter(f"{SVG}path")
    first, second = (part.split(",") for part in (line.get("d") or "").split()[1:3])
    assert first[0][1:] == second[0] == "-35", "a curve that reaches as far as nails would"
    assert first[1] == f"-{second[1]}"


def test_arrow_heads_at_one_location_do_not_lie_in_each_other() -> None:
    nails = {EdgeKey("A", "B", number): EdgeLayout((Point(50, 4 * number),)) for number in range(4)}
    layout = TemplateLayout(nodes={"A": NodeLayout(Point(0, 0)), "B": NodeLayout(Point(100, 0))}, edges=nails)
    text = f"process P() {{ init location A {{ {'to B; ' * 4} }} location B; }}"
    picture = draw_template(template(text), layout)
    heads = [head.get("points") or "" for head in ElementTree.fromstring(picture.svg).iter(f"{SVG}polygon")]
    tips = [tuple(map(float, head.split()[0].split(","))) for head in heads]
    assert min(dist(one, other) for one, other in combinations(tips, 2)) > 7
    assert all(round(dist(tip, (100, 0))) == 12 for tip in tips)


def test_an_svg_is_dark_where_the_reader_prefers_it_and_a_png_is_light() -> None:
    svg = drawn().svg
    assert "@media (prefers-color-scheme:dark){" in svg
    assert "prefers-color-scheme" not in always_light(svg)
    assert {element.tag for element in ElementTree.fromstring(always_light(svg)).iter()} == {
        element.tag for element in ElementTree.fromstring(svg).iter()
    }
    assert to_png(svg) == to_png(always_light(svg))
