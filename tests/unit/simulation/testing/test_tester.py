"""Systems that are as their model says pass, whatever stands for them; others fail where it shows."""

from __future__ import annotations

import re
import sys
import threading
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.engine.options import Limits
from tachk.engine.simulation.policy import Policy
from tachk.model.recording import RecordingMap
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.event_tables import event_rows
from tachk.recordings.conformance.events import RecordedEvent
from tachk.simulation.testing import program_system
from tachk.simulation.testing.goals import TestGoal
from tachk.simulation.testing.input_choice import ScriptedInputs
from tachk.simulation.testing.modelled_system import ModelledSystem
from tachk.simulation.testing.program_system import RealTimeProgram
from tachk.simulation.testing.tested_model import TestRequest, run_test_of_model
from tachk.simulation.testing.tester import TestedModel, TestResult, TestSettings, TestVerdict, confirmed, follow
from tests.support.seeds import seeds
from tests.unit.recordings.conformance.small_models import random_machine, text_of
from tests.unit.simulation.testing.test_followed_system import with_anyone

LAMP = """time_unit = 1 ms;
chan press;
broadcast chan light;
process Lamp() {
    clock x;
    init location Off { to Waking { sync press?; assign x = 0; } }
    location Waking { invariant x <= 5; to Off { guard x >= 3; sync light!; } }
}
process Finger() {
    clock pause;
    init location Idle { to Idle { guard pause >= 2; sync press!; assign pause = 0; } }
}
system Lamp, Finger;
recording {
    replaces Finger;
    visible press as press();
    visible light as light();
    tolerance 0;
}
"""
DRIVEN = Path(__file__).with_name("driven_lamp.py")


def outcome_of(adapter: str | tachk.Model, text: str = LAMP, seed: int = 0, **more: Any) -> TestResult:
    system = adapter if isinstance(adapter, str) else adapter.loaded
    request = TestRequest(system, "200ms", seed, **more)
    return run_test_of_model(tachk.loads(text).loaded, "model", request, Limits(states=10_000))[0]


def program(*words: object) -> str:
    return " ".join([sys.executable, *map(str, words)])


@pytest.mark.parametrize("delay", [3, 4.25, 5])
def test_driven_program_passes(delay: float) -> None:
    result = outcome_of(f"driven:{program(DRIVEN, delay)}", LAMP)
    assert result.verdict is TestVerdict.PASS
    assert result.inputs > 10 and len(result.recording.events) - result.inputs > 10


@pytest.mark.parametrize("delay", [0.5, 7.5, 1000])
def test_driven_program_fails_by_time_alone(delay: float) -> None:
    result = outcome_of(f"driven:{program(DRIVEN, delay)}", LAMP)
    assert result.verdict is TestVerdict.FAIL
    refusal = result.conformance and result.conformance.refusal
    assert refusal is not None
    if delay < 3:
        assert refusal.event is not None and result.recording.events[refusal.event].name == "light"
    else:
        assert refusal.event is None, "it is silent for too long, which is seen before it answers"


def test_handshakes_are_sent_where_they_are_received() -> None:
    """A lamp that wakes up is not pressed: in the driven program that would have no consequence, in the model it cannot
    be."""
    result = outcome_of(f"driven:{program(DRIVEN, 5)}", LAMP)
    waking = False
    for event in result.recording.events:
        assert event.name == "light" or not waking
        waking = event.name == "press"


def test_programs_that_are_no_systems() -> None:
    with pytest.raises(UsageError, match="cannot be started"):
        outcome_of("process:/there/is/no/such/program")
    with pytest.raises(UsageError, match="did not write"):
        outcome_of(f"process:{program('-c', 'pass')}")
    with pytest.raises(UsageError, match="names no system"):
        outcome_of("proces:./x")
    with pytest.raises(UsageError, match="is not JSON"):
        outcome_of(f"process:{program('-c', 'print(1+)')}".replace("print(1+)", "print(chr(97))"))


def test_program_that_ends_is_inconclusive() -> None:
    line = 'print(chr(123)+chr(34)+"event"+chr(34)+":"+chr(34)+"ready"+chr(34)+chr(125),flush=True)'
    result = outcome_of(f"process:{sys.executable} -c '{line}'")
    assert result.verdict is TestVerdict.INCONCLUSIVE
    assert "has ended with status 0" in result.reason


def test_changed_model_fails() -> None:
    assert outcome_of(tachk.loads(LAMP)).verdict is TestVerdict.PASS
    late = tachk.loads(LAMP.replace("invariant x <= 5", "invariant x <= 9"))
    early = tachk.loads(LAMP.replace("guard x >= 3", "guard x >= 0"))
    for changed in (late, early):
        assert TestVerdict.FAIL in {outcome_of(changed, seed=seed).verdict for seed in range(4)}


def test_same_seed_same_test() -> None:
    first, second = (outcome_of(tachk.loads(LAMP), seed=7) for _ in range(2))
    assert first.recording == second.recording
    assert first.recording != outcome_of(tachk.loads(LAMP), seed=8).recording


def test_recording_is_read_back(tmp_path: Path) -> None:
    result = outcome_of(f"driven:{program(DRIVEN, 7.5)}", LAMP)
    file, model = tmp_path / "test.jsonl", tmp_path / "lamp.ta"
    model.write_text(LAMP, encoding="utf-8")
    file.write_text("".join(event_rows(result.recording, Fraction(10**6))), encoding="utf-8")
    found = tachk.conform(model, file)
    assert found.accepted is False
    assert found.refusal is not None


@pytest.mark.drawn
@pytest.mark.parametrize("seed", seeds(range(6)))
def test_models_pass_their_own_tests(seed: int) -> None:
    random = Random(seed)
    machines = tuple(random_machine(random) for _ in range(random.randint(1, 2)))
    while not any(edge.label == "out" for machine in machines for edge in machine.edges):
        machines = tuple(random_machine(random) for _ in range(random.randint(1, 2)))
    model = tachk.loads(with_anyone(text_of(machines, hidden=False), len(machines)))
    mapping, constants = model.loaded.recording, constants_of(model.loaded)
    assert mapping is not None
    prepared = TestedModel.of(model.network, mapping, constants)
    for case in range(4):
        exact = TimestampUncertainty(*(Fraction(random.randrange(3)) for _ in range(3)))
        policy = random.choice((Policy.STOCHASTIC, Policy.UNIFORM, Policy.BOUNDARY))
        system = ModelledSystem(model.network, mapping, constants, case, policy)
        goal = random.choice(list(TestGoal))
        settings = TestSettings(Fraction(15), case, exact, limits=Limits(states=5_000), goal=goal)
        result = confirmed(prepared, follow(prepared, system, settings, prepared.inputs(settings)))
        assert result.verdict is not TestVerdict.FAIL, f"seed {seed}, case {case}"


def test_a_run_time_error_ends_the_model_that_stands_for_the_system() -> None:
    counting = LAMP.replace("clock x;", "clock x; int[0, 2] n = 0;").replace(
        "assign x = 0;", "assign x = 0, n = n + 1;"
    )
    result = outcome_of(tachk.loads(counting), LAMP)
    assert result.verdict is TestVerdict.INCONCLUSIVE and "run-time error" in result.reason


def test_failures_are_shortened() -> None:
    """A lamp that answers too late does so from the first press on; one press is enough to show it."""
    request = TestRequest(f"driven:{program(DRIVEN, 7.5)}", "200ms", seed=3, shorten=30)
    result, shortening = run_test_of_model(tachk.loads(LAMP).loaded, "model", request, Limits(states=10_000))
    assert shortening is not None and shortening.is_repeated and shortening.is_minimal
    assert result.verdict is TestVerdict.FAIL and result.inputs == 1


def test_a_fault_that_needs_three_inputs_keeps_them() -> None:
    """The lamp counts presses, and is slow from the third one on."""
    counting = LAMP.replace("clock x;", "clock x; int[0, 3] n = 0;").replace(
        "sync press?; assign x = 0;", "sync press?; assign x = 0, n = n < 3 ? n + 1 : 3;"
    )
    slow = counting.replace("guard x >= 3", "guard x >= (n == 3 ? 8 : 3)").replace("x <= 5", "x <= (n == 3 ? 9 : 5)")
    request = TestRequest(tachk.loads(slow).loaded, "200ms", 1, shorten=30)
    result, shortening = run_test_of_model(tachk.loads(LAMP).loaded, "model", request, Limits(states=10_000))
    assert shortening is not None and shortening.is_repeated and shortening.is_minimal
    assert (result.verdict, result.inputs) == (TestVerdict.FAIL, 3)


LOCK = """time_unit = 1 ms;
broadcast chan key[4];
broadcast chan opens;
process Lock() {
    clock x;
    init location L0 { to L1 { sync key[2]?; assign x = 0; } }
    location L1 { to L2 { guard x >= 40 && x <= 42; sync key[0]?; assign x = 0; } to L0 { sync key[1]?; } }
    location L2 { to L3 { guard x >= 90 && x <= 91; sync key[3]?; assign x = 0; } to L0 { sync key[1]?; } }
    location L3 { invariant x <= 5; to L0 { sync opens!; } }
}
process Thief() { init location There { to There { select n : int[0, 3]; sync key[n]!; } } }
system Lock, Thief;
recording {
    replaces Thief;
    visible key[n] as key(n);
    visible opens as opens();
    tolerance 0;
}
"""


def test_guided_inputs_open_a_lock_that_random_ones_do_not() -> None:
    opened = dict.fromkeys(TestGoal, 0)
    for goal in TestGoal:
        for seed in range(6):
            request = TestRequest(tachk.loads(LOCK).loaded, "5s", seed, goal=goal)
            result, _ = run_test_of_model(tachk.loads(LOCK).loaded, "model", request, Limits(states=10_000))
            assert result.verdict is TestVerdict.PASS and result.edges == 6
            opened[goal] += any(event.name == "opens" for event in result.recording.events)
            if goal is TestGoal.EDGES:
                assert result.covered == 6
    assert opened == {TestGoal.RANDOM: 0, TestGoal.EDGES: 6}


IN_TURN = """time_unit = 1 ms;
broadcast chan ask, order;
broadcast chan answer, deliver;
process Server() {
    init location Idle {
        to Asked { sync ask?; }
        to Ordered { sync order?; }
    }
    urgent location Asked { to Idle { sync answer!; } }
    urgent location Ordered { to Idle { sync deliver!; } }
}
process Client() {
    init location Idle {
        to Waiting { sync ask!; }
        to Hoping { sync order!; }
    }
    location Waiting { to Idle { sync answer?; } }
    location Hoping { to Idle { sync deliver?; } }
}
system Server, Client;
recording {
    replaces Client;
    visible ask as ask();
    visible order as order();
    visible answer as answer();
    visible deliver as deliver();
    tolerance 0;
    late 40;
}
"""


def test_next_input_follows_what_was_sent_and_seen() -> None:
    """Inputs of two streams may overtake each other on their way. The environment that chose one has sent the other."""
    model = tachk.loads(IN_TURN)
    for seed in seeds(range(8)):
        result = outcome_of(model, IN_TURN, seed)
        assert result.verdict is TestVerdict.PASS, seed
        names = [event.name for event in result.recording.events]
        assert all(name in {"ask", "order"} for name in names[::2])


def test_failure_of_a_system_that_had_to_wait_is_inconclusive(monkeypatch: pytest.MonkeyPatch) -> None:
    """A busy machine is no fault of the system. What waits for no longer than it may be late fails."""
    late = tachk.loads(LAMP.replace("invariant x <= 5", "invariant x <= 90"))
    waits = iter(range(0, 10_000, 50))
    monkeypatch.setattr(ModelledSystem, "waited", lambda system: Fraction(next(waits)))
    result = outcome_of(late, late="2ms")
    assert result.verdict is TestVerdict.INCONCLUSIVE
    assert re.search(r"had to wait for a processor for \d+ ms, longer", result.reason), result.reason
    monkeypatch.setattr(ModelledSystem, "waited", lambda system: Fraction(10_000))
    assert outcome_of(late, late="2ms").verdict is TestVerdict.FAIL


def test_confirmation_makes_no_run_with_times(monkeypatch: pytest.MonkeyPatch) -> None:
    """A broadcast that nobody may receive leaves only the reference to make them, in minutes for a long test."""
    monkeypatch.setattr("tachk.recordings.conformance.conform.moments_of_run", None)
    assert outcome_of(tachk.loads(LAMP)).verdict is TestVerdict.PASS


@pytest.mark.skipif(not Path("/proc/self/schedstat").exists(), reason="only Linux counts it")
def test_time_for_which_a_program_waits_is_counted() -> None:
    system = RealTimeProgram([sys.executable, str(DRIVEN), "1"], Fraction(1))
    system.start()
    first = system.waited()
    assert 0 < first <= system.waited()
    system.close()
    assert system.waited() >= first, "it has ended"


def test_time_for_which_the_test_itself_waits_is_counted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: set[str] = set()
    monkeypatch.setattr(program_system, "_waited", lambda task: asked.add(task) or 0)
    system = RealTimeProgram([sys.executable, str(DRIVEN), "1"], Fraction(1))
    system.start()
    system.waited()
    system.close()
    assert f"/proc/self/task/{threading.get_native_id()}" in asked


@pytest.mark.parametrize("faulty", [False, True])
def test_an_input_that_the_model_does_not_allow_is_no_failure(faulty: bool) -> None:
    """From 4 on the invariant of L1 forbids the input: one at 4 is no fault of the system, what it did before is."""

    def model(guard: str) -> tachk.Model:
        return tachk.loads(f"""
broadcast chan hear, say;
int n = 0;
process P() {{
    clock x;
    init location L0 {{ to L1 {{ guard x >= 4; sync hear?; }} }}
    location L1 {{ invariant x <= 3; }}
}}
process Q() {{
    clock y;
    init location L0 {{ invariant n == 1 || y <= 3; to L0 {{ guard n == 0 && {guard}; sync say!; assign n = 1; }} }}
}}
process Anyone() {{ init location L0 {{ to L0 {{ sync hear!; }} }} }}
system P, Q, Anyone;
recording {{ replaces Anyone; visible hear as in(); visible say as out(); }}
""")

    own, other = model("y >= 2"), model("y <= 1" if faulty else "y >= 2")
    tested = TestedModel.of(own.network, _recording(own), constants_of(own.loaded))
    running = ModelledSystem(
        # without the edge of P, the system takes the input
        replace(other.network, processes=(replace(other.network.processes[0], edges=()), *other.network.processes[1:])),
        _recording(other),
        constants_of(other.loaded),
        1,
        Policy.UNIFORM,
    )
    settings = TestSettings(Fraction(8), 1, TimestampUncertainty.of(Fraction(0), Fraction(0)))
    inputs = ScriptedInputs([RecordedEvent(Fraction(4), "in", {}, "an input")], settings.uncertainty)
    result = confirmed(tested, follow(tested, running, settings, inputs))
    assert result.verdict is (TestVerdict.FAIL if faulty else TestVerdict.INCONCLUSIVE)


def _recording(model: tachk.Model) -> RecordingMap:
    assert model.loaded.recording is not None
    return model.loaded.recording
