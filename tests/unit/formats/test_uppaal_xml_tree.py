"""XML from strangers."""

from __future__ import annotations

import pytest

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.span import Source
from tachk.formats.uppaal.xml_tree import DEEPEST, parse_xml


def refusal(text: str) -> Diagnostic:
    with pytest.raises(InputError) as caught:
        parse_xml(Source("m.xml", text))
    (found,) = caught.value.diagnostics
    return found


def test_paths_count_what_occurs_several_times() -> None:
    root = parse_xml(
        Source("m", "<nta><template/><template><location/><label/><label/></template><system/></nta>")
    ).root
    assert [child.path for child in root.children] == ["/nta/template[1]", "/nta/template[2]", "/nta/system"]
    assert [child.path for child in root.children[1].children] == [
        "/nta/template[2]/location[1]",
        "/nta/template[2]/label[1]",
        "/nta/template[2]/label[2]",
    ]


def test_an_element_spans_its_tags() -> None:
    text = '<nta>\r\n<a x=">"/>\u00e9<b>t</b ></nta>'
    first, second = parse_xml(Source("m", text)).root.children
    assert (first.span.text, second.span.text, second.tag.text) == ('<a x=">"/>', "<b>t</b >", "<b>")


@pytest.mark.parametrize(
    ("text", "line", "column"),
    [
        ("<nta>\n<label>a && b</label></nta>", 2, 11),
        ("<nta>\n <template>\n</nta>", 3, 3),
        ("<nta/>\ntrailing", 2, 1),
        ("<nta", 1, 1),
    ],
)
def test_what_is_not_well_formed_is_rejected_with_its_place(text: str, line: int, column: int) -> None:
    found = refusal(text)
    assert found.code == "E0120"
    assert found.span.source.line_column(found.span.start) == (line, column)


BOMB = """<!DOCTYPE nta [
<!ENTITY a "lol"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;">
]><nta>&c;</nta>"""


@pytest.mark.parametrize(
    ("text", "name"),
    [
        (BOMB, "a"),
        ('<!DOCTYPE nta [<!ENTITY secret SYSTEM "file:///etc/passwd">]><nta>&secret;</nta>', "secret"),
        ('<!DOCTYPE nta [<!ENTITY % dtd SYSTEM "http://example.org/x.dtd"> %dtd;]><nta/>', "dtd"),
        ("<!DOCTYPE nta PUBLIC 'x' 'http://example.org/x.dtd'><nta>&nbsp;</nta>", "nbsp"),
        ("<nta>&nbsp;</nta>", "entity"),
    ],
)
def test_entities_are_rejected_by_name(text: str, name: str) -> None:
    found = refusal(text)
    assert found.code == "E0121"
    assert name in found.message


def test_depth_is_limited() -> None:
    assert parse_xml(Source("m", "<a>" * DEEPEST + "</a>" * DEEPEST)).root.name == "a"
    assert refusal("<a>" * (DEEPEST + 1) + "</a>" * (DEEPEST + 1)).code == "E0122"
    assert refusal("<a>" * 100_000).code == "E0122"
