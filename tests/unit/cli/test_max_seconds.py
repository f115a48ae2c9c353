"""``--max-seconds``: every command that reads models or traces ends with status 20 when its time is over."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from itertools import count
from pathlib import Path

import click
import pytest

from tachk import _core
from tachk.base import job as module
from tachk.base.job import OutOfTimeError, limited
from tachk.base.span import Source
from tachk.cli.commands.check import run_check
from tachk.cli.exit_status import ExitStatus
from tachk.cli.main import COMMANDS, app, load_command
from tachk.engine import liveness, measuring, taking_turns, zone
from tachk.engine.outcome import INTERRUPTED
from tachk.formats.catalogue import export_model
from tachk.formats.layout.placement.template import place_template
from tachk.formats.loading.load import load_model
from tachk.frontend.loaded import LoadedModel
from tachk.frontend.templates import instances
from tachk.recordings.monitors.formulas import read_formulas
from tachk.recordings.monitors.offline import evaluate_formulas
from tachk.recordings.traces.trace_files import open_trace
from tachk.syntax import ast

MODEL = """
int n;
process P(int[0,2] id) { clock x; init location A { to B { guard x > 1; assign n = id, id = 1; } } location B; }
process Q(const int[0,40] id) {
    init location A { to B; to C; } location B { to A; to C; } location C { to B; to A; }
}
system P, Q;
property p : A[] n < 3;
"""
RECORDED = """
chan press;
process Lamp() { init location Off { to On { sync press?; } } location On; }
process Finger() { init location Idle { to Idle { sync press!; } } }
system Lamp, Finger;
recording { replaces Finger; visible press as press(); tolerance 1; }
"""
VCD = "$timescale 1 ms $end\n$var wire 1 ! p $end\n$enddefinitions $end\n" + "".join(
    f"#{i}\n{i % 2}!\n" for i in range(60)
)

WITHOUT = {"models", "completion", "verifyta", "xrce proxy", "xrce bridge", "mcp", "serve"}
"""They read nothing of the user's, take the options of another program, or run until they are stopped."""

COMMAND_LINES = (
    "verify m.ta",
    "synthesize m.ta --property p --over N=1..2",
    "sweep m.ta -D N=1..2 --quiet",
    "simulate m.ta -o out.csv",
    "estimate m.ta Pr[<=100](<>true)",
    "replay m.ta m.run",
    "step m.ta",
    "report m.ta -o out.html",
    "time m.ta --to n==2",
    "check m.ta",
    "fmt m.ta",
    "convert m.ta out.xml",
    "convert m.ta out.ta",
    "convert m.ta -o out.tck",
    "diff m.ta m.ta",
    "draw m.ta -o out.svg",
    "monitor p m.csv",
    "monitor G(F[0,T]x>0) m.csv --find T=0..9",
    "monitor p m.csv --online",
    "plot p m.csv -o out.svg",
    "explain m.ta",
    "certify m.ta m.cert",
    "conform r.ta r.csv",
    "test r.ta --simulate r.ta",
    "xrce decode m.pcap",
    "xrce measure m.pcap",
    "chart m.pcap -o out.svg",
)

COVERING = "tests m.ta -o suite"
"""Says of each edge that it is not known whether it can be taken."""
ASKING_MUCH = "requirements r.stl"
"""Has a time for each question, and tells of each what is not known."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "m.ta").write_text(MODEL)
    (tmp_path / "m.run").write_text("1\n")
    (tmp_path / "m.csv").write_text("time,p\n0,1\n1,0\n")
    (tmp_path / "r.ta").write_text(RECORDED)
    (tmp_path / "r.csv").write_text("time,event\n2,press\n")
    (tmp_path / "r.stl").write_text("G (p -> F[0,3] q)\n")
    (tmp_path / "m.cert").write_bytes(b"")
    (tmp_path / "m.pcap").write_bytes(bytes.fromhex("d4c3b2a1 02000400 00000000 00000000 ffff0000 65000000"))
    return tmp_path


@pytest.fixture
def looks(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A clock that goes on by a second whenever the time is looked at."""
    ticks = count()
    monkeypatch.setattr(module, "monotonic", lambda: float(next(ticks)))
    return ticks


def run(line: str) -> int:
    status = app.main(line.split(), prog_name="tachk", standalone_mode=False)
    assert isinstance(status, int)
    return status


@pytest.mark.parametrize("name", sorted({*COMMANDS} - WITHOUT))
def test_a_command_that_reads_files_has_the_option(name: str) -> None:
    command = load_command(name)
    assert isinstance(command, click.Command)
    assert "--max-seconds" in [option for parameter in command.params for option in parameter.opts]
    assert any(f"{line} ".startswith(f"{name} ") for line in (*COMMAND_LINES, ASKING_MUCH, COVERING))


@pytest.mark.parametrize("line", COMMAND_LINES)
def test_without_time_there_is_one_message_and_one_status(
    folder: Path, capsys: pytest.CaptureFixture[str], line: str
) -> None:
    before = sorted(folder.iterdir())
    assert run(f"{line} --max-seconds 0") == 20
    assert capsys.readouterr().err == "error: the time limit was over before there was a result\n"
    assert sorted(folder.iterdir()) == before
    assert (folder / "m.ta").read_text() == MODEL


def test_questions_without_time_have_no_answer(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(f"{ASKING_MUCH} --max-seconds 0") == 20
    assert "can be satisfied is not known: time limit" in capsys.readouterr().out
    assert run(f"{COVERING} --max-seconds 0") == 20


@pytest.mark.parametrize(
    "line", ["check m.ta", "convert m.ta out.json", "explain G(p)", "diff m.ta m.ta", "conform r.ta r.csv"]
)
def test_time_enough_changes_nothing(folder: Path, line: str) -> None:
    assert run(f"{line} --max-seconds 1000") == 0


def test_a_model_without_time_is_in_the_reports_and_keeps_no_other_from_being_checked(
    folder: Path, capsys: pytest.CaptureFixture[str], looks: Iterator[int]
) -> None:
    (folder / "small.ta").write_text("process P() { init location A; }\nsystem P;\n")
    status = run_check(("m.ta", "small.ta"), (), form="json", seconds=60)
    assert status is ExitStatus.UNKNOWN
    long, short = json.loads(capsys.readouterr().out)["models"]
    assert long["size"] is None
    assert [found["message"] for found in long["findings"]] == ["the time limit was over before there was a result"]
    assert short["size"]["processes"] == 1


def test_a_mistake_is_graver_than_no_time(folder: Path, looks: Iterator[int]) -> None:
    (folder / "wrong.ta").write_text("system P;\n")
    assert run_check(("m.ta", "wrong.ta"), (), seconds=60) is ExitStatus.BAD_INPUT


def template_of(model: LoadedModel) -> ast.Template:
    return next(item for item in model.items if isinstance(item, ast.Template))


@pytest.mark.parametrize(
    ("work", "seconds"),
    [
        (lambda model: export_model(model, "json"), 40),
        (lambda model: export_model(model, "dot"), 40),
        (lambda model: place_template(template_of(model)), 4),
    ],
)
def test_writing_ends(looks: Iterator[int], work: Callable[[LoadedModel], object], seconds: int) -> None:
    model = load_model(Source("m.ta", MODEL))
    with pytest.raises(OutOfTimeError), limited(seconds):
        work(model)


def test_reading_a_trace_ends(tmp_path: Path, looks: Iterator[int]) -> None:
    (tmp_path / "m.vcd").write_text(VCD)
    (tmp_path / "m.run").write_text("1\n")
    (tmp_path / "m.csv").write_text("time,p\n0,1\n1,0\n")
    (tmp_path / "r.ta").write_text(RECORDED)
    (tmp_path / "r.csv").write_text("time,event\n2,press\n")
    (tmp_path / "r.stl").write_text("G (p -> F[0,3] q)\n")
    (tmp_path / "m.cert").write_bytes(b"")
    (tmp_path / "m.pcap").write_bytes(bytes.fromhex("d4c3b2a1 02000400 00000000 00000000 ffff0000 65000000"))
    with pytest.raises(OutOfTimeError), limited(50):
        open_trace(str(tmp_path / "m.vcd")).read()
    for text in ("p", "F[0,1] p"):
        (formula,) = read_formulas(text)
        with pytest.raises(OutOfTimeError), limited(1.5):
            evaluate_formulas((formula,), open_trace(str(tmp_path / "m.csv")))


def test_what_a_template_assigns_to_is_found_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    found = instances.changed_parameters

    def counted(template: object) -> object:
        asked.append(template.name.name)  # type: ignore[attr-defined]
        return found(template)  # type: ignore[arg-type]

    monkeypatch.setattr(instances, "changed_parameters", counted)
    network = load_model(Source("m.ta", MODEL)).network
    assert asked == ["P", "Q"]
    assert [[v.name for v in p.variables if "id" in v.name] for p in network.processes[:3]] == [
        ["P(0).id"],
        ["P(1).id"],
        ["P(2).id"],
    ]


@pytest.fixture
def interrupted(monkeypatch: pytest.MonkeyPatch) -> None:
    for searching in (zone, taking_turns, measuring, liveness):
        monkeypatch.setattr(searching, "run_in_slices", lambda *_: (_core.Status.RUNNING, INTERRUPTED))


@pytest.mark.usefixtures("interrupted")
@pytest.mark.parametrize(
    "line", ["conform r.ta r.csv r.csv --explain none", "conform r.ta r.csv --explain full", "requirements r.stl"]
)
def test_a_search_that_is_interrupted_is_not_undecided(
    folder: Path, capsys: pytest.CaptureFixture[str], line: str
) -> None:
    assert run(f"{line} -o out.txt") == ExitStatus.INTERRUPTED
    assert capsys.readouterr().err == "error: interrupted before there was an answer\n"
    assert not (folder / "out.txt").exists()


@pytest.mark.usefixtures("interrupted")
def test_no_further_model_is_explored_after_an_interrupt(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("check m.ta r.ta --deep") == ExitStatus.INTERRUPTED
    assert "r.ta" not in capsys.readouterr().out
