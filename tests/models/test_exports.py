"""The shipped models are written for UPPAAL in its order of sections, and with conditions that it takes."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tachk.base.resources import data_root
from tachk.base.span import Source
from tachk.formats.catalogue import export_model
from tachk.formats.exported import Writing
from tachk.formats.loading.load import load_model
from tachk.formats.uppaal.portability import portability
from tachk.formats.uppaal.versions import UppaalVersion

pytestmark = pytest.mark.drawn

MODELS = data_root() / "models"
WRITTEN = [*sorted((MODELS / "classics").glob("*.ta")), MODELS / "micro_xrce_dds" / "client_3_0.ta"]
_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
_END = re.compile(r"\bsystem\b[^;{}]*;\s*(progress\s*\{[^{}]*\}\s*)?(gantt\s*\{.*\}\s*)?\Z", re.DOTALL)


@pytest.mark.parametrize("path", WRITTEN, ids=lambda path: path.stem)
def test_uppaal_takes_the_export(path: Path) -> None:
    model = load_model(str(path))
    xml = export_model(model, "xml", Writing()).text
    xta = export_model(model, "xta", Writing()).text
    ends = [next(ElementTree.fromstring(xml).iter("system")).text, xta]
    assert all(end is not None and _END.search(_COMMENT.sub("", end)) for end in ends)
    for name, text in (("again.xml", xml), ("again.xta", xta)):
        found = portability(load_model(Source(name, text)), UppaalVersion.UPPAAL_5_0)
        assert [d for d in found if d.code.startswith("E")] == []


def test_a_query_in_a_comment_of_the_export_is_not_checked() -> None:
    """UPPAAL refuses `deadlock` beside priorities: as a query it is told, in the comment that `export` writes not."""
    text = """\
chan a, b;
chan priority a < b;
process P() { state A; init A; }
system P;
property stuck : A[] not deadlock;
property read : A[] P.A;
"""
    model = load_model(Source("model.ta", text))
    version = UppaalVersion.UPPAAL_5_0
    assert [d.span.text for d in portability(model, version) if d.code == "E0815"] == ["deadlock"]
    xml = export_model(model, "xml", Writing()).text
    assert "/* UPPAAL does not check: A[] !deadlock */" in xml
    again = load_model(Source("again.xml", xml))
    assert [query.name for query in again.queries] == ["stuck", "read"]
    assert [d for d in portability(again, version) if d.code.startswith("E")] == []
    bare = load_model(
        Source("bare.xml", xml.replace("/* UPPAAL does not check: ", "").replace("deadlock */", "deadlock"))
    )
    assert [d.code for d in portability(bare, version) if d.code.startswith("E")] == ["E0815"]


def test_declarations_below_the_system_line() -> None:
    text = """\
int n;
process P() { state A; init A; }
system P;
const bool FEW = true;
Q = P();
property p : A[] n == 0 expect holds if FEW else fails;
"""
    model = load_model(Source("model.ta", text))
    xml = export_model(model, "xml", Writing()).text
    section = next(ElementTree.fromstring(xml).iter("system")).text
    assert section is not None and section.split("\n") == ["const bool FEW = true;", "Q = P();", "system P;", ""]
