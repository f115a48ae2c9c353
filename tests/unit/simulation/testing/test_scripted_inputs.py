"""Inputs of a recording, at its times."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
from click.testing import CliRunner

import tachk
from tachk.cli.main import app
from tachk.engine.options import Limits
from tachk.recordings.conformance.events import EventLog, RecordedEvent
from tachk.simulation.testing.goals import TestGoal
from tachk.simulation.testing.tested_model import TestRequest, run_test_of_model
from tachk.simulation.testing.tester import TestVerdict

DOOR = """
chan press;
broadcast chan light;

process Door() {
    clock x;

    init location Busy {
        invariant x <= 10;
        to Idle { guard x >= 1; }
    }

    location Idle {
        to Open { sync press?; assign x = 0; }
    }

    location Open {
        invariant x <= 2;
        to Rest { sync light!; }
    }

    location Rest {
    }
}

process Finger() {
    init location Waiting {
        to Waiting { sync press!; }
    }
}

system Door, Finger;

recording {
    replaces Finger;
    visible press as press();
    visible light as light();
    tolerance 1;
}
"""


@pytest.mark.parametrize(("time", "verdict"), [(6, TestVerdict.INCONCLUSIVE), (13, TestVerdict.PASS)])
def test_an_input_that_may_find_no_receiver_decides_nothing(time: int, verdict: TestVerdict) -> None:
    """Up to 10 the door may be busy, and then it does nothing when it is pressed: that is no fault."""
    door = tachk.loads(DOOR).loaded
    inputs = EventLog("inputs", (RecordedEvent(Fraction(time), "press", {}, "press"),), None, Fraction(0), Fraction(20))
    for seed in range(8):
        request = TestRequest(door, seed=seed, inputs=inputs)
        result, _ = run_test_of_model(door, "door", request, Limits(states=1_000))
        assert result.verdict is verdict, result.reason
        assert ("may not be ready for `press`" in result.reason) is (verdict is TestVerdict.INCONCLUSIVE)


SLOW = """
chan press;
broadcast chan light;

process Door() {
    clock x;

    init location Closed {
        to Closed { guard x >= 3; assign x = 0; }
        to Open { guard x > 2; sync press?; }
    }

    location Open {
        to Open { guard x >= 1; sync light!; assign x = 0; }
    }
}

process Finger() {
    clock y;

    init location Waiting {
        to Waiting { guard y >= 4; sync press!; assign y = 0; }
    }
}

system Door, Finger;

recording {
    replaces Finger;
    visible press as press();
    visible light as light();
    tolerance 2;
}
"""


def test_no_input_on_the_way_to_an_edge_is_sent_where_it_is_not_known_to_be_received() -> None:
    """The door may have just begun again, at any time."""
    door = tachk.loads(SLOW).loaded
    for seed in range(6):
        request = TestRequest(door, "60", seed, goal=TestGoal.EDGES)
        result, _ = run_test_of_model(door, "door", request, Limits(states=3_000))
        assert (result.verdict, result.inputs) == (TestVerdict.PASS, 0), result.reason


def test_a_model_without_the_input_is_no_system(tmp_path: Path) -> None:
    for name, text in (("door.ta", DOOR), ("other.ta", DOOR.replace("as press()", "as pressed()"))):
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "inputs.csv").write_text("time,event\n13,press\n", encoding="utf-8")
    files = [str(tmp_path / name) for name in ("door.ta", "other.ta", "inputs.csv")]
    outcome = CliRunner().invoke(app, ["test", files[0], "--simulate", files[1], "--inputs", files[2]])
    assert outcome.exit_code == 20 and "has no input `press`" in outcome.output
