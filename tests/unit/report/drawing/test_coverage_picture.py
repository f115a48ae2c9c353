"""`tachk draw --coverage`: which edges recordings have taken."""

from __future__ import annotations

import json
from math import log10
from pathlib import Path

import pytest
from click.testing import CliRunner

from tachk.cli.main import app

ROOT = Path(__file__).resolve().parents[4]
DIMMER = ROOT / "examples/dimmer"


def test_the_edges_that_a_recording_takes_are_counted_in_the_picture(tmp_path: Path):
    told, picture = tmp_path / "coverage.json", tmp_path / "dimmer.svg"
    asked = [str(DIMMER / "dimmer.ta"), str(DIMMER / "pressed.csv"), "--coverage", "--format", "json", "-o", str(told)]
    assert CliRunner().invoke(app, ["conform", *asked]).exit_code == 0
    edges = json.loads(told.read_text())["coverage"]
    assert {edge["template"] for edge in edges} == {"Lamp"}
    drawn = CliRunner().invoke(app, ["draw", asked[0], "--coverage", str(told), "-o", str(picture)])
    assert drawn.exit_code == 0, drawn.output
    svg = picture.read_text()
    taken, never = [edge for edge in edges if edge["times"]], [edge for edge in edges if not edge["times"]]
    assert svg.count('class="edge taken"') == len(taken) > 0
    assert svg.count('class="edge never"') == len(never)
    assert f"{len(taken)} of {len(edges)} edges taken" in svg
    for edge in taken:
        assert f">{edge['times']}×<" in svg
        assert f"stroke-width:{round(1.5 + log10(edge['times']), 1):g}" in svg, "the thicker the more often"


@pytest.mark.parametrize(("text", "said"), [("{}", "contains no coverage"), ("[", "Expecting value")])
def test_another_file_shows_no_coverage(tmp_path: Path, text: str, said: str):
    path = tmp_path / "other.json"
    path.write_text(text)
    drawn = CliRunner().invoke(app, ["draw", str(DIMMER / "dimmer.ta"), "--coverage", str(path)])
    assert (drawn.exit_code, said in drawn.stderr) == (2, True)


def test_the_coverage_of_another_model(tmp_path: Path):
    path = tmp_path / "other.json"
    asked = [str(DIMMER / "dimmer.ta"), str(DIMMER / "pressed.csv"), "--coverage", "--format", "json", "-o", str(path)]
    assert CliRunner().invoke(app, ["conform", *asked]).exit_code == 0
    path.write_text(path.read_text().replace('"template": "Lamp"', '"template": "P"'))
    drawn = CliRunner().invoke(app, ["draw", str(DIMMER / "dimmer.ta"), "--coverage", str(path)])
    assert (drawn.exit_code, "no template of" in drawn.stderr) == (2, True)
