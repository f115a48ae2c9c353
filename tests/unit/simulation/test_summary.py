"""The summary of `tachk simulate --format json`."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
from click.testing import CliRunner

from tachk.cli.main import app

SCHEMA = json.loads((Path(__file__).parents[3] / "docs/schema/simulate.schema.json").read_text(encoding="utf-8"))
MODEL = """
chan send; int[0, 2] losses; int[0, 100] got;
process Sender() { clock x; init location S { invariant x <= 1; to S { guard x == 1; sync send!; assign x = 0; } } }
process Link() {
    init location Free {
        /// arrives
        to Free { sync send?; assign got = got + 1; }
        /// ! is lost
        to Free { guard losses < 2; sync send?; assign losses = losses + 1; }
    }
}
system Sender, Link;
"""


def test_follows_the_schema_and_says_what_happened(tmp_path: Path) -> None:
    path = tmp_path / "link.ta"
    path.write_text(MODEL, encoding="utf-8")
    asked = [
        "simulate",
        str(path),
        "--until",
        "10",
        "--runs",
        "2",
        "--fault",
        "lost=send:2,4,6",
        "--monitor",
        "G got < 8",
    ]
    result = CliRunner().invoke(app, [*asked, "--format", "json"])
    found = json.loads(result.stdout)
    jsonschema.validate(found, SCHEMA)
    assert found["faults"] == [{"order": "lost=send:2,4,6", "done": 4, "missed": 2}]
    (formula,) = found["formulas"]
    assert (formula["false"], formula["violating"]) == (2, [0, 1])


def test_a_script_has_a_summary_of_its_own(tmp_path: Path) -> None:
    path = tmp_path / "link.ta"
    path.write_text(MODEL, encoding="utf-8")
    CliRunner().invoke(app, ["simulate", str(path), "--until", "3", "-o", str(tmp_path / "one-{run}.run")])
    asked = ["simulate", str(path), "--policy", "script", str(tmp_path / "one-0.run"), "--monitor", "G got < 8"]
    found = json.loads(CliRunner().invoke(app, [*asked, "--format", "json"]).stdout)
    jsonschema.validate(found, SCHEMA)
    assert (found["transitions"], found["formulas"]) == (
        3,
        [{"name": "p1", "formula": "G (got < 8)", "verdict": "true"}],
    )


def test_the_summary_goes_into_a_file(tmp_path: Path) -> None:
    (tmp_path / "m.ta").write_text(MODEL, encoding="utf-8")
    file = tmp_path / "summary.json"
    asked = ["simulate", str(tmp_path / "m.ta"), "--until", "3", "--format", "json", "-o", str(file)]
    result = CliRunner().invoke(app, asked)
    assert (result.exit_code, result.stdout) == (0, "")
    jsonschema.validate(json.loads(file.read_text(encoding="utf-8")), SCHEMA)
