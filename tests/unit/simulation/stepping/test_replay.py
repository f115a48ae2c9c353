"""Runs in files, executed on models."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError, UsageError
from tachk.base.diagnostics.explanation import explanations
from tachk.base.span import Source
from tachk.cli.main import app
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationOptions
from tachk.meaning.run_view import RunNames
from tachk.model.network import Network
from tachk.model.run import TimedTrace
from tachk.report.json_report import runs_to_json
from tachk.simulation.columns import all_columns
from tachk.simulation.runs import Runs, steps_of
from tachk.simulation.stepping.files import constants_of, read_report, read_submitted
from tachk.simulation.stepping.replaying import Replayed, replay_submitted
from tachk.simulation.stepping.run_file import read_run_file, run_text, steps_text
from tachk.simulation.stepping.signals import signals_of
from tachk.syntax.source_files import LARGEST_FILE, LARGEST_RUN
from tests.support import Shape, random_case

FISCHER = Path("models/classics/fischer.ta")

DOOR = """
clock x;
chan ring;
int[0, 9] rung = 0;
process Visitor() {
    init location Out {
        to Ringing { guard x >= 2 && rung < 3; sync ring!; assign x = 0, rung = rung + 1; }
        to Out { guard x >= 7; assign x = 0; }
        to Out { guard x >= 8; assign rung = 5; }
    }
    location Ringing { invariant x <= 4; to Out { guard x > 1; assign x = 0; } }
}
process Bell() {
    init location Quiet { to Loud { select tone : int[1, 2]; sync ring?; assign rung = rung + tone - 1; } }
    urgent location Loud { to Quiet; }
}
system Visitor, Bell;
"""


def _replayed(text: str, lines: str) -> Replayed:
    return replay_submitted(RunNames(tachk.loads(text).network), read_run_file(Source("a.run", lines)))


def _refused(lines: str) -> tuple[int, str, list[str]]:
    """The step that cannot be taken, why, and the places that are shown."""
    refusal = _replayed(DOOR, lines).refusal
    assert refusal is not None
    return refusal.step, refusal.reason.message, [f"{label.span.text}: {label.text}" for label in refusal.reason.labels]


def test_a_run_by_hand() -> None:
    lines = """
        # comment
        2.5 ring! Visitor: Out -> Ringing & Bell: Quiet -> Loud [tone = 2]
        +0 Bell: Loud → Quiet
        17/4 Visitor: Ringing -> Out
        +10 Visitor: Out -> Out #2
        20
    """
    replayed = _replayed(DOOR, lines)
    assert replayed.refusal is None
    times = [step.state.time for step in replayed.trace.steps]
    assert times == [Fraction(5, 2), Fraction(5, 2), Fraction(17, 4), Fraction(57, 4), 20]
    assert replayed.trace.steps[-1].transition is None
    assert replayed.trace.states[-1].discrete.values[-1] == 5 or 5 in replayed.trace.states[-1].discrete.values


@pytest.mark.parametrize(
    ("lines", "step", "message", "labels"),
    [
        (
            "1.5 Visitor: Out -> Ringing & Bell: Quiet -> Loud",
            1,
            "a guard of Visitor is false",
            ["x >= 2: Visitor, guard: false with x = 1.5"],
        ),
        ("9 Visitor: Ringing -> Out", 1, "Visitor is in Out, not in Ringing", None),
        ("9 Visitor: Out -> Door", 1, "Visitor has no location Door", None),
        ("9 Bell: Quiet -> Quiet", 1, "Bell has no edge from Quiet to Quiet", None),
        ("9 Visitor: Out -> Out #3", 1, "Visitor has no edge number 3 from Out to Out", None),
        ("9 Postman: A -> B", 1, "there is no process Postman; there are Visitor, Bell", []),
        ("9 Visitor: Out -> Out & Bell: Quiet -> Loud", 1, "Bell cannot take part", []),
        ("9 Visitor: Out -> Ringing", 1, "Bell takes part too", []),
        (
            "9 bell! Visitor: Out -> Ringing & Bell: Quiet -> Loud",
            1,
            "they synchronise over ring, not over bell",
            [],
        ),
        (
            "9 Visitor: Out -> Ringing & Bell: Quiet -> Loud\n10 Bell: Loud -> Quiet",
            2,
            "time cannot pass",
            None,
        ),
        (
            "9 Visitor: Out -> Ringing & Bell: Quiet -> Loud\n9 Bell: Loud -> Quiet\n14 Visitor: Ringing -> Out",
            3,
            "an invariant would be violated after a delay of 5",
            ["x <= 4: Visitor, invariant of Ringing: false with x = 5"],
        ),
        ("9 Visitor: Out -> Out #1\n3", 2, "it would be at 3, and the run is at 9", []),
    ],
)
def test_why_a_step_cannot_be_taken(lines: str, step: int, message: str, labels: list[str] | None) -> None:
    found = _refused(lines)
    assert found[:2] == (step, message)
    if labels is not None:
        assert found[2] == labels


def test_an_ambiguous_step_is_chosen_so_that_the_rest_fits() -> None:
    # Both edges from Out to Out are possible, only the second one forbids to ring.
    lines = "9 Visitor: Out -> Out\n+0 Visitor: Out -> Out #2\n+3 Visitor: Out -> Ringing & Bell: Quiet -> Loud"
    assert _refused(lines)[0] == 3
    lines = "9 Visitor: Out -> Out\n+3 Visitor: Out -> Ringing & Bell: Quiet -> Loud [tone = 1]"
    assert _replayed(DOOR, lines).refusal is None


@pytest.mark.parametrize("line", ["P: A -> B", "1 P A -> B", "1 P: A", "1 c!", "1 P: A -> B [i]", "1/0 P: A -> B"])
def test_lines_that_are_not_understood_are_named(line: str) -> None:
    with pytest.raises(InputError) as caught:
        read_run_file(Source("a.run", f"1 P: A -> B\n{line}\n"))
    (found,) = caught.value.diagnostics
    assert found.code == "E0922"
    assert str(found.span).startswith("a.run:2:1")


def test_the_examples_of_the_explanations() -> None:
    step, line = explanations("runs").values()
    model = "clock x; process P() { init location A { to B { guard x > 10; } } location B; } system P;"
    assert _replayed(model, step.bad).refusal is not None
    assert _replayed(model, step.good).refusal is None
    with pytest.raises(InputError, match="E0922"):
        read_run_file(Source("a.run", line.bad))
    assert len(read_run_file(Source("a.run", line.good)).steps) == 1


def _networks(count: int, seed: int) -> list[Network]:
    shapes = (Shape(), Shape(clocks=2), Shape(stopwatches=True), Shape(language=True, clocks=2, constant=3, copies=0.3))
    return [random_case(Random(seed + n), shapes[n % len(shapes)]).network for n in range(count)]


def test_runs_that_are_written_are_replayed() -> None:
    steps = 0
    for number, network in enumerate(_networks(28, seed=8100)):
        try:
            runs = Runs(network, all_columns(network))
        except (UnsupportedError, InputError):
            continue
        names = RunNames(network)
        drawing = SimulationOptions(number, 20 * TICKS_PER_UNIT, Policy.UNIFORM, steps=15)
        for run in runs.draw(drawing, range(2), RecordedChanges(actions=True, observed=True)):
            if not len(run.times):
                continue
            text = steps_text(names, steps_of(run))
            replayed = replay_submitted(names, read_run_file(Source("a.run", text)))
            assert replayed.refusal is None
            assert [step.transition for step in replayed.trace.steps if step.transition] == list(run.actions)
            assert run_text(names, replayed.trace) == text
            steps += run.transitions
            # The signals that the semantics computes are those that the core has recorded.
            recorded = signals_of(names, runs.columns, replayed.trace, "a", Fraction(run.end, TICKS_PER_UNIT)).trace
            expected = runs.trace(run)
            assert recorded.times.tolist() == expected.times.tolist()
            assert {k: v.tolist() for k, v in recorded.columns.items()} == {
                k: v.tolist() for k, v in expected.columns.items()
            }
    assert steps > 140


def _counterexample(wait: int = 9) -> tuple[dict[str, object], Network, TimedTrace]:
    model = tachk.load(FISCHER, N=2, WAIT=wait)
    report = model.verify(property="mutual_exclusion", options=tachk.Options().off("symmetry"))
    document = json.loads(json.dumps(runs_to_json([report.record])))
    trace = report["mutual_exclusion"].trace
    assert trace is not None
    return document, model.network, trace


def test_a_counterexample_is_replayed() -> None:
    document, network, trace = _counterexample()
    replayed = replay_submitted(RunNames(network), read_report(document, "t.json"))
    assert replayed.refusal is None
    assert replayed.trace.steps == trace.steps


def test_the_report_says_which_constants_count(tmp_path: Path) -> None:
    document, _, _ = _counterexample()
    path = tmp_path / "t.json"
    path.write_text(json.dumps(document))
    submitted = read_submitted(path)
    model = tachk.load(FISCHER)
    assert constants_of(submitted, model.constants, {}) == {"N": 2, "WAIT": 9}
    assert constants_of(submitted, model.constants, {"WAIT": "10"}) == {"N": 2}
    with pytest.raises(UsageError):
        constants_of(submitted, {"N": 2}, {})


def test_with_another_constant_the_counterexample_is_none() -> None:
    document, _, _ = _counterexample()
    refusal = replay_submitted(RunNames(tachk.load(FISCHER, N=2).network), read_report(document, "t.json")).refusal
    assert refusal is not None
    assert refusal.step == 4
    assert [label.text for label in refusal.reason.labels] == ["P(1), guard: false with x = 28/3"]


def test_what_a_report_says_of_states_counts() -> None:
    document, network, _ = _counterexample()
    submitted = read_report(document, "t.json")
    third = submitted.steps[2]
    assert third.after is not None
    for wrong, message in (
        (replace(third.after, variables={"id": 2}), "id is 1, not 2 as the file says"),
        (replace(third.after, clocks={"P(1).x": Fraction(1)}), "P(1).x is 0, not 1 as the file says"),
        (replace(third.after, locations={"P(2)": "idle"}), "P(2) is request, not idle as the file says"),
        (replace(third.after, variables={"ID": 2}), "the model has no ID, which the file names"),
    ):
        steps = (*submitted.steps[:2], replace(third, after=wrong), *submitted.steps[3:])
        refusal = replay_submitted(RunNames(network), replace(submitted, steps=steps)).refusal
        assert refusal is not None
        assert (refusal.step, refusal.reason.message) == (3, message)


def test_hidden_processes_may_be_left_out() -> None:
    text = DOOR.replace("system Visitor, Bell;", "hide Bell; system Visitor, Bell;")
    model = tachk.loads(text)
    report = model.verify("E<> rung == 4 && Bell.Quiet")
    document = json.loads(json.dumps(runs_to_json([report.record])))
    told = json.dumps(document)
    assert "Bell: " not in told
    replayed = replay_submitted(RunNames(model.network), read_report(document, "t.json"))
    assert replayed.refusal is None
    assert 4 in replayed.trace.states[-1].discrete.values


def test_other_files_are_rejected(tmp_path: Path) -> None:
    for name, text in (
        ("a.xtr", "0 0 0\n.\n"),
        ("a.json", '{"runs": []}'),
        ("b.json", '{"runs": [{}]}'),
        ("c.json", "{"),
    ):
        path = tmp_path / name
        path.write_text(text)
        with pytest.raises(UsageError):
            read_submitted(path)


def test_times_that_are_no_decimals_stay_exact_for_monitors() -> None:
    _, network, trace = _counterexample()
    columns = all_columns(network)
    exact = signals_of(RunNames(network), columns, trace, "a")
    assert exact.exact
    assert Fraction(exact.trace.end, exact.trace.ticks_per_unit) == Fraction(56, 3)
    rounded = signals_of(RunNames(network), columns, trace, "a", decimal_times=True)
    assert not rounded.exact
    assert rounded.trace.end == 18_666_666_666


@pytest.mark.parametrize(
    ("invariant", "place", "message"),
    [
        ("x >= 1", "a", "does not hold in the initial state"),
        ("x <= 5 / d", "5 / d", "no initial state: 5 divided by 0"),
    ],
)
def test_a_model_without_an_initial_state(invariant: str, place: str, message: str, tmp_path: Path) -> None:
    places = f"init location a {{ invariant {invariant}; to b; }} location b;"
    text = f"int[0, 1] d; clock x; process P() {{ {places} }} system P;"
    with pytest.raises(InputError, match=message) as caught:
        _replayed(text, "0 P: a -> b")
    assert [(each.code, each.span.text) for each in caught.value.diagnostics] == [("E0409", place)]
    (tmp_path / "a.ta").write_text(text)
    (tmp_path / "a.run").write_text("0 P: a -> b")
    model, run = str(tmp_path / "a.ta"), str(tmp_path / "a.run")
    for command in (["replay", model, run], ["simulate", model, "--policy", "script", run], ["step", model]):
        assert app.main(command, standalone_mode=False) == 2


def test_a_run_may_be_larger_than_a_model(tmp_path: Path) -> None:
    path = tmp_path / "a.run"
    path.write_text("# " + "a" * LARGEST_FILE + "\n0 P: a -> b\n")
    assert len(read_submitted(path).steps) == 1
    with path.open("r+b") as file:
        file.truncate(LARGEST_RUN + 1)
    with pytest.raises(UsageError, match="too large for a run"):
        read_submitted(path)
