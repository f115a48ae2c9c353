"""A value of an option that nothing would look at is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from tachk.cli.main import app

MODEL = """
clock x;
process P() { init location A { to B { guard x >= 1; } } location B; }
system P;
property reached : E<> P.B;
"""
RECORDED = """
chan press;
process Lamp() { init location Off { to On { sync press?; } } location On; }
process Finger() { init location Idle { to Idle { sync press!; } } }
system Lamp, Finger;
recording { replaces Finger; visible press as press(); tolerance 1; }
"""
CAPTURE = bytes.fromhex("d4c3b2a1020004000000000000000000ffff000001000000")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("m.ta").write_text(MODEL)
    Path("r.ta").write_text(RECORDED)
    Path("good.run").write_text("2 P: A -> B\n3\n")
    Path("x.pcap").write_bytes(CAPTURE)
    Path("folder.pcap").mkdir()
    Path("binary.vcd").write_bytes(bytes(range(256)))
    Path("words.vcd").write_text("$timescale 1 ms $end\n?what\n")
    return tmp_path


@pytest.mark.parametrize(
    ("arguments", "message", "help"),
    [
        ("replay m.ta good.run --record nope", "there is no signal, process, location or variable 'nope'", "there are"),
        ("simulate m.ta --policy script good.run --record nope", "there is no signal, process, location", "there are"),
        ("step m.ta --property nope", "--property chooses among the runs of a report", "--load"),
        (
            "xrce proxy --listen 9 --to 127.0.0.1:8888 --property nope",
            "--property chooses among the runs",
            "--from-trace",
        ),
        ("chart x.pcap -o c.svg --property nope", "x.pcap: --property chooses among the runs of a report", ""),
        ("verify m.ta --max-memory 0", "a limit of 0 leaves no memory", "write it like 500M"),
        ("verify m.ta --max-memory 0.3", "a limit of 0.3 leaves no memory", "write it like 500M"),
        ("synthesize m.ta --property reached --over N=1..2 --max-memory 0K", "a limit of 0K leaves no memory", "like"),
        ("report m.ta -o o.html --max-memory 0", "a limit of 0 leaves no memory", "write it like 500M"),
        ("verify m.ta N=5", "'N=5' is not a query", "-D N=5"),
        ("verify m.ta x=1..3", "'x=1..3' is not a query", "-D x=1..3"),
        ("sweep m.ta --over N=1..2 M=1..3", "'M=1..3' is not a query", "--over M=1..3"),
        ("chart m.ta -o c.svg", "m.ta is a model; a chart shows a run of it", "tachk verify m.ta --format json"),
        ("verify m.ta --chart nowhere/x.svg", "there is no folder nowhere for the chart", "make it first"),
        ("verify m.ta --chart x.txt", "x.txt: charts are written as .svg or .png", "ending"),
        ("conform r.ta x.pcap --late 3ms --late output=4ms", "--late gives the lateness of outputs twice", "once"),
        ("test r.ta --simulate r.ta --late input=3ms --late input=4ms", "--late gives the lateness of inputs", ""),
        ("conform r.ta missing.pcap", "there is no file missing.pcap", ""),
        ("conform r.ta folder.pcap", "folder.pcap cannot be read: ", ""),
        ("conform r.ta .", ". cannot be read: ", ""),
    ],
)
@pytest.mark.usefixtures("folder")
def test_what_would_be_ignored(arguments: str, message: str, help: str) -> None:
    result = CliRunner().invoke(app, arguments.split())
    assert result.exit_code == 2
    assert result.stderr.startswith(f"error: {message}")
    assert not help or help in result.stderr.split("help: ")[1]
    assert "Errno" not in result.stderr


@pytest.mark.parametrize(("file", "line"), [("binary.vcd", 1), ("words.vcd", 2)])
@pytest.mark.usefixtures("folder")
def test_what_is_no_value_change_dump(file: str, line: int) -> None:
    result = CliRunner().invoke(app, ["monitor", "G (x < 5)", file])
    assert result.exit_code == 2
    assert result.stderr.startswith(f"{file}:{line}:")
    assert "error[E0917]: here begins neither a declaration (`$var`), a time (`#10`) nor" in result.stderr
    assert "help: tachk reads value change dumps that are texts" in result.stderr


@pytest.mark.usefixtures("folder")
def test_a_column_that_a_run_has_is_taken() -> None:
    result = CliRunner().invoke(app, ["replay", "m.ta", "good.run", "--record", "P", "-o", "o.jsonl"])
    assert result.exit_code == 0
    assert json.loads(Path("o.jsonl").read_text().splitlines()[0])["P"] == "A"
