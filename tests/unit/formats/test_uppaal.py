"""Writing UPPAAL XML, and the way there and back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from random import Random
from xml.etree import ElementTree

from hypothesis import given, settings
from hypothesis import strategies as st

import tachk
from tachk.base.span import Source
from tachk.engine.options import Limits
from tachk.formats.layout_json import layout_from_json, layout_to_json
from tachk.formats.loading.load import load_model
from tachk.formats.network_json.network import same_network
from tachk.formats.plain.expansion import expand
from tachk.formats.uppaal.writer import print_uppaal
from tachk.frontend.loaded import LoadedModel
from tachk.syntax import ast
from tachk.syntax.parsing.parser import parse_document
from tachk.syntax.picture_layout import EdgeKey, Layout, Point, TemplateLayout
from tachk.syntax.printing.printer import canonical, print_document
from tachk.verify.verify import verify


def load(text: str, name: str = "m") -> LoadedModel:
    return load_model(Source(name, text))


def written(model: LoadedModel, layout: Layout | None = None) -> str:
    return print_uppaal(model, expand(model), layout)


LAMP = """\
// the lamp
const int LONG = 5;
broadcast chan press;

/// A lamp that
/// goes out.
process Lamp(const int[0, 1] id) {
    clock y;  // since the last press

    /// dark
    init location Off {
        to On { select i : int[0, 1]; guard i < 1 && id >= 0; sync press?; assign y = 0; }
    }
    location On {
        invariant y <= LONG;
        // by itself
        to Off { guard y >= LONG; }
        to Flicker;
    }
    branchpoint Flicker { to On { probability 3; } to Off { probability 1; } }
}

process User() {
    init location Idle { to Idle { sync press!; } }
}

system Lamp, User;
/// never for long
property goes_out "goes out" : A[] Lamp(0).On imply Lamp(0).y <= 5 expect holds;
property q2 : E<> Lamp(1).On && !Lamp(0).On;
"""


def test_the_file_has_what_uppaal_needs_in_its_order() -> None:
    text = written(load(LAMP))
    assert text.splitlines()[1].startswith("<!DOCTYPE nta PUBLIC '-//Uppaal Team//DTD Flat System 1.1//EN'")
    root = ElementTree.fromstring(text)
    assert [child.tag for child in root] == ["declaration", "template", "template", "system", "queries"]
    lamp = root[1]
    order = ["name", "parameter", "declaration", "location", "location", "branchpoint", "init"]
    assert [child.tag for child in lamp] == [*order, *["transition"] * 5]
    ids = [node.get("id") for node in root.iter() if node.tag in ("location", "branchpoint")]
    assert len(set(ids)) == len(ids) == 4
    for placed in ("location", "branchpoint", "label", "nail", "name"):
        assert all(node.get("x") and node.get("y") for node in root.iter(placed))
    labels = [[label.get("kind") for label in edge.iter("label")] for edge in lamp.iter("transition")]
    assert labels[0] == ["select", "guard", "synchronisation", "assignment"]
    assert "<![CDATA[" not in text and "i &lt; 1 &amp;&amp; id &gt;= 0" in text


def test_comments_and_documentation_are_kept() -> None:
    root = ElementTree.fromstring(written(load(LAMP)))
    assert (root.findtext("declaration") or "").startswith("// the lamp\nconst int LONG = 5;\n")
    assert root[1].findtext("declaration") == ("/// A lamp that\n/// goes out.\n\nclock y;  // since the last press\n")
    comments = [label.text for label in root[1].iter("label") if label.get("kind") == "comments"]
    assert comments == ["dark", "// by itself"]
    assert [query.findtext("comment") for query in root.iter("query")] == [
        "goes_out: goes out\nnever for long\nEXPECT:T",
        "",
    ]


def test_a_model_comes_back_as_it_was() -> None:
    model = load(LAMP)
    back = load(written(model))
    assert same_network(model.network, back.network)
    assert properties(back) == properties(model)
    assert [item for item in canonical(back.document).items if isinstance(item, ast.Template)] == [
        item for item in model.document.items if isinstance(item, ast.Template)
    ]


def properties(model: LoadedModel) -> list[ast.Item]:
    return [item for item in model.document.items if isinstance(item, ast.PropertyDeclaration)]


PICTURE = """\
<nta><declaration>int   n;   // odd spacing
</declaration><template><name x="1" y="2">P</name>
<declaration>// nothing here
</declaration>
<location id="id7" x="10" y="20" color="#ff0000"><label kind="invariant" x="1" y="1">n&lt;=3</label></location>
<location id="id3" x="30" y="40"><name x="3" y="4">B</name>
<label kind="testcodeEnter" x="1" y="9">go();</label></location>
<init ref="id7"/>
<transition id="id9"><source ref="id3"/><target ref="id7"/><nail x="5" y="6"/></transition>
<transition controllable="false"><source ref="id7"/><target ref="id3"/>
<label kind="guard" x="7" y="8">n==1
&amp;&amp; n &lt; 2 // why
</label><label kind="comments" x="9" y="9">as agreed</label></transition>
</template><lsc><name>Chart</name></lsc>
<system>// instances
Q = P();
system Q;
gantt { G: n == 1 -> 0; }</system>
<queries><option key="a" value="b&quot;"/>
<query><formula></formula><comment>Part one</comment></query>
<query><formula>A[]  Q.B imply n == 1</formula><comment>  said twice  </comment><result outcome="success"/></query>
<query><formula>A[] Q.C</formula><comment>wrong</comment></query>
<query><formula>E&lt;&gt; ( n</formula><comment>broken</comment></query>
<query><formula>simulate [&lt;=10] { n }</formula><comment>statistics</comment></query></queries>
<simulator speed="1"/></nta>
"""


def test_an_import_and_export_without_a_change_changes_nothing() -> None:
    model = load(PICTURE)
    back = load(written(model))
    assert back.document == model.document
    assert back.document.comments == model.document.comments or [c.text for c in back.document.comments] == [
        c.text for c in model.document.comments
    ]
    assert (back.layout.templates, back.layout.queries) == (model.layout.templates, model.layout.queries)  # type: ignore[union-attr]
    assert written(back) == written(model)
    assert [query.name for query in back.unchecked if query.diagnostics] == ["wrong", "broken"]


def test_the_picture_survives_a_trip_through_text() -> None:
    model = load(PICTURE)
    assert model.layout is not None
    right = [item for item in model.document.items if not (getattr(item, "name", None) and item.name.name == "wrong")]  # type: ignore[union-attr]
    text = print_document(ast.Document(model.document.span, tuple(right), model.document.comments))
    layout = layout_from_json(Source("l", layout_to_json(model.layout)))
    back = load(written(load(text), layout))
    assert same_network(back.network, model.network)
    assert back.layout is not None
    known = model.layout.templates["P"]
    kept = back.layout.templates["P"]
    assert (kept.nodes.keys(), kept.edges) == (known.nodes.keys(), known.edges)
    assert [node.colour for node in kept.nodes.values()] == ["#ff0000", ""]
    assert list(kept.edges) == list(known.edges)


def test_what_is_new_gets_a_place_beside_what_has_one() -> None:
    old = load("process P() { init location A { to A; } } system P;")
    layout = load(written(old)).layout
    assert layout is not None
    moved = TemplateLayout(nodes={"A": layout.templates["P"].nodes["A"]})
    new = load("process P() { init location A { to A; to B; } location B { to A { guard true; } } } system P;")
    nodes = load(written(new, Layout({"P": moved}))).layout.templates["P"].nodes  # type: ignore[union-attr]
    assert nodes["A"].position == layout.templates["P"].nodes["A"].position
    assert nodes["B"].position is not None and nodes["B"].position.x > nodes["A"].position.x  # type: ignore[union-attr]


def test_a_label_is_written_as_it_was_only_while_it_means_the_same() -> None:
    edge = (
        '<transition><source ref="a"/><target ref="a"/><label kind="guard" x="1" y="1">1  &lt;  2</label></transition>'
    )
    model = load(
        f'<nta><template><name>P</name><location id="a" x="0" y="0"/><init ref="a"/>{edge}</template>'
        "<system>system P;</system></nta>"
    )
    assert model.layout is not None
    changed = load("process P() { state _a; init _a; trans _a -> _a { guard 1 < 3; }; } system P;")
    back = load(written(changed, model.layout)).layout
    assert back is not None
    label = back.templates["P"].edges[EdgeKey("_a", "_a", 0)].labels["guard"]
    assert (label.position, label.text) == (Point(1, 1), None)


def test_results_go_when_the_formula_or_the_expectation_changes() -> None:
    model = load(PICTURE)
    assert model.layout is not None
    text = print_document(model.document)
    for old, new, outcome in (
        ("n == 1 expect", "n == 2 expect", "EXPECT:T"),
        ("expect holds", "expect fails", "EXPECT:F"),
    ):
        assert old in text
        changed = text.replace(old, new)
        changed = "\n".join(line for line in changed.splitlines() if "Q.C" not in line)
        xml = written(load(changed), model.layout)
        assert "<result" not in xml and outcome in xml


def test_queries_that_uppaal_rejects_are_set_aside_and_found_again() -> None:
    model = load(
        "broadcast chan c;"
        "process P() { clock x; init location A { to A { guard x > 1; sync c?; } to A { sync c!; } } }"
        "system P; property p : A[] not deadlock; property r : A[] P.A;"
    )
    xml = written(model)
    assert "<formula>/* UPPAAL does not check: A[] !deadlock */</formula>" in xml
    assert properties(load(xml)) == properties(model)


# ---- random documents -----------------------------------------------------------------------------------------------


def random_model(random: Random) -> str:
    """The text of a model that uses a bit of everything, with every comment and documentation in a random place."""

    def maybe(text: str, chance: float = 0.4) -> str:
        return text if random.random() < chance else ""

    def remark(indent: str) -> str:
        return maybe(f"{indent}// {random.choice(['why', 'a < b & c', 'TODO'])}\n", 0.2)

    def doc(indent: str) -> str:
        return maybe(f"{indent}/// {random.choice(['how it is', 'x <= 3 && y > 2', 'it is'])}\n", 0.2)

    conditions = ["n < 2", "n == id || m[id] > 0", "forall (i : id_t) m[i] < 3", "x >= 1 && n != 3", "f(n) <= 2"]
    updates = ["n = 0", "x = 0", "m[id] = n, x = 0", "n = n < 3 ? n + 1 : 0", "g()"]
    lines = ["typedef int[0, 1] id_t;", "int[0, 3] n = 1;", "int[0, 3] m[id_t];", "chan c[id_t];", "broadcast chan b;"]
    lines += ["int f(int v) {", "    return v > 1 ? v & 1 : 0;", "}", "void g() {", "    n = 0;", "}"]
    text = remark("") + "\n".join(lines) + "\n\n"
    templates = random.randint(1, 3)
    for number in range(templates):
        names = [f"L{place}" for place in range(random.randint(1, 4))]
        point = maybe("Choice", 0.3)
        text += doc("") + f"process T{number}(const id_t id) {{\n" + remark("    ") + "    clock x;\n\n"
        initial = random.choice(names)
        for name in names:
            flags = maybe("init ", 1.0 if name == initial else 0.0) + maybe(
                random.choice(["urgent ", "committed "]), 0.2
            )
            text += remark("    ") + doc("    ") + f"    {flags}location {name} {{\n"
            text += maybe(f"        invariant x <= {random.randint(3, 9)};\n")
            for _ in range(random.randint(0, 3)):
                target = random.choice([*names, *([point] if point else [])])
                clauses = maybe("select i : id_t; ") + maybe(f"guard {random.choice(conditions)}; ")
                clauses += maybe(f"sync {random.choice(['c[id]!', 'c[1 - id]?', 'b!', 'b?'])}; ")
                clauses += maybe(f"assign {random.choice(updates)}; ")
                text += remark("        ") + doc("        ")
                text += f"        {maybe('uncontrollable ', 0.1)}to {target} {{ {clauses}}}\n"
            text += "    }\n"
        if point:
            text += f"    branchpoint {point} {{ to {names[0]} {{ probability 2; }} to {names[-1]}; }}\n"
        text += "}\n\n"
    instances = []
    for number in range(templates):
        if random.random() < 0.5:
            text += f"P{number} = T{number}({random.randint(0, 1)});\n"
            instances.append(f"P{number}")
        else:
            instances.append(f"T{number}")
    text += remark("") + f"system {', '.join(instances)};\n"
    for number in range(random.randint(0, 3)):
        title = maybe(' "never ever"')
        formula = random.choice(["A[] n < 3", "E<> n == 2 && m[0] > 1", "A[] not deadlock", "n == 1 --> n == 0"])
        name = random.choice([f"p{number}", f"q{number + 1}"])
        text += doc("") + f"property {name}{title} : {formula}{maybe(' expect fails')};\n"
    return text


@settings(max_examples=15)
@given(st.randoms(use_true_random=False))
def test_random_models_come_back_equal(random: Random) -> None:
    model = load(random_model(random))
    xml = written(model)
    back = load(xml)
    assert same_network(back.network, model.network)
    assert canonical(back.document) == canonical(model.document)
    assert sorted(c.text for c in back.document.comments) == sorted(c.text for c in model.document.comments)
    again = load(written(back))
    assert again.document == back.document
    assert again.layout == back.layout
    text = print_document(back.document)
    document, diagnostics = parse_document(Source("m.ta", text))
    assert diagnostics == ()
    assert document == canonical(model.document)
    assert back.layout is not None
    over = load(written(load(text), layout_from_json(Source("l", layout_to_json(back.layout)))))
    assert over.layout is not None
    assert (over.layout.templates.keys(), over.layout.queries) == (back.layout.templates.keys(), back.layout.queries)
    for name, picture in back.layout.templates.items():
        assert over.layout.templates[name].nodes == picture.nodes
        assert over.layout.templates[name].edges == picture.edges


@settings(max_examples=12)
@given(st.randoms(use_true_random=False))
def test_random_models_have_the_same_verdicts_after_the_trip(random: Random) -> None:
    model = load(random_model(random))
    back = load(written(model))
    text = load(print_document(back.document))
    answers = [
        [verdict.answer for verdict in verify(m.network, m.queries, limits=Limits(states=2000), trace=False)]
        for m in (model, back, text)
    ]
    assert answers[0] == answers[1] == answers[2]


def test_characters_that_xml_cannot_hold_become_blanks() -> None:
    root = ElementTree.fromstring(written(load(LAMP.replace("// the lamp", '// the \x0blamp <&> "1"'))))
    assert (root.findtext("declaration") or "").startswith('// the  lamp <&> "1"\n')


def test_two_nodes_never_get_one_identifier() -> None:
    text = "process P() { init location A { to B; } location B; } system P;"
    layout = load(written(load(text))).layout
    assert layout is not None
    nodes = {name: replace(node, id="id7") for name, node in layout.templates["P"].nodes.items()}
    xml = ElementTree.fromstring(written(load(text), Layout({"P": replace(layout.templates["P"], nodes=nodes)})))
    first, second = [node.get("id") for node in xml.iter("location")]
    assert first == "id7"
    assert second != "id7"


def test_a_committed_location_is_not_urgent_as_well(tmp_path: Path) -> None:
    model = tachk.loads("process P() { state A; commit A; urgent A; init A; }\nsystem P;")
    text = tachk.export(model, "xml")  # UPPAAL refuses both at once, and committed locations are urgent anyway
    assert "<committed/>" in text
    assert "<urgent/>" not in text
    xml = tmp_path / "m.xml"
    xml.write_text(text, "utf-8")
    assert tachk.diff(model, xml) == ""
