"""The command lines of version 0.2 go on working, and say what they are called now."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest

from tachk.cli.former_names import FORMER_NAMES
from tachk.cli.main import COMMANDS, app

ROOT = Path(__file__).parents[3]
CAPTURE = ROOT / "tests/data/captures/later/serial_line.pcap"
MODEL = "process P() { clock x; init location control { to control { guard x > 2; assign x = 0; } } } system P;"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "m.ta").write_text(MODEL)
    (tmp_path / "m.csv").write_text("time,p,q\n0,1,0\n2,0,1\n9,0,0\n")


def run(line: str, capsys: pytest.CaptureFixture[str]) -> tuple[int, str, str]:
    status = app.main(shlex.split(line), prog_name="tachk", standalone_mode=False)
    said = capsys.readouterr()
    assert isinstance(status, int)
    return status, said.out, said.err


@pytest.mark.parametrize(
    ("before", "now"),
    [
        ("export m.ta", "convert m.ta --format xta --fix"),
        ("export m.ta --format json", "convert m.ta --format json --fix"),
        ("export m.ta --keep-names", "convert m.ta --format xta --keep-names"),
        ("mine 'G (p -> F[0, T] q)' m.csv --over T=0..20", "monitor 'G (p -> F[0, T] q)' m.csv --find T=0..20"),
        ("mine 'G (p -> F[0, T] q)' m.csv --over=T=0..20", "monitor 'G (p -> F[0, T] q)' m.csv --find T=0..20"),
        ("sentences precedence", "explain --sentences precedence"),
        (f"decode {CAPTURE}", f"xrce decode {CAPTURE}"),
        (f"measure {CAPTURE}", f"xrce measure {CAPTURE}"),
        ("proxy --listen 1 --show", "xrce proxy --listen 1 --show"),
        ("bridge m.ta --help", "xrce bridge m.ta --help"),
    ],
)
def test_the_old_name_does_the_same_with_a_note(before: str, now: str, capsys: pytest.CaptureFixture[str]) -> None:
    status, out, err = run(before, capsys)
    note, *others = err.splitlines(keepends=True)
    assert (status, out, "".join(others)) == run(now, capsys)
    name = before.split()[0]
    assert note == f"note: `tachk {name}` is now `tachk {FORMER_NAMES[name].name}`; the old name will go\n"


def test_export_overwrites_as_before(capsys: pytest.CaptureFixture[str]) -> None:
    Path("m.xml").write_text("mine")
    assert run("convert m.ta m.xml", capsys)[0] == 2
    assert run("export m.ta -o m.xml", capsys)[0] == 0
    assert run("export m.ta -o m.fmu", capsys)[0] == 0
    assert Path("m.xml").read_text() != "mine" and Path("m.fmu").exists()


def test_old_names_are_no_names_of_commands() -> None:
    assert not {*FORMER_NAMES} & {*COMMANDS}


def test_a_picture_of_a_region_by_o_has_a_note(capsys: pytest.CaptureFixture[str]) -> None:
    Path("n.ta").write_text("const int N = 1; process P() { init location a; } system P; property p : A[] N < 3;")
    line = "synthesize n.ta --property p --over N=0..4"
    status, out, _ = run(f"{line} --plot region.svg -o region.txt", capsys)
    assert (status, out) == (0, "") and Path("region.svg").read_text().startswith("<?xml")
    before = run(f"{line} -o old.svg", capsys)
    assert before[2] == "note: `-o old.svg` is now `--plot old.svg`; -o is the file of the report\n"
    assert before[1].replace("old.svg", "region.svg") == Path("region.txt").read_text()
    assert Path("old.svg").read_text().startswith("<?xml")
