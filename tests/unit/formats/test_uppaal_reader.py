"""Reading UPPAAL XML: what it says, what is tolerated, and where things stand in the file."""

from __future__ import annotations

import pytest

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.diagnostics.render import render
from tachk.base.plain_data import PlainData
from tachk.base.span import Source
from tachk.formats.uppaal.reader import XmlModel, parse_uppaal_xml
from tachk.syntax import ast
from tachk.syntax.picture_layout import EdgeKey, Point
from tachk.syntax.printing.printer import print_document
from tachk.syntax.source_files import is_xml

DOOR = """\
<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE nta PUBLIC '-//Uppaal Team//DTD Flat System 1.1//EN' 'http://www.it.uu.se/research/group/darts/uppaal/flat-1_2.dtd'>
<nta>
<declaration>// the door
chan push[2];
</declaration>
<template>
<name x="5" y="5">Door</name>
<parameter>const int[0,1] id</parameter>
<declaration>/// A door that closes by itself.

clock x;</declaration>
<location id="id0" x="-100" y="0" color="#ff00ff"><name x="-110" y="-34">Open</name>
<label kind="invariant" x="-110" y="17">x &lt;= 5 &amp;&amp; x&gt;=0</label>
<label kind="comments">wide open</label></location>
<location id="id1" x="100" y="0"><urgent/></location>
<branchpoint id="id2" x="0" y="50"/>
<init ref="id1"/>
<transition color="#00ff00"><source ref="id0"/><target ref="id2"/>
<label kind="select" x="1" y="2">i : int[0,3]</label>
<label kind="guard" x="1" y="19">x &gt;= 3 /* late */</label>
<label kind="synchronisation" x="1" y="36">push[id]?</label>
<label kind="assignment" x="1" y="53">x = 0</label>
<nail x="10" y="20"/><nail x="30" y="40"/></transition>
<transition controllable="false" action="a"><source ref="id2"/><target ref="id1"/><label kind="probability">2</label>
</transition>
</template>
<system>D = Door(1);
system D;</system>
<queries>
<option key="--diagnostic" value="0"/>
<query><formula></formula><comment>Safety</comment></query>
<query><formula>A[] not deadlock</formula><comment>stuck: never stuck
More about it.</comment><result outcome="failure" type="quality" timestamp="2024"/></query>
<query><formula>E&lt;&gt; D.Open
&amp;&amp; D.x &gt; 3 /* EXPECT:T */</formula><comment>an old one</comment></query>
<query><formula>E&lt;&gt; D.Open imply imply</formula><comment/></query>
<query><formula>Pr[#&lt;=10](&lt;&gt; D.Open)</formula></query>
</queries>
</nta>
"""


def read(text: str) -> XmlModel:
    return parse_uppaal_xml(Source("m.xml", text))


def wrap(template: str = "", declaration: str = "", system: str = "system P;") -> str:
    """A model with one template P."""
    return (
        f"<nta><declaration>{declaration}</declaration><template><name>P</name>{template}</template>"
        f"<system>{system}</system></nta>"
    )


def codes(model: XmlModel) -> list[str]:
    return [diagnostic.code for diagnostic in model.diagnostics]


def template(model: XmlModel) -> ast.Template:
    return next(item for item in model.document.items if isinstance(item, ast.Template))


def properties(model: XmlModel) -> list[ast.PropertyDeclaration]:
    return [item for item in model.document.items if isinstance(item, ast.PropertyDeclaration)]


# ---- what it says ---------------------------------------------------------------------------------------------------


def test_the_document_is_the_one_of_the_same_model_as_text() -> None:
    assert codes(read(DOOR)) == []
    assert (
        print_document(read(DOOR).document)
        == """\
// the door
chan push[2];

/// A door that closes by itself.
process Door(const int[0, 1] id) {
    clock x;

    /// wide open
    location Open {
        invariant x <= 5 && x >= 0;
        to _id2 {
            select i : int[0, 3];
            guard x >= 3;  /* late */
            sync push[id]?;
            assign x = 0;
        }
    }

    init urgent location _id1;

    branchpoint _id2 {
        uncontrollable to _id1 { probability 2; }
    }
}

D = Door(1);
system D;

/// More about it.
property stuck "never stuck" : A[] !deadlock expect fails;
/// an old one
property q3 : E<> D.Open && D.x > 3 expect holds;
property q5 : Pr[#<=10](<> D.Open);
"""
    )


def test_the_picture() -> None:
    layout = read(DOOR).layout
    assert layout.dtd == "1.1"
    door = layout.templates["Door"]
    assert door.nodes["Open"].position == Point(-100, 0)
    assert door.nodes["Open"].name == Point(-110, -34)
    assert door.nodes["Open"].colour == "#ff00ff"
    assert door.nodes["_id1"].written_name == ""
    edge = door.edges[EdgeKey("Open", "_id2", 0)]
    assert edge.nails == (Point(10, 20), Point(30, 40))
    assert edge.colour == "#00ff00"
    assert edge.labels["guard"].position == Point(1, 19)
    assert edge.labels["guard"].text == "x >= 3 /* late */"
    assert edge.labels["assignment"].text is None
    assert door.edges[EdgeKey("_id2", "_id1", 0)].attributes == {"action": "a"}


def test_what_a_list_of_queries_has_besides_properties() -> None:
    model = read(DOOR)
    assert model.layout.options == (("--diagnostic", "0"),)
    assert [query.name for query in model.layout.queries] == ["", "stuck", "q3", "", "q5"]
    assert model.layout.queries[0].comment == "Safety"
    assert model.layout.queries[1].results == ('<result outcome="failure" type="quality" timestamp="2024"/>',)
    assert model.layout.queries[3].formula == "E<> D.Open imply imply"
    assert [(query.name, query.text) for query in model.broken] == [("q4", "E<> D.Open imply imply")]
    assert model.broken[0].diagnostics[0].code == "E0101"


@pytest.mark.parametrize(
    ("elements", "expected"),
    [
        ('<result outcome="success" type="quality"/>', "holds"),
        ('<expect outcome="failure"/><result outcome="success"/>', "fails"),
        ('<result outcome="maybe"/>', None),
        ('<result outcome="success" type="interval"/>', None),
        ("", None),
    ],
)
def test_saved_outcomes_are_expectations(elements: str, expected: str | None) -> None:
    queries = f"<queries><query><formula>A[] P.x</formula><comment/>{elements}</query></queries>"
    (node,) = properties(read(f"<nta>{queries}</nta>"))
    assert node.expectation == expected


def test_the_words_of_a_comment_that_name_a_property() -> None:
    comments = [
        "safe: stays safe",
        "safe: again",
        "two words",
        "safe2",
        "state: no name",
        "x: EXPECT\nEXPECT:F",
        "y: it\nEXPECT: T",
    ]
    queries = "".join(f"<query><formula>A[] true</formula><comment>{c}</comment></query>" for c in comments)
    nodes = properties(read(f"<nta><queries>{queries}</queries></nta>"))
    assert [(node.name.name, node.title, node.doc) for node in nodes] == [
        ("safe", "stays safe", ""),
        ("q2", "", "safe: again"),
        ("q3", "", "two words"),
        ("safe2", "", ""),
        ("q5", "", "state: no name"),
        ("x", "EXPECT", ""),
        ("y", "it", ""),
    ]
    assert [node.expectation for node in nodes[-2:]] == ["fails", "holds"]


# ---- what is tolerated ----------------------------------------------------------------------------------------------


def test_names_that_are_missing_no_identifiers_reserved_or_given_twice() -> None:
    names = ["A", "A", "", "the end", "init", "A_2", "3rd"]
    locations = "".join(
        f'<location id="n{number}">{f"<name>{name}</name>" if name else ""}</location>'
        for number, name in enumerate(names)
    )
    model = read(wrap(locations + '<init ref="n0"/>'))
    found = [location.name.name for location in template(model).locations]
    assert found[0] == "A"
    assert found[2] == "_n2"
    assert found[5] == "A_2"
    assert len(set(found)) == len(names)
    assert codes(model) == ["W0121"] * 4
    assert [node.written_name for node in model.layout.templates["P"].nodes.values()] == [
        None, "A", "", "the end", "init", None, "3rd",
    ]  # fmt: skip


def test_ids_belong_to_their_template() -> None:
    one = '<location id="id0"><name>{0}</name></location><init ref="id0"/>'
    text = "".join(f"<template><name>T{n}</name>{one.format(n)}</template>" for n in ("A", "B"))
    model = read(f"<nta>{text}<system>system TA, TB;</system></nta>")
    assert codes(model) == []
    assert [t.locations[0].name.name for t in model.document.items if isinstance(t, ast.Template)] == ["A", "B"]


def test_carriage_returns_empty_labels_and_unknown_elements() -> None:
    text = wrap('<location id="a"><label kind="invariant">\n </label></location><init ref="a"/><simulator x="1"/>')
    model = read(text.replace("<system>", "<imports/><system>").replace("\n", "\r\n").replace(">", ">\r\n"))
    assert codes(model) == []
    assert template(model).locations[0].invariant is None
    assert model.layout.extra == ("<imports/>",)
    assert model.layout.templates["P"].extra == ('<simulator x="1"/>',)


def test_several_sections_of_one_kind_follow_one_another() -> None:
    model = read(
        "<nta><declaration>int a;</declaration><declaration>int b;</declaration><system>system P;</system></nta>"
    )
    assert [item.declarators[0].name.name for item in model.document.items[:2]] == ["a", "b"]  # type: ignore[union-attr]


def test_misspelt_unknown_and_repeated_labels() -> None:
    labels = (
        '<label kind="synchronization">c!</label><label kind="weather">sunny</label>'
        '<label kind="guard">a</label><label kind="guard">b</label><label kind="testcode">run();</label>'
    )
    edge = f'<transition><source ref="a"/><target ref="a"/>{labels}</transition>'
    model = read(wrap(f'<location id="a"/>{edge}'))
    assert sorted(codes(model)) == ["W0120", "W0120", "W0122"]
    (node,) = template(model).edges
    assert node.synchronisation is not None and node.synchronisation.direction == "!"
    assert node.guard is not None and node.guard.span.text == "b"
    kept = model.layout.templates["P"].edges[EdgeKey("_a", "_a", 0)].labels
    assert (kept["weather"].text, kept["testcode"].text) == ("sunny", "run();")


def test_labels_of_uppaal_3_are_read_with_one_warning() -> None:
    edge = '<transition><source ref="a"/><target ref="a"/><label kind="guard">x &gt; 1, y &lt; 2</label></transition>'
    model = read(wrap(f'<parameter>clock x; int y; const c</parameter><location id="a"/>{edge}{edge}'))
    assert codes(model) == ["W0101"]
    assert [(p.name.name, p.reference) for p in template(model).parameters] == [("x", True), ("y", True), ("c", False)]
    guard = template(model).edges[0].guard
    assert isinstance(guard, ast.BinaryExpression) and guard.operator == "&&"


def test_message_sequence_charts_are_kept_and_reported() -> None:
    model = read("<nta><lsc><name>L</name></lsc><system>system P;</system></nta>")
    assert codes(model) == ["W0123"]
    assert model.layout.extra == ("<lsc><name>L</name></lsc>",)


# ---- what is refused ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("<transition><target ref='a'/></transition>", "this edge of `P` has no source"),
        (
            "<transition><source ref='a'/><target ref='z'/></transition>",
            "the target of this edge, `z`, is not a location",
        ),
        ("<init ref='z'/>", "the initial location `z` does not exist"),
        ("<location id='a'/>", "two locations of `P` have the id `a`"),
    ],
)
def test_broken_references(body: str, message: str) -> None:
    (found,) = read(wrap(f"<location id='a'/>{body}")).diagnostics
    assert found.code == "E0124"
    assert message in found.message


@pytest.mark.parametrize("text", ["<project/>", "<html><body/></html>"])
def test_other_xml(text: str) -> None:
    assert is_xml(Source("m.xml", text))
    with pytest.raises(InputError, match="E0123"):
        read(text)


# ---- places ---------------------------------------------------------------------------------------------------------


def guard_error(guard: str, before: str = "") -> Diagnostic:
    edge = f'<transition><source ref="a"/><target ref="b"/>\n  <label kind="guard">{guard}</label>\n</transition>'
    (found,) = read(wrap(f'{before}<location id="a"/><location id="b"/>{edge}')).diagnostics
    return found


def test_a_diagnostic_points_into_the_file_and_names_the_part_of_the_model() -> None:
    found = guard_error("x &lt; 3 &amp;&amp; (y")
    assert str(found.span) == "m.xml:2:43"
    assert render(found).splitlines()[1:] == [
        '    2 |   <label kind="guard">x &lt; 3 &amp;&amp; (y</label>',
        "      |" + " " * 43 + "^",
        "      |" + " " * 53 + "- the text ends here",
        "in: P, edge _a -> _b, guard (/nta/template[1]/transition[1]/label[1])",
        "help: add ')'",
    ]
    place = PlainData().of(found)["place"]
    assert (place["line"], place["column"], place["end_column"]) == (2, 43, 44)
    assert place["path"] == "/nta/template[1]/transition[1]/label[1]"


@pytest.mark.parametrize("entity", ["&lt;", "&#60;", "<![CDATA[<]]>"])
def test_columns_behind_what_xml_writes_otherwise(entity: str) -> None:
    found = guard_error(f"x {entity} 3 $ 4")
    assert found.code == "E0002"
    line, column = found.span.in_file.source.line_column(found.span.in_file.start)
    text = found.span.in_file.source.line(line)
    assert text[column - 1] == "$"
    assert found.span.in_file.text == "$"


def test_lines_behind_carriage_returns_and_letters_of_several_bytes() -> None:
    found = guard_error("x\r\n\r\n&gt; 3 $ 4", before="<!-- h\u00f6he \u2192 -->")
    assert str(found.span) == "m.xml:4:8"


def test_a_location_that_is_urgent_and_committed_is_committed() -> None:
    text = (
        '<nta><template><name>P</name><location id="a"><name>A</name><urgent/><committed/></location>'
        '<init ref="a"/></template><system>system P;</system></nta>'
    )
    assert template(read(text)).locations[0].committed


def test_headings_in_the_list_of_queries_are_no_queries() -> None:
    headings = ("== G1 with G0: safety ==", "### Safety", "****", "  -- no")
    queries = "".join(f"<query><formula>{text}</formula><comment/></query>" for text in headings)
    model = read(f"<nta><system>system P;</system><queries>{queries}</queries></nta>")
    assert [query.text for query in model.broken] == ["-- no"]
    assert [query.formula for query in model.layout.queries][:3] == list(headings[:3])
