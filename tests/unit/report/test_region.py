"""The forms in which a region is told."""

from __future__ import annotations

import csv
import json
from io import StringIO
from pathlib import Path

import jsonschema
import pytest

from tachk import Answer, Limits, UsageError, loads
from tachk.report.region.json import region_to_csv
from tachk.report.region.synthesis import Synthesis
from tachk.verify.synthesis.region import CellEvidence

SCHEMA = Path(__file__).parents[3] / "docs/schema/synthesize.schema.json"
MODEL = """
const int A = 1;
const int B = 1;
const int C = 1;
process P() {
    clock x;
    init location s { invariant x <= A + C; to t { guard x >= B; } }
    location t;
}
system P;
property never "t is never reached" : A[] not P.t;
"""


@pytest.fixture(scope="module")
def found() -> Synthesis:
    return loads(MODEL).synthesize(over="A=0..4,B=1..5:2,C=0..1", property="never")


def test_a_region_in_python(found: Synthesis) -> None:
    assert found.inequalities == "A + C < B"
    assert found.answer(A=2, B=3, C=0) is Answer.HOLDS
    assert found.answer(A=3, B=3, C=0) is Answer.FAILS
    with pytest.raises(KeyError):
        found.answer(A=3, B=2, C=0)
    corner = found.at(A=3, B=3, C=0)
    assert corner in found.corners
    assert corner.verdict is not None
    assert corner.verdict.trace is not None
    assert "A + C < B" in repr(found) or "never holds" in repr(found)


def test_the_machine_form_follows_its_schema(found: Synthesis) -> None:
    data = json.loads(json.dumps(found.to_dict()))
    jsonschema.validate(data, json.loads(SCHEMA.read_text()))
    assert [parameter["bound"] for parameter in data["parameters"]] == ["upper", "lower", "upper"]
    assert len(data["cells"]) == 30
    assert data["cells"][1]["values"] == {"A": 0, "B": 1, "C": 1}
    assert data["searched"] == found.region.searched < 30


def test_a_table_has_a_line_for_each_cell(found: Synthesis) -> None:
    rows = list(csv.DictReader(StringIO(region_to_csv(found.region))))
    assert len(rows) == len(found.to_rows()) == 30
    for row in rows:
        values = {name: int(row[name]) for name in "ABC"}
        assert row["answer"] == ("holds" if values["A"] + values["C"] < values["B"] else "fails")
    assert {row["evidence"] for row in rows} >= {CellEvidence.SEARCH.value, CellEvidence.IMPLIED.value}


def test_the_text_has_a_grid_for_each_further_value(found: Synthesis) -> None:
    lines = [line.strip() for line in found.to_text().splitlines()]
    assert lines.count("5 #####") == 1
    assert lines.count("5 ####.") == 1
    assert lines.count("B") == 2
    assert "never holds in 15 of 30 cells." in lines
    assert found.to_text(every_corner=True).count("explored") >= 2


def test_one_constant_is_a_row() -> None:
    text = loads(MODEL, C=0).synthesize(over="A=0..5", property="never").to_text()
    assert "#....." in text
    assert "A < 1" in text or "A <= 0" in text


@pytest.mark.parametrize("ending", ["svg", "png", "pdf"])
def test_a_region_is_drawn(found: Synthesis, tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"region.{ending}"
    found.plot(path)
    assert path.stat().st_size > 3000
    if ending == "svg":
        text = path.read_text()
        assert "A + C &lt; B" in text
        assert "C = 1" in text


def test_what_cannot_be_drawn_is_reported(found: Synthesis, tmp_path: Path) -> None:
    with pytest.raises(UsageError):
        found.plot(tmp_path / "region.gif")
    wide = loads(MODEL).synthesize(over="A=0..1,B=1..2,C=0..12", property="never")
    with pytest.raises(UsageError):
        wide.plot(tmp_path / "region.svg")


def test_unknown_cells_are_shown_with_their_reason(tmp_path: Path) -> None:
    cut = loads(MODEL).synthesize(over="A=0..2,B=1..3", property="never", limits=Limits(seconds=0))
    assert {cell.answer for cell in cut.region.cells} == {Answer.UNKNOWN}
    assert "time limit" in cut.to_text()
    assert "???" in cut.to_text()
    cut.plot(tmp_path / "region.svg")
