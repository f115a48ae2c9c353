"""What environments do in tests: they must act, set variables, or are none."""

from __future__ import annotations

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.simulation.testing.tester import TestVerdict
from tests.support.seeds import seeds
from tests.unit.simulation.testing.test_tester import LAMP, outcome_of

PUNCTUAL = LAMP.replace("init location Idle {", "init location Idle { invariant pause <= 10;")
VALUES = (
    LAMP.replace("chan press;", "int[-3, 3] level;\nint seen;\nchan press;", 1)
    .replace("guard pause >= 2;", "select n : int[-3, 3]; guard pause >= 2;")
    .replace("assign pause = 0;", "assign pause = 0, level = n;")
    .replace("sync light!;", "sync light!; assign seen = level * 2;")
    .replace("as press()", "as press(level)")
    .replace("as light()", "as light(seen)")
)


@pytest.mark.parametrize("pause", [2, 10])
@pytest.mark.parametrize("seed", seeds(range(4)))
def test_environment_acts_where_it_must(seed: int, pause: int) -> None:
    text = PUNCTUAL.replace("pause >= 2", f"pause >= {pause}")
    result = outcome_of(tachk.loads(text), text, seed)
    assert result.verdict is TestVerdict.PASS
    assert result.inputs > 5


def test_inputs_set_variables() -> None:
    result = outcome_of(tachk.loads(VALUES), VALUES)
    assert result.verdict is TestVerdict.PASS
    sent = {event.cells["level"] for event in result.recording.events if event.name == "press"}
    assert min(sent) < 0 < max(sent), "negative values too"
    changed = tachk.loads(VALUES.replace("level * 2", "level * 3"))
    assert outcome_of(changed, VALUES).verdict is TestVerdict.FAIL


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("replaces Finger", "replaces Finger, Lamp", "replaces every process"),
        ("as light()", "as light(time = 1)", "column `time`"),
        ("as light()", "as light(event = 1)", "column `event`"),
        (
            "init location Idle {",
            "init location Idle { to Idle { sync press?; }",
            "may go from Finger to Finger",
        ),
    ],
)
def test_models_without_a_system_between_its_environment(before: str, after: str, message: str) -> None:
    text = LAMP.replace(before, after)
    with pytest.raises(UsageError, match=message):
        outcome_of(tachk.loads(text), text)
