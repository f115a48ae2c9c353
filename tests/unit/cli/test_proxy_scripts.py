"""Runs of a test suite as scripts for the relay between real programs."""

from __future__ import annotations

import json
from pathlib import Path

from click.testing import CliRunner

from tachk.base.span import Source
from tachk.cli.main import app
from tachk.xrce.proxy.fault_plan import parse_fault_plan
from tachk.xrce.proxy.rules import RelayAction

ROOT = Path(__file__).parents[3]
PUBLICATION = ROOT / "models" / "micro_xrce_dds" / "publication.ta"


def written(folder: Path, model: Path, *options: str) -> str:
    result = CliRunner().invoke(app, ["tests", str(model), *options, "-o", str(folder)])
    assert result.exit_code in (0, 20), result.output
    return result.stderr


def losses_of(run: Path, signals: Path) -> int:
    """How many messages the links lose in a run, as the model counts them."""
    arguments = ["replay", str(PUBLICATION), str(run), "--record", "losses", "-o", str(signals), "--quiet"]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    rows = map(json.loads, signals.read_text(encoding="utf-8").splitlines())
    return max((row["losses"] for row in rows if "losses" in row), default=0)


def test_each_run_of_a_suite_is_a_script_for_the_relay(tmp_path: Path) -> None:
    written(tmp_path, PUBLICATION, "-D", "MESSAGES=2", "--max-states", "5000")
    scripts = sorted(tmp_path.glob("*.rules"))
    assert len(scripts) == len(list(tmp_path.glob("*.run"))) >= 3
    dropped = 0
    for script in scripts:
        text = script.read_text(encoding="utf-8")
        assert "--listen 9001 --to" in text
        rules = parse_fault_plan(Source(str(script), text), [9001])
        assert [str(rule) for rule in rules] == [line for line in text.splitlines() if not line.startswith("#")]
        drops = sum(rule.action is RelayAction.DROP for rule in rules)
        assert drops == losses_of(script.with_suffix(".run"), tmp_path / "losses.jsonl")
        dropped += drops
    assert dropped > 0


def test_messages_that_are_no_packets_make_no_script(tmp_path: Path) -> None:
    model = tmp_path / "other.ta"
    model.write_text(
        "const int LINKS = 1;\nchan send[LINKS][1];\n"
        "process P() { init location A { to B { sync send[0][0]!; } } location B; }\n"
        "process Q() { init location A { to A { sync send[0][0]?; } } }\nsystem P, Q;\n"
    )
    said = written(tmp_path / "suite", model)
    assert "other-1.rules: not written: " in said and "which packets this stands for" in said
    assert (tmp_path / "suite" / "other-1.run").exists() and not list((tmp_path / "suite").glob("*.rules"))
