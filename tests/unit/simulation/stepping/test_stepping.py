"""`tachk step`: what can happen and when, and what is answered to typed lines."""

from __future__ import annotations

import os
import pty
import re
import select
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest

import tachk
from tachk.cli.main import app
from tachk.cli.stepper import NotUnderstoodError, QuitError, Stepper
from tachk.meaning.run_view import RunNames
from tachk.meaning.step import StepError, delay, initial_state, successors
from tachk.model.network import Network
from tachk.simulation.stepping.enabled import DelayWindow, enabled_steps
from tachk.simulation.stepping.session import NotPossibleError, Session
from tests.support import Shape, random_case
from tests.support.seeds import enough, seeds

PAGE = Path("docs/stepping.md").read_text(encoding="utf-8")
LAMP = re.search(r"```ta lamp.ta\n(.*?)```", PAGE, re.DOTALL)[1]  # type: ignore[index]


def _network(seed: int) -> Network:
    shapes = (
        Shape(),
        Shape(clocks=2),
        Shape(diagonals=True, clocks=2),
        Shape(stopwatches=True),
        Shape(language=True),
        Shape(copies=0.5),
    )
    return random_case(Random(seed), shapes[seed % len(shapes)]).network


def test_windows_say_when_transitions_are_enabled() -> None:
    """Compared with asking the semantics after many delays, behind some random steps."""
    asked = 0
    for seed in seeds(range(9000, 9030)):
        network = _network(seed)
        names, random = RunNames(network), Random(seed)
        try:
            session = Session.begin(names)
            for _ in range(random.randrange(4)):
                session = session.random(random)
        except (StepError, NotPossibleError):
            continue
        enabled = enabled_steps(names, session.state)
        told = {choice.transition: choice.windows for choice in enabled.transitions}
        assert not enabled.faults
        for tenths in (0, 1, 5, 10, 11, 15, 20, 25, 30, 40, 55, 70, 111):
            waited = Fraction(tenths, 10)
            try:
                later = delay(names.model, session.state, waited)
            except StepError:
                assert waited not in enabled.delays
                continue
            assert waited in enabled.delays
            possible = {transition for transition, _ in successors(names.model, later)}
            assert possible == {t for t, windows in told.items() if any(waited in window for window in windows)}
            asked += len(possible)
    assert enough(asked > 100)


def test_windows_are_reported_as_intervals() -> None:
    three, five = Fraction(3), Fraction(5)
    assert [str(window) for window in (DelayWindow(three, five), DelayWindow(three, five, False, False))] == [
        "[3, 5]",
        "(3, 5)",
    ]
    assert [str(window) for window in (DelayWindow(three, three), DelayWindow(three, None))] == ["3", "[3, ∞)"]
    assert DelayWindow(three, five, first_belongs=False).some == 4
    assert DelayWindow(three, three + Fraction(1, 2), first_belongs=False).some == Fraction(13, 4)


def test_priorities_count() -> None:
    text = """
        process P() { clock x; init location A { to B { guard x >= 2 && x <= 4; } } location B; }
        process Q() { init location A { to A; } }
        system Q < P;
    """
    names = RunNames(tachk.loads(text).network)
    windows = {
        o.transition.participants[0].process: [*map(str, o.windows)]
        for o in enabled_steps(names, initial_state(names.model)).transitions
    }
    assert windows == {0: ["[0, 2)", "(4, ∞)"], 1: ["[2, 4]"]} or windows == {1: ["[0, 2)", "(4, ∞)"], 0: ["[2, 4]"]}


@pytest.fixture
def lamp() -> Stepper:
    network = tachk.loads(LAMP).network
    return Stepper(Session.begin(RunNames(network)), "lamp.ta", {})


def _said(stepper: Stepper, *lines: str) -> list[str]:
    return [answer for line in lines for answer in stepper.answer(line)]


def test_the_session_of_the_page(lamp: Stepper) -> None:
    shown = re.search(r"\$ tachk step lamp.ta\n(.*?)```", PAGE, re.DOTALL)
    assert shown is not None
    said = [*lamp.greeting(), "type `help` for the commands"]
    for line in ("1", "2 @ 4.5"):
        said += [f"> {line}", *lamp.answer(line)]
    told = shown[1].removesuffix("...\n").splitlines()
    assert said[: len(told)] == told


def test_undo_and_redo(lamp: Stepper) -> None:
    _said(lamp, "1", "d 3", "2 @ 1")
    assert lamp.session.state.time == 4
    _said(lamp, "u 2")
    assert (lamp.session.position, lamp.session.state.time) == (1, 0)
    _said(lamp, "redo")
    assert lamp.session.state.time == 3
    # The same step again keeps what comes after it, another one does not.
    _said(lamp, "undo", "delay 3")
    assert len(lamp.session.steps) == 3
    _said(lamp, "undo", "delay 2")
    assert len(lamp.session.steps) == 2
    _said(lamp, "goto 0")
    assert lamp.session.state.time == 0
    assert _said(lamp, "restart")[0] == "after step 0 of 2, time 0"


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (["7"], "there is no transition 7; the list has 1 to 1"),
        (["1", "2 @ 6"], r"this is possible after a delay in \[0, 5\)"),
        (
            ["1", "delay 61"],
            "invariant would be violated after a delay of 61\n.*of Low: false with x = 61",
        ),
        (["delay x"], "x is not a number of time units"),
        (["undo"], "no step has been taken yet"),
        (["1", "goto 2"], "there are the steps 0 to 1"),
        (["dance"], "there is no command 'dance'"),
        (["re"], "'re' may be redo or restart"),
        (["show nothing"], "no process, variable or clock begins with nothing"),
        (["load nowhere.run"], "nowhere.run"),
    ],
)
def test_what_cannot_be_obeyed_changes_nothing(lamp: Stepper, lines: list[str], message: str) -> None:
    _said(lamp, *lines[:-1])
    before = lamp.session
    with pytest.raises(NotUnderstoodError, match=message):
        _said(lamp, lines[-1])
    assert lamp.session == before


def test_values_are_shown(lamp: Stepper) -> None:
    said = _said(lamp, "1", "d 1.5", "show")
    assert {"  Lamp     Low", "  presses  1", "  x        1.5"} <= set(said)
    assert _said(lamp, "show x") == ["  x  1.5"]
    with pytest.raises(QuitError):
        _said(lamp, "q")


def test_a_run_is_saved_and_loaded(lamp: Stepper, tmp_path: Path) -> None:
    file = tmp_path / "a.run"
    _said(lamp, "random 6", f"save {file}")
    run = lamp.session.trace
    _said(lamp, "restart", "1", f"load {file}")
    assert lamp.session.trace == run
    assert len(_said(lamp, "history")) == 7


# ---- the command ----------------------------------------------------------------------------------------------------


def _step(folder: Path, typed: str, *more: str) -> tuple[str, str, int]:
    (folder / "lamp.ta").write_text(LAMP)
    command = [sys.executable, "-m", "tachk", "step", "lamp.ta", *more]
    environment = {**os.environ, "PYTHONPATH": str(Path("src").resolve())}
    done = subprocess.run(
        command, cwd=folder, input=typed, capture_output=True, text=True, env=environment, check=False
    )
    return done.stdout, done.stderr, done.returncode


def test_commands_from_a_pipe(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out, err, status = _step(tmp_path, "1\n2 @ 4.5\nsave my.run\n# enough\nd -1\n1\n")
    assert status == 2
    assert err.startswith("error: it would be at 3.5, and the run is at 4.5")
    assert "> 2 @ 4.5\nstep 2, time 4.5 (+4.5)\n" in out
    lines = (tmp_path / "my.run").read_text().splitlines()
    assert lines[1:] == [
        "0        press!  Finger: Up -> Up & Lamp: Off -> Low",
        "4.5      press!  Finger: Up -> Up & Lamp: Low -> Bright",
    ]
    model, run = str(tmp_path / "lamp.ta"), str(tmp_path / "my.run")
    assert app.main(["replay", model, run], standalone_mode=False) == 0
    assert (
        app.main(["simulate", model, "--policy", "script", run, "--monitor", "G (presses < 2)"], standalone_mode=False)
        == 10
    )
    assert "p1: false" in capsys.readouterr().out


def test_the_run_is_written_when_the_session_ends(tmp_path: Path) -> None:
    out, _, status = _step(tmp_path, "1\nu\nq\n", "-o", "end")
    assert (status, (tmp_path / "end.run").read_text()) == (0, "# a run of lamp.ta\n")
    assert out.endswith("saved 0 steps to end.run; to show them: tachk replay lamp.ta end.run\n")


def test_a_script_ends_at_the_first_line_that_cannot_be_taken(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "lamp.ta").write_text(LAMP)
    (tmp_path / "wrong.run").write_text(
        "0 Finger: Up -> Up & Lamp: Off -> Low\n5 Finger: Up -> Up & Lamp: Low -> Bright\n"
    )
    model, run = str(tmp_path / "lamp.ta"), str(tmp_path / "wrong.run")
    assert app.main(["simulate", model, "--policy", "script", run], standalone_mode=False) == 2
    err = capsys.readouterr().err
    assert f"{run}:2:1: error[E0921]" in err
    assert f"{model}:10:" in err
    for wrong in (["--policy", "script"], [run], ["--policy", "script", run, "--runs", "2"]):
        assert app.main(["simulate", model, *wrong], standalone_mode=False) == 2


def test_a_terminal(tmp_path: Path) -> None:
    """A wrong line is told and forgotten there, and the end of the input ends the program."""
    (tmp_path / "lamp.ta").write_text(LAMP)
    ours, theirs = pty.openpty()
    environment = {**os.environ, "PYTHONPATH": str(Path("src").resolve()), "TERM": "dumb"}
    command = [sys.executable, "-m", "tachk", "step", "lamp.ta"]
    with subprocess.Popen(
        command, cwd=tmp_path, stdin=theirs, stdout=theirs, stderr=theirs, env=environment, close_fds=True
    ) as program:
        os.close(theirs)
        seen = ""

        def until(text: str) -> None:
            nonlocal seen
            while text not in seen:
                assert select.select([ours], [], [], 60)[0], seen
                seen += os.read(ours, 4096).decode()
            seen = seen.partition(text)[2]

        until("type `help` for the commands")
        for typed, answer in (("fly", "there is no command 'fly'"), ("1", "step 1, time 0"), ("q", "q")):
            until("> ")
            os.write(ours, f"{typed}\n".encode())
            until(answer)
        assert program.wait(60) == 0
    os.close(ours)


def test_random_steps_keep_their_times_short() -> None:
    text = "process P() { clock x; init location A { invariant x <= 7; to A { guard x > 1; } } } system P;"
    names, random = RunNames(tachk.loads(text).network), Random(1)
    session = Session(names, initial_state(names.model))
    while session.position < 200 and session.enabled().transitions:
        session = session.random(random)
    assert session.position > 2
    assert 1000 % session.state.time.denominator == 0


def test_an_invariant_bounds_a_clock_that_is_set_to_another_one() -> None:
    text = """
        clock x, y;
        process P() { init location a { to b { assign x = y + 1; } } location b { invariant x <= 3; } }
        system P;
    """
    names = RunNames(tachk.loads(text).network)
    (choice,) = enabled_steps(names, Session.begin(names).state).transitions
    assert [str(window) for window in choice.windows] == ["[0, 2]"]
