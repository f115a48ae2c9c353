"""A UPPAAL file that goes to text and comes back: what was not touched is what it was."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import chdir
from pathlib import Path

import pytest

from tachk.api import model as api
from tachk.cli.main import app

VARIANTS = """\
<nta>
<declaration>int n;
// trailing remark of the declarations</declaration>
<template><name>P</name><declaration>// only a remark here</declaration>
<location id="id0" x="0" y="0"><name x="-10" y="-34">A</name></location><init ref="id0"/></template>
<template><name>Observer</name><location id="id1" x="0" y="0"><name x="-10" y="-34">Error</name></location>
<init ref="id1"/></template>
<system>system P;
//system P, Observer;</system>
<queries><query><formula>A[] n == 0</formula><comment>n never changes</comment></query>
<query><formula>A[] not Observer.Error</formula><comment>sees no error</comment>
<result outcome="success" type="quality" timestamp="2024-01-01 00:00:00 +0000"/></query>
<query><formula>E&lt;&gt; Gone.s</formula><comment/></query></queries>
</nta>
"""
SAVED = """\
<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE nta PUBLIC '-//Uppaal Team//DTD Flat System 1.1//EN' \
'http://www.it.uu.se/research/group/darts/uppaal/flat-1_2.dtd'>
<nta>
	<declaration>// Place global declarations here.
const int  N=3 ;
int a [ N ]={1,2,3};   /* three
      of them */
bool  odd(int i) { return (i%2)==1; }
chan go;</declaration>
	<template>
		<name x="5" y="5">P</name>
		<parameter>const int[0, 1]   id</parameter>
		<declaration>// Place local declarations here.
clock x ; int  k:=0;</declaration>
		<location id="id0" x="-100" y="0">
			<name x="-110" y="-34">A</name>
			<label kind="invariant" x="-110" y="17">x&lt;=5</label>
		</location>
		<location id="id1" x="100" y="0">
			<name x="90" y="-34">B</name>
			<urgent/>
		</location>
		<init ref="id0"/>
		<transition>
			<source ref="id0"/>
			<target ref="id1"/>
			<label kind="guard" x="-20" y="-34">x&gt;=2&amp;&amp;odd( a[0] )</label>
			<label kind="assignment" x="-20" y="0">k:=1</label>
			<nail x="0" y="17"/>
		</transition>
	</template>
	<system>// Place template instantiations here.
P0=P(0);
// P1 = P(1);
system P0 ;</system>
	<queries>
		<query>
			<formula>E&lt;&gt; P0.B</formula>
			<comment>can act</comment>
		</query>
	</queries>
</nta>
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path) -> Iterator[Path]:
    with chdir(tmp_path):
        yield tmp_path


def convert(source: str, target: str) -> str:
    with pytest.raises(SystemExit) as end:
        app(["convert", source, target], prog_name="tachk")
    assert end.value.code == 0
    return Path(target).read_text(encoding="utf-8")


@pytest.mark.parametrize("with_layout", [True, False])
def test_comments_and_queries_survive(with_layout: bool) -> None:
    Path("a.xml").write_text(VARIANTS)
    text = convert("a.xml", "a.ta")
    assert "property q2 : A[] !Observer.Error expect holds;" in text
    if not with_layout:
        Path("a.layout.json").unlink()
    back = convert("a.ta", "b.xml")
    sections = dict(re.findall(r"<(declaration|system)>(.*?)</\1>", back, re.DOTALL)[:1])
    assert "// trailing remark of the declarations" in sections["declaration"]
    assert "<declaration>// only a remark here" in back
    system = back[back.index("<system>") : back.index("</system>")]
    assert "//system P, Observer;" in system
    assert "wrong" not in system
    assert len(re.findall("<query>", back)) == 3
    assert "sees no error" in back
    assert "<formula>E&lt;&gt; Gone.s</formula>" in back
    assert ("<result outcome" in back) is with_layout
    loaded = api.load("b.xml").loaded
    assert [formula.name for formula in loaded.formulas] == ["q1", "q2", "q3"]


HEADINGS = """\
<nta><declaration>int n;</declaration>
<template><name>P</name><location id="id0"><name>A</name></location><init ref="id0"/></template>
<system>system P;</system>
<queries><query><formula/><comment>== Safety ==</comment></query>
<query><formula>A[] n == 0</formula><comment>stays</comment></query>
<query><formula></formula><comment>Two lines\n  */ of \\n // a heading</comment></query>
<query><formula>E&lt;&gt; P.A</formula><comment/></query>
<query><formula>E&lt;&gt; Gone.x</formula><comment>about something\nthat is gone</comment></query>
<query><formula>A[] P.x</formula><comment>named: a title</comment></query>
<query><formula>E&lt;&gt; (</formula><comment>unreadable</comment></query>
<query><formula>sat: Scenario</formula><comment/></query>
<query><formula>== Reach ==</formula><comment>sub</comment></query>
</queries></nta>
"""


@pytest.mark.parametrize("with_layout", [True, False])
def test_headings_and_wrong_queries_survive_in_their_places(with_layout: bool) -> None:
    Path("a.xml").write_text(HEADINGS)
    text = convert("a.xml", "a.ta")
    if not with_layout:
        Path("a.layout.json").unlink()
    listed = r"<query>\s*<formula/?>(?:([^<]*)</formula>)?\s*<comment/?>(?:([^<]*)</comment>)?"
    assert re.findall(listed, convert("a.ta", "b.xml")) == re.findall(listed, HEADINGS)
    Path("b.layout.json").unlink(missing_ok=True)
    assert convert("b.xml", "b.ta") == text
    with pytest.raises(SystemExit) as end:
        app(["diff", "a.xml", "a.ta"], prog_name="tachk")
    assert end.value.code == 0


def test_another_wrong_query_is_a_difference(capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.xml").write_text(HEADINGS)
    convert("a.xml", "a.ta")
    Path("b.xml").write_text(HEADINGS.replace("Gone.x", "Gone.y"))
    capsys.readouterr()
    with pytest.raises(SystemExit) as end:
        app(["diff", "b.xml", "a.ta"], prog_name="tachk")
    assert end.value.code == 1
    assert capsys.readouterr().out == "queries that are wrong\n  - E<> Gone.y\n  + E<> Gone.x\n"


def test_a_query_about_an_absent_process_is_rejected_and_no_mistake(capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.xml").write_text(VARIANTS.replace("<query><formula>E&lt;&gt; Gone.s</formula><comment/></query>", ""))
    convert("a.xml", "a.ta")
    for name in ("a.xml", "a.ta"):
        capsys.readouterr()
        with pytest.raises(SystemExit) as end:
            app(["verify", name], prog_name="tachk")
        said = capsys.readouterr().out
        assert end.value.code == 3
        assert "error[E0733]: no process `Observer` runs: it is not in the system line" in said
        assert "1 passed, 1 cannot be checked" in said
    text = Path("a.ta").read_text().replace("system P;", "system P, Observer;")
    Path("a.ta").write_text(text)
    assert api.load("a.ta").verify()["q2"].answer.value == "fails"


def test_a_file_as_uppaal_saves_it_comes_back_letter_by_letter() -> None:
    Path("a.xml").write_text(SAVED)
    convert("a.xml", "a.ta")
    assert convert("a.ta", "b.xml") == SAVED
    assert convert("a.xml", "c.xml") == SAVED


def test_only_the_section_that_was_edited_is_written_anew() -> None:
    Path("a.xml").write_text(SAVED)
    text = convert("a.xml", "a.ta")
    assert "int k = 0;" in text
    Path("a.ta").write_text(text.replace("int k = 0;", "int k = 1;"))
    back = convert("a.ta", "b.xml")
    changed = set(back.splitlines()) ^ set(SAVED.splitlines())
    assert changed == {"clock x ; int  k:=0;</declaration>", "clock x;", "int k = 1;", "</declaration>"}


@pytest.mark.parametrize(("before", "after"), [("three\n", "four\n"), ("// P1 = P(1);\n", "")])
def test_a_comment_that_was_edited_is_not_brought_back(before: str, after: str) -> None:
    Path("a.xml").write_text(SAVED)
    text = convert("a.xml", "a.ta")
    assert before in text
    Path("a.ta").write_text(text.replace(before, after))
    back = convert("a.ta", "b.xml")
    assert before.strip() not in back
    assert after.strip() in back


def test_comments_outside_sections_find_a_place() -> None:
    Path("a.ta").write_text(
        "// the unit\ntime_unit = 1 ms;\nint n;\n// about P\nprocess P() { init location A; }\n"
        "// about Q\nprocess Q() { init location B; }\nsystem P, Q;\n// about p\nproperty p : E<> P.A; // behind p\n"
        "// the last\n"
    )
    back = convert("a.ta", "a.xml")
    for comment in ("// the unit", "// about P", "// about Q", "// about p", "// behind p", "// the last"):
        assert back.count(comment) == 1, comment
    convert("a.xml", "b.ta")
    again = convert("b.ta", "b.xml")
    assert again == back


def test_convert_overwrites_no_edited_file(capsys: pytest.CaptureFixture[str]) -> None:
    Path("a.xml").write_text(SAVED)
    text = convert("a.xml", "a.ta")
    assert convert("a.xml", "a.ta") == text, "once more does no harm"
    layout = Path("a.layout.json").read_text()
    for edited in ("a.ta", "a.layout.json"):
        Path("a.ta").write_text(text)
        Path("a.layout.json").write_text(layout)
        Path(edited).write_text("// mine\n")
        with pytest.raises(SystemExit) as end:
            app(["convert", "a.xml", "a.ta"], prog_name="tachk")
        assert end.value.code == 2
        assert f"error: {edited} exists with other contents" in capsys.readouterr().err
        assert Path(edited).read_text() == "// mine\n"
    with pytest.raises(SystemExit) as end:
        app(["convert", "a.xml", "a.ta", "--force"], prog_name="tachk")
    assert end.value.code == 0
    assert (Path("a.ta").read_text(), Path("a.layout.json").read_text()) == (text, layout)


@pytest.mark.parametrize(
    ("dtd", "empty"),
    [("1.1", "<formula></formula>\n\t\t\t<comment></comment>"), ("1.6", "<formula/>\n\t\t\t<comment/>")],
)
def test_small_habits_of_the_versions(dtd: str, empty: str) -> None:
    """No coordinates of a name, empty elements, branchpoints, and a comment in a formula, which is there only once."""
    saved = SAVED.replace("1.1", dtd).replace("flat-1_2", "flat-1_2" if dtd == "1.1" else "flat-1_6")
    saved = saved.replace('<name x="5" y="5">P</name>', "<name>P</name>")
    long = '\t\t<branchpoint id="id5" x="0" y="100">\n\t\t</branchpoint>\n'
    point = long if dtd == "1.1" else long.replace(">\n\t\t</branchpoint>", "/>")
    saved = saved.replace("\t\t<init ref", f"{point}\t\t<init ref")
    more = "<formula>// once\nE&lt;&gt; P0.A</formula>\n\t\t\t<comment>again</comment>"
    blank = "<formula>\n\t\t\t</formula>\n\t\t\t<comment>a heading</comment>"
    for entry in (empty, more, blank):
        saved = saved.replace("\t</queries>", f"\t\t<query>\n\t\t\t{entry}\n\t\t</query>\n\t</queries>")
    Path("a.xml").write_text(saved)
    convert("a.xml", "a.ta")
    assert convert("a.ta", "b.xml") == saved
    convert("b.xml", "b.ta")
    assert convert("b.ta", "c.xml") == saved


def test_message_sequence_charts_come_back(capsys: pytest.CaptureFixture[str]) -> None:
    chart = "<lsc>\n\t\t<name>Scenario</name>\n\t</lsc>"
    saved = SAVED.replace("\t<system>", f"\t{chart}\n\t<system>").replace(
        "system P0 ;", "S = Scenario();\nsystem P0, S;"
    )
    Path("a.xml").write_text(saved)
    convert("a.xml", "a.ta")
    assert convert("a.ta", "b.xml") == saved
    for name in ("a.xml", "a.ta"):
        capsys.readouterr()
        with pytest.raises(SystemExit) as end:
            app(["verify", name], prog_name="tachk")
        assert end.value.code == 3
        assert "error[E0750]: `S` is a message sequence chart" in capsys.readouterr().err
