"""How the program treats the streams it is given, tried with whole processes."""

from __future__ import annotations

import io
import os
import pty
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tachk.cli.terminal import wants_colour, width_of

pytestmark = pytest.mark.drawn

BROKEN = "process P() { init location a { to b; } location b; }\nsystem P;\nproperty safe : A[] P.a;\n"
TWO = BROKEN + "property other : G (P.a -> F[0, 5] P.b);\n"


@pytest.fixture
def model(tmp_path: Path) -> Path:
    path = tmp_path / "m.ta"
    path.write_text(BROKEN, encoding="utf-8")
    return path


def tachk(*arguments: object, **variables: str) -> subprocess.CompletedProcess[bytes]:
    kept = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "FORCE_COLOR", "COLUMNS")}
    command = [sys.executable, "-m", "tachk", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, env=kept | variables, check=False)


@pytest.mark.parametrize("encoding", ["cp1252", "ascii", "latin-1:strict"])
def test_characters_that_a_stream_does_not_have_are_replaced(model: Path, encoding: str) -> None:
    done = tachk("verify", model, PYTHONIOENCODING=encoding)
    assert (done.returncode, done.stderr) == (10, b"")
    assert b"x safe" in done.stdout
    assert b"P: a -> b" in done.stdout


def test_a_name_that_is_no_text_is_reported(tmp_path: Path) -> None:
    done = tachk("check", os.fsdecode(os.fsencode(tmp_path) + b"/\xff.ta"))
    assert done.returncode == 2
    assert b"?.ta" in done.stderr
    assert b"Traceback" not in done.stderr


def test_lines_of_a_report_do_not_end_with_blanks(model: Path) -> None:
    lines = tachk("verify", model, "E<> P.b", "--property", "safe").stdout.decode().splitlines()
    assert len(lines) > 5
    assert [line for line in lines if line != line.rstrip()] == []


class Screen(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(
    ("variables", "on_terminal", "on_pipe"),
    [
        ({}, True, False),
        ({"NO_COLOR": "1"}, False, False),
        ({"NO_COLOR": ""}, True, False),
        ({"FORCE_COLOR": "1"}, True, True),
        ({"FORCE_COLOR": "0"}, True, False),
        ({"FORCE_COLOR": "1", "NO_COLOR": "1"}, False, False),
        ({"TERM": "dumb"}, False, False),
        ({"TERM": "dumb", "FORCE_COLOR": "1"}, True, True),
    ],
)
def test_colour_is_what_the_environment_says(
    variables: dict[str, str], on_terminal: bool, on_pipe: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("NO_COLOR", "FORCE_COLOR"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    for stream, wanted in ((Screen(), on_terminal), (io.StringIO(), on_pipe)):
        monkeypatch.setattr(sys, "stderr", stream)
        assert wants_colour(stream) is wanted


def test_reports_and_messages_follow_the_environment(model: Path, tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.ta"
    wrong.write_text("process P( {}\n", encoding="utf-8")
    report = tmp_path / "report.txt"
    assert b"\x1b[" in tachk("check", wrong, FORCE_COLOR="1").stderr
    assert b"\x1b[" in tachk("verify", model, FORCE_COLOR="1").stdout
    tachk("verify", model, "-o", report, FORCE_COLOR="1")
    assert b"\x1b[" not in report.read_bytes()


@pytest.mark.parametrize("variables", [{"NO_COLOR": "1"}, {"TERM": "dumb"}])
def test_a_terminal_without_colour_gets_none(model: Path, variables: dict[str, str]) -> None:
    ours, theirs = pty.openpty()
    environment = {"PATH": os.environ["PATH"], "PYTHONPATH": os.environ.get("PYTHONPATH", ""), "TERM": "xterm"}
    command = [sys.executable, "-m", "tachk", "verify", str(model), "A[] P.c"]
    process = subprocess.Popen(command, stdout=theirs, stderr=theirs, env=environment | variables)
    os.close(theirs)
    said = b""
    try:
        while piece := os.read(ours, 4096):
            said += piece
    except OSError:  # this is how Linux tells the end
        pass
    assert process.wait() == 2
    os.close(ours)
    assert b"error[" in said
    assert b"\x1b" not in said


def test_width_of_a_stream_that_is_no_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    assert width_of(io.StringIO()) == 80
    monkeypatch.setenv("COLUMNS", "132")
    assert width_of(io.StringIO()) == 132
    monkeypatch.setenv("COLUMNS", "wide")
    assert width_of(io.StringIO()) == 80


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    "arguments", [["verify"], ["explain", "E0101"], ["--help"], ["--version"], ["time", "-h"], ["verifyta", "-h"]]
)
def test_nobody_reading_is_no_error(model: Path, arguments: list[str], unbuffered: str) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "tachk", *arguments, *([str(model)] if arguments == ["verify"] else [])]
    environment = {**os.environ, "PYTHONUNBUFFERED": unbuffered}
    process = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, check=False, env=environment)
    os.close(writing)
    assert (process.returncode, process.stderr) == (-signal.SIGPIPE, b"")


def test_nobody_reading_what_is_wrong_is_no_error_either() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    process = subprocess.run([sys.executable, "-m", "tachk", "nothing"], stderr=writing, check=False)
    os.close(writing)
    assert process.returncode == -signal.SIGPIPE


INTERRUPT_SECOND_SEARCH = """
import sys
from tachk.verify import reachability
from tachk.cli.main import run

lowered, searches = reachability.lowered, []

def interrupt(*arguments):
    searches.append(arguments)
    if len(searches) > 1:
        raise KeyboardInterrupt
    return lowered(*arguments)

reachability.lowered = interrupt
run()
"""


def test_interruption_keeps_what_is_decided_and_ends_the_loop_of_a_shell(tmp_path: Path) -> None:
    path = tmp_path / "m.ta"
    path.write_text(TWO, encoding="utf-8")
    command = [sys.executable, "-c", INTERRUPT_SECOND_SEARCH, "verify", str(path), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == -signal.SIGINT
    assert done.stderr == ""
    assert "✗ safe      fails" in done.stdout
    assert "other is unknown: interrupted" in done.stdout
    assert done.stdout.count("m.ta") == 1


@pytest.mark.parametrize("command", ["verify", "check"])
def test_models_come_through_pipes(command: str, tmp_path: Path) -> None:
    text = BROKEN.replace("A[]", "E<>").encode()
    process = [sys.executable, "-m", "tachk", command]
    done = subprocess.run([*process, "/dev/stdin"], input=text, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    assert done.stdout.startswith(b"/dev/stdin")
    reading, writing = os.pipe()
    os.write(writing, text)
    os.close(writing)
    done = subprocess.run([*process, f"/dev/fd/{reading}"], pass_fds=[reading], capture_output=True, check=False)
    os.close(reading)
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&-", "<&- >&- 2>&-"])
@pytest.mark.parametrize("command", ["verify", "verify --quiet", "check", "verifyta"])
def test_closed_streams_leave_the_status(model: Path, command: str, closed: str) -> None:
    shell = f'"$0" -m tachk {command} "$1" {closed}'
    done = subprocess.run(["sh", "-c", shell, sys.executable, str(model)], capture_output=True, text=True, check=False)
    assert done.returncode == (10 if command.startswith("verify ") or command == "verify" else 0)
    assert "Traceback" not in done.stderr


def test_requirements_for_which_nobody_waits(tmp_path: Path) -> None:
    path = tmp_path / "r.stl"
    path.write_text("G true\n", encoding="utf-8")
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "tachk", "requirements", str(path)]
    done = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, check=False)
    os.close(writing)
    assert (done.returncode, done.stderr) == (-signal.SIGPIPE, b"")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no device that is always full")
@pytest.mark.parametrize("arguments", [["--help"], ["verify", "--help"]])
def test_a_full_disk_is_reported(arguments: list[str]) -> None:
    with open("/dev/full", "w", encoding="utf-8") as full:
        command = [sys.executable, "-m", "tachk", *arguments]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (2, "error: standard output: No space left on device\n")


BROKEN_OFF = """
import os, signal, sys
from tachk.simulation import tables
from tachk.cli.main import run

rows_of = tables._rows

def broken_off(trace):
    os.kill(os.getpid(), signal.{name})
    return rows_of(trace)

tables._rows = broken_off
run()
"""


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
@pytest.mark.parametrize("file", ["runs.csv", "runs.jsonl"])
def test_who_is_broken_off_leaves_no_half_written_file(model: Path, tmp_path: Path, name: str, file: str) -> None:
    (tmp_path / "runs.csv").write_text("old")
    command = [sys.executable, "-c", BROKEN_OFF.format(name=name), "simulate", str(model), "-o", str(tmp_path / file)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (
        -getattr(signal, name),
        f"error: {tmp_path / file}: not written: interrupted\n",
    )
    assert sorted(each.name for each in tmp_path.iterdir()) == ["m.ta", "runs.csv"]
    assert (tmp_path / "runs.csv").read_text() == "old"


TWICE = """
import os, signal, sys
from multiprocessing import get_context
from time import sleep
from tachk.cli import termination
from tachk.simulation import tables
from tachk.cli.main import run

termination._SECONDS_OF_ONE_INTERRUPT = {apart}

def broken_off(trace):
    get_context("fork").Process(target=sleep, args=(60,), daemon=True).start()
    try:
        os.kill(os.getpid(), signal.{name})
        sleep(60)
    finally:  # what ends the command is still under way when it is broken off again
        os.kill(os.getpid(), signal.{name})
        print("went on", file=sys.stderr)

tables._rows = broken_off
run()
"""


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM"])
@pytest.mark.parametrize(("apart", "said"), [(-1, ""), (60, "went on\nerror: {file}: not written: interrupted\n")])
def test_a_second_interrupt_ends_at_once_and_a_double_one_is_one(
    model: Path, tmp_path: Path, name: str, apart: int, said: str
) -> None:
    code = TWICE.format(name=name, apart=apart)
    file = tmp_path / "runs.csv"
    command = [sys.executable, "-c", code, "simulate", str(model), "-o", str(file)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=50)
    assert (done.returncode, done.stderr) == (-getattr(signal, name), said.format(file=file))
    assert sorted(each.name for each in tmp_path.iterdir()) == ["m.ta"]


AT_THE_END = """
import gc, os, signal
from tachk.cli.main import run

gc.freeze = lambda: os.kill(os.getpid(), signal.SIGINT)
run()
"""


def test_an_interrupt_behind_the_report_ends_without_a_word() -> None:
    done = subprocess.run([sys.executable, "-c", AT_THE_END, "--version"], capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (-signal.SIGINT, b"")
