"""Scenarios: events in their order, at their distances, and the verdicts about them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from random import Random

import pytest
from click.testing import CliRunner

import tachk
from tachk.base.span import Source
from tachk.base.words import QueryKind
from tachk.cli.main import app
from tachk.frontend.queries.scenario_observer import ObservedChannel, ScenarioEvent, scenario_observer
from tachk.model.builder import Term
from tachk.model.expressions import Reference, VariableKind
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.random_networks import Shape, random_case
from tachk.model.types import IntType
from tachk.syntax.parsing.parser import parse_document
from tachk.syntax.printing.printer import canonical, print_document
from tachk.verify.verdict import Answer
from tachk.verify.verify import verify
from tests.support.oracles.scenario_reference import channels_of, is_possible, random_run_events
from tests.support.seeds import seeds

SHAPES = (
    Shape(strict=False, deadlocks=False, clocks=2, constant=3),
    Shape(strict=False, deadlocks=False, clocks=2, constant=3, processes=2, urgent_channels=False),
    Shape(strict=False, deadlocks=False, clocks=2, constant=3, language=True, processes=2),
)


def _events(network: Network, random: Random) -> tuple[list[ScenarioEvent], list[ObservedChannel]]:
    """Events of a random run, perhaps changed, with bounds around their times."""
    channels = channels_of(network)
    integers = [v for v in network.variables if isinstance(v.type, IntType) and v.kind is VariableKind.GLOBAL]
    events = []
    for since, channel in random_run_events(network, random, 12)[: random.randint(1, 4)]:
        chosen = {random.choice(channels) if random.random() < 0.15 else channel}
        if random.random() < 0.2:
            chosen.add(random.choice(channels))
        earliest = max(0, since + random.randint(-2, 1)) if random.random() < 0.6 else 0
        latest = max(earliest, since + random.randint(-1, 2)) if random.random() < 0.6 else None
        value = Term(Reference(random.choice(integers))) == random.randint(0, 2) if integers else None
        condition = value.expression if value is not None and random.random() < 0.2 else None
        events.append(ScenarioEvent(tuple(sorted(chosen, key=channels.index)), earliest, latest, condition))
    if random.random() < 0.2:
        events.insert(random.randint(0, len(events)), ScenarioEvent((), random.randint(1, 3), None, None))
    also = [channel for channel in channels if random.random() < 0.2]
    return events or [ScenarioEvent((channels[0],), 0, None, None)], also


def _answers(numbers: Sequence[int]) -> Iterator[tuple[int, bool, Answer]]:
    for number in numbers:
        random = Random(number)
        network = random_case(random, SHAPES[number % len(SHAPES)]).network
        if not channels_of(network):
            continue
        try:
            events, also = _events(network, random)
            expected = is_possible(network, events, also, 3000)
        except EvaluationFault:
            continue
        if expected is None:
            continue
        observer, reached = scenario_observer("Scenario", events, also)
        query = Query("scenario", QueryKind.POSSIBLY, reached, observer=observer)
        (verdict,) = verify(network, [query])
        yield number, expected, verdict.answer


def test_random_scenarios_of_random_networks() -> None:
    """Beside all runs with whole delays. The judge has replayed each run that shows a scenario."""
    seen = []
    for number, expected, answer in _answers(seeds(range(60))):
        assert answer is (Answer.HOLDS if expected else Answer.FAILS), number
        seen.append(expected)
    assert {True, False} <= set(seen)


LAMP = """
time_unit = 1 ms;
chan press, pull[3];
broadcast chan lit[2];
int n = 0;
const int SOON = 4;
process Lamp() {
    clock y;
    int[0, 2] i = 1;
    init location Off { to Low { sync press?; assign y = 0; } }
    location Low {
        invariant y <= 10;
        to Off { guard y >= 5; sync lit[1]!; assign n = n + 1; }
        to Off { guard y < 3; sync pull[i]?; assign i = 2; }
    }
}
process User() {
    init location Idle {
        to Idle { sync press!; }
        to Idle { select k : int[1, 2]; sync pull[k]!; }
    }
}
system Lamp, User;
"""


@pytest.mark.parametrize(
    ("steps", "possible"),
    [
        ("press; from 5 ms to 7 ms lit[1] with n == 1; nothing 3 ms;", True),
        ("press; from 5 ms to 7 ms lit[1] with n == 2;", False),
        ("press; within SOON lit;", False),
        ("press; lit[0];", False),
        ("press; pull[1]; press; pull[2];", True),
        ("press; pull[1]; press; pull[1];", False),
        ("press; pull; press; lit;", True),
        ("press; after 2000 us pull;", True),
        ("press; after 3 pull;", False),
        ("press; press;", True),
        ("observes lit, pull; press; press;", False),
        ("observes pull[1]; press; press; pull[2]; press; lit[1];", False),
        ("observes pull[2]; press; press; press; lit[1];", False),
        ("press; nothing 11 ms;", True),
        ("observes lit, pull; press; nothing 11 ms;", False),
    ],
)
def test_what_a_scenario_says(steps: str, possible: bool) -> None:
    (verdict,) = tachk.loads(f"{LAMP} scenario story {{ {steps} }}").verify().record.verdicts
    assert verdict.answer is (Answer.HOLDS if possible else Answer.FAILS)


@pytest.mark.parametrize(
    ("steps", "code"),
    [
        ("", "E0460"),
        ("n;", "E0301"),
        ("pull[n];", "E0460"),
        ("from 5 to 2 press;", "E0461"),
        ("within 5 us press;", "E0461"),
        ("nothing 0;", "E0461"),
        ("within 5 parsecs press;", "E0453"),
        ("press with Lamp.y < 3;", "E0462"),
        ("press with Lamp.Off;", "E0462"),
        ("press with n++ == 1;", "E0313"),
        ("within press;", "E0101"),
        ("press", "E0102"),
    ],
)
def test_wrong_scenarios(steps: str, code: str) -> None:
    with pytest.raises(tachk.InputError) as caught:
        tachk.loads(f"{LAMP} scenario story {{ {steps} }}")
    assert code in {diagnostic.code for diagnostic in caught.value.diagnostics}


def test_words_of_scenarios_stay_names() -> None:
    text = "chan with, nothing, within, after, from, observes, scenario; int to;"
    text += "process P() { init location s { to s { sync with!; } to s { sync nothing?; } to s { sync with?; } } }"
    tachk.loads(text + "system P; scenario story { observes observes; within 5 with; after 2 nothing; within; from; }")


def test_the_canonical_form_keeps_scenarios() -> None:
    written = """scenario story "a title" {
    observes lit, pull[1];  // and no other
    press;
    // soon
    within 5 ms lit[0] with n == 1 && n < 3;
    after SOON lit;
    from 2 to 5 ms press;
    nothing 3 ms;
}
"""
    document, diagnostics = parse_document(Source("story.ta", written))
    assert not diagnostics
    assert print_document(canonical(document)) == written


def test_priorities_are_not_supported() -> None:
    text = "chan a, b; chan priority a < b; process P() { init location s { to s { sync a!; } to s { sync a?; } } } "
    (verdict,) = tachk.loads(text + "system P; scenario story { a; }").verify().record.verdicts
    assert verdict.answer is Answer.UNKNOWN
    assert "priorities" in verdict.reason


def test_a_run_becomes_a_scenario_that_it_shows(tmp_path: Path) -> None:
    """The counterexample of a property, appended to the model."""
    model = tmp_path / "lamp.ta"
    model.write_text(LAMP + "property low : A[] n < 2;\n", encoding="utf-8")
    report, written = tmp_path / "run.json", tmp_path / "two lights.ta"
    runner = CliRunner()
    assert runner.invoke(app, ["verify", str(model), "--format", "json", "-o", str(report)]).exit_code == 10
    found = runner.invoke(app, ["replay", str(model), str(report), "-q", "-o", str(written)])
    assert found.exit_code == 0, found.output
    text = written.read_text(encoding="utf-8")
    assert text.startswith("scenario two_lights {") and text.count("lit[1]") == 2
    model.write_text(f"{LAMP}{text}expect two_lights holds;\n", encoding="utf-8")
    assert runner.invoke(app, ["verify", str(model)]).exit_code == 0


def test_uppaal_gets_no_scenario(tmp_path: Path) -> None:
    model = tmp_path / "lamp.ta"
    model.write_text(f"{LAMP} scenario story {{ press; }}", encoding="utf-8")
    found = CliRunner().invoke(app, ["convert", str(model), "-o", str(tmp_path / "lamp.xml")])
    assert found.exit_code == 0, found.output
    assert "scenario" in found.output and "story" not in (tmp_path / "lamp.xml").read_text(encoding="utf-8")


def test_a_recording_becomes_a_scenario(tmp_path: Path) -> None:
    """Possible if it is a run of the model, and impossible if it is not."""
    recording = "recording { replaces User; visible press as pressed(); visible lit[k] as lit(k, n); tolerance 1 ms; }"
    model = tmp_path / "lamp.ta"
    model.write_text(f"{LAMP}{recording}", encoding="utf-8")
    for late, status in ((26, 0), (35, 10)):
        log, written = tmp_path / f"{late}.csv", tmp_path / f"{late}.ta"
        log.write_text(f"time [ms],event,k,n\n20,pressed,,\n{late},lit,1,1\n40,end,,\n", encoding="utf-8")
        runner = CliRunner()
        found = runner.invoke(app, ["conform", str(model), str(log), "--scenario", str(written)])
        assert found.exit_code == status, found.output
        assert "no kind" not in found.output
        text = written.read_text(encoding="utf-8")
        assert f"scenario run_{late} {{\n    observes press, lit;\n" in text and "lit[1] with n == 1;" in text
        changed = tmp_path / "with_scenario.ta"
        changed.write_text(f"{LAMP}{text}expect run_{late} {'fails' if status else 'holds'};\n", encoding="utf-8")
        assert runner.invoke(app, ["verify", str(changed)]).exit_code == 0
