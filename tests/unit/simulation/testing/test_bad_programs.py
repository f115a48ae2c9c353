"""Programs that do what no system should: a test of them ends, leaves no process behind, and says why."""

from __future__ import annotations

import os
import signal
import sys
from fractions import Fraction
from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.engine.options import Limits
from tachk.simulation.testing import program_system
from tachk.simulation.testing.event_lines import read_line
from tachk.simulation.testing.program_system import DrivenProgram, RealTimeProgram
from tachk.simulation.testing.system_adapter import SystemEndedError
from tachk.simulation.testing.tested_model import TestRequest, run_test_of_model
from tachk.simulation.testing.tester import TestVerdict
from tests.unit.simulation.testing.test_tester import DRIVEN, LAMP, outcome_of, program

READY = 'print(\'{"event": "ready"}\', flush=True)\n'
MILLISECONDS = Fraction(10**6)


def written(folder: Path, text: str) -> list[str]:
    file = folder / "program.py"
    file.write_text(text, encoding="utf-8")
    return [sys.executable, str(file)]


def test_program_that_does_not_read_is_inconclusive(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(program_system, "_SECONDS_TO_READ", 0.05)
    system = RealTimeProgram(written(tmp_path, READY + "import time\ntime.sleep(1000)"), MILLISECONDS)
    system.start()
    with pytest.raises(SystemEndedError, match="does not read its inputs"):
        system.send("press", {"text": "x" * 1_000_000})
    system.abandon()


def test_driven_program_that_does_not_answer_is_inconclusive(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    system = DrivenProgram(written(tmp_path, READY + "import time\ntime.sleep(1000)"))
    system.start()
    monkeypatch.setattr(program_system, "_SECONDS_TO_ANSWER", 0.05)
    with pytest.raises(SystemEndedError, match=r'gives no answer to \{"until": 1\} for 0\.05 s'):
        system.next_output(Fraction(1))
    system.abandon()


def test_time_of_few_digits_is_rejected(tmp_path: Path) -> None:
    answer = "input()\nprint('{\"time\": 14373.3274}', flush=True)\ninput()"
    system = DrivenProgram(written(tmp_path, READY + answer))
    system.start()
    with pytest.raises(UsageError, match=r"no `time` from 0 to 14373\.32736"):
        system.next_output(Fraction("14373.32736"))
    system.abandon()


def test_process_that_a_program_leaves_behind_is_not_waited_for(tmp_path: Path) -> None:
    """It holds the other end of stdout, which never closes."""
    child = "import subprocess, sys\nprint(subprocess.Popen(['sleep', '1000']).pid, file=open(sys.argv[1], 'w'))\n"
    number = tmp_path / "child"
    system = RealTimeProgram([*written(tmp_path, child + READY + "input()"), str(number)], MILLISECONDS)
    system.start()
    system.close()
    os.kill(int(number.read_text()), signal.SIGKILL)


def test_line_without_end_is_rejected(tmp_path: Path) -> None:
    endless = READY + "import sys\nwhile True: sys.stdout.write('x' * 65536)"
    system = RealTimeProgram(written(tmp_path, endless), MILLISECONDS)
    system.start()
    with pytest.raises(UsageError, match="is not JSON"):
        system.next_output(Fraction(10**6))
    system.abandon()


def test_line_without_event_is_rejected(tmp_path: Path) -> None:
    line = READY + "print('{\"time\": 3}', flush=True)\ninput()"
    with pytest.raises(UsageError, match="has no `event`"):
        outcome_of(f"process:{' '.join(written(tmp_path, line))}")


def test_program_that_sends_inputs_is_inconclusive(tmp_path: Path) -> None:
    """They would count as inputs of the test otherwise."""
    line = READY + 'print(\'{"event": "press"}\', flush=True)\ninput()'
    result = outcome_of(f"process:{' '.join(written(tmp_path, line))}")
    assert result.verdict is TestVerdict.INCONCLUSIVE
    assert "sends `press`, which is an input" in result.reason


@pytest.mark.parametrize(
    ("row", "named"),
    [('{"event": "lihgt"}', "`lihgt`"), ('{"event": "light", "colour": 3}', "`light` with a column `colour`")],
)
def test_events_that_the_model_does_not_show_are_inconclusive(tmp_path: Path, row: str, named: str) -> None:
    """They would count as outputs, and say nothing."""
    line = READY + f"print('{row}', flush=True)\ninput()"
    result = outcome_of(f"process:{' '.join(written(tmp_path, line))}")
    assert result.verdict is TestVerdict.INCONCLUSIVE
    assert f"sends {named}, which the recording" in result.reason


def test_program_that_ends_while_another_holds_its_streams_is_inconclusive(tmp_path: Path) -> None:
    child = "import subprocess, sys\nprint(subprocess.Popen(['sleep', '1000']).pid, file=open(sys.argv[1], 'w'))\n"
    number = tmp_path / "child"
    system = RealTimeProgram([*written(tmp_path, child + READY), str(number)], MILLISECONDS)
    system.start()
    process = system.program.process
    assert process is not None
    process.wait()
    with pytest.raises(SystemEndedError, match="has ended with status 0"):
        system.next_output(Fraction(1))
    system.close()
    os.kill(int(number.read_text()), signal.SIGKILL)


def test_input_that_has_to_be_sent_at_once_is_not_blamed_on_the_program(tmp_path: Path) -> None:
    urgent = LAMP.replace("chan press;", "urgent chan press;").replace("guard pause >= 2; ", "")
    result = outcome_of(f"process:{' '.join(written(tmp_path, READY + 'input()'))}", urgent)
    assert result.verdict is TestVerdict.INCONCLUSIVE
    assert result.reason.startswith("the environment of the model must send `press` by 0, and the test was too late")


def test_models_without_a_unit_are_tested_for_so_many_of_them() -> None:
    text = LAMP.replace("time_unit = 1 ms;", "")
    request = TestRequest(f"driven:{program(DRIVEN, 4)}")
    result, _ = run_test_of_model(tachk.loads(text).loaded, "model", request, Limits())
    assert result.verdict is TestVerdict.PASS
    assert result.recording.end == 10_000


@pytest.mark.parametrize("number", ["1e999999999", "1e-999999999", "1E" + "9" * 5000])
def test_huge_exponents_are_rejected(number: str) -> None:
    with pytest.raises(UsageError, match="is not JSON"):
        read_line(f'{{"time": {number}, "event": "light"}}'.encode())


@pytest.mark.parametrize("pause", ["0", "0.3ms"])
def test_pause_without_time_is_rejected(pause: str) -> None:
    with pytest.raises(UsageError, match="shorter than a unit"):
        outcome_of(f"driven:{program(DRIVEN, 4)}", pause=pause)
