"""The events of runs: the search for runs that go along with recordings accepts them."""

from __future__ import annotations

from random import Random

import pytest

import tachk
from tachk.engine.options import Limits
from tachk.meaning.run_view import RunNames
from tachk.model.run import TimedTrace
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.events import EventLog
from tachk.simulation.testing.run_events import recording_of_run
from tachk.verify.covering.coverage import Coverage
from tachk.verify.covering.suite import covering_suite
from tests.support.seeds import seeds
from tests.unit.recordings.conformance.small_models import random_machine, text_of

LAMP = """
const int DIM = 3;
broadcast chan press;
chan light[2];
meta int level = 0;
process Hand() { init location H { to H { sync press!; } } }
process Lamp() {
    clock x;
    init location Off { to Waking { sync press?; assign x = 0; } }
    location Waking { invariant x <= 2; to On { guard x >= 2; sync light[1]!; assign level = DIM; } }
    location On { to Off { sync light[0]!; } }
}
process Eye() { init location E { to E { select on : int[0, 1]; sync light[on]?; } } }
system Hand, Lamp, Eye;
recording {
    replaces Hand, Eye;
    visible press as press();
    visible light[on] as light(on, level, where = Lamp, lit = Lamp.On);
}
"""


def accepted(model: tachk.Model, run: TimedTrace) -> EventLog:
    mapping = model.loaded.recording
    assert mapping is not None
    log = recording_of_run(model.network, mapping, constants_of(model.loaded), run, "run", Limits())
    assert log is not None
    return log


def test_columns_are_read_at_the_end_of_the_step() -> None:
    model = tachk.loads(LAMP)
    (only,) = covering_suite(model.network, Coverage.EDGES).runs
    log = accepted(model, only.run)
    lights = [(event.time, dict(event.cells)) for event in log.events if event.name == "light"]
    assert [cells for _, cells in lights] == [
        {"on": 1, "level": 3, "where": "On", "lit": 1},
        {"on": 0, "level": 0, "where": "Off", "lit": 0},
    ]
    assert lights[0][0] >= 2
    assert log.end == only.run.states[-1].time


@pytest.mark.parametrize("seed", seeds(range(12)))
def test_events_of_random_models(seed: int) -> None:
    random = Random(seed)
    model = tachk.loads(text_of(tuple(random_machine(random) for _ in range(2)), hidden=False))
    names = RunNames(model.network)
    for each in covering_suite(model.network, Coverage.EDGES).runs:
        log = accepted(model, each.run)
        states = each.run.states
        shown = [
            (step.state.time, names.event(before.discrete, step.transition).channel)
            for before, step in zip(states, each.run.steps, strict=False)
            if step.transition is not None
        ]
        expected = [time for time, channel in shown if channel]
        assert [event.time for event in log.events] == expected
