"""The sequence chart of a test shows its events, and why it failed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

import tachk
from tachk.cli.main import app
from tachk.engine.options import Limits
from tachk.report.conformance.test_chart import chart_of_test
from tachk.report.drawing.sequence.chart import Chart, Message, Note
from tachk.simulation.testing.tested_model import TestRequest, run_test_of_model
from tachk.simulation.testing.tester import TestVerdict
from tests.unit.simulation.testing.test_tester import LAMP, outcome_of

SILENT = LAMP.replace("invariant x <= 5; to Off { guard x >= 3;", "to Off { guard x >= 3 && x < 0;")
EARLY = LAMP.replace("guard x >= 3;", "guard x <= 1;")


def chart(system: str, **more: int) -> Chart:
    result = outcome_of(tachk.loads(system), LAMP, **more)
    drawn = chart_of_test(result, {"press"}, "lamp", "1 ms")
    assert drawn.lifelines == ("test", "system") and drawn.title.startswith(result.verdict.value)
    events = result.recording.events[-len(drawn.messages) :]
    assert [(m.label, m.sent.time) for m in drawn.messages] == [(f"{e.name}()", e.time) for e in events]
    assert all((m.sender, m.receivers) == ((0, (1,)) if m.label == "press()" else (1, (0,))) for m in drawn.messages)
    return drawn


def notes(drawn: Chart) -> list[str]:
    return [event.text for event in drawn.events if isinstance(event, Note)]


def test_what_is_allowed_stands_at_the_end() -> None:
    assert notes(chart(LAMP)) == ["the end of the test"]
    silent = notes(chart(SILENT))
    assert silent[:3] == ["this silence is too long", "in Lamp.Waking", "allowed: light()"]
    early = notes(chart(EARLY))
    assert early[:3] == ["not allowed: light()", "in Lamp.Waking", "allowed: light()"]


def test_what_is_allowed_has_the_times_of_the_column() -> None:
    """A unit of the model is not one of the chart."""
    coarse = [text.replace("1 ms", "10 ms") for text in (LAMP, EARLY)]
    lamp = tachk.loads(coarse[0]).loaded
    result, _ = run_test_of_model(lamp, "lamp", TestRequest(tachk.loads(coarse[1]).loaded, "1s"), Limits(states=10_000))
    found = result.conformance
    assert found is not None and found.refusal is not None and found.time_unit == "10 ms"
    allowed = found.refusal.enabled_events[0]
    window = f"from {allowed.earliest * 10} ms to {allowed.latest * 10} ms"
    assert notes(chart_of_test(result, {"press"}, "lamp", "10 ms"))[3] == window


def test_the_end_of_a_long_test_is_drawn() -> None:
    drawn = chart(LAMP, seed=1)
    assert len(drawn.messages) < 200 and "without" not in drawn.description
    lamp = tachk.loads(LAMP).loaded
    result, _ = run_test_of_model(lamp, "lamp", TestRequest(lamp, "3000ms"), Limits(states=10_000))
    assert result.verdict is TestVerdict.PASS and len(result.recording.events) > 200
    long = chart_of_test(result, {"press"}, "lamp", "2 ms")
    assert len([event for event in long.events if isinstance(event, Message)]) == 200
    assert long.messages[-1].sent.time == 2 * result.recording.events[-1].time and long.unit == "ms"
    assert f"without the first {len(result.recording.events) - 200} events" in long.description


def test_a_chart_that_cannot_be_written_is_an_error_before_the_test(tmp_path: Path) -> None:
    (tmp_path / "lamp.ta").write_text(LAMP, encoding="utf-8")
    files = [str(tmp_path / name) for name in ("lamp.ta", "lamp.ta", "chart.txt", "events.jsonl")]
    given = ["test", files[0], "--simulate", files[1], "--for", "100ms", "--chart", files[2], "--record", files[3]]
    outcome = CliRunner().invoke(app, given)
    assert outcome.exit_code == 2 and ".svg or .png" in outcome.output
    assert not Path(files[3]).exists()


@pytest.mark.parametrize("suffix", [".svg", ".png"])
def test_the_command_draws_it(tmp_path: Path, suffix: str) -> None:
    for name, text in (("lamp.ta", LAMP), ("silent.ta", SILENT)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    files = [str(tmp_path / name) for name in ("lamp.ta", "silent.ta", f"chart{suffix}")]
    given = ["test", files[0], "--simulate", files[1], "--for", "100ms", "--chart", files[2], "--format", "json"]
    outcome = CliRunner().invoke(app, given)
    assert outcome.exit_code == 10 and json.loads(outcome.stdout)["verdict"] == "fail"
    assert Path(files[2]).stat().st_size > 1000
