"""Scripts written for UPPAAL's verifyta: their command lines, and how they read what comes out.

Each reader here does what the program in its name does with the output: the same expressions, on the same streams, in
the same order. Found in public repositories; the names are those of the repositories.
"""

from __future__ import annotations

import io
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from random import Random

import pytest

import tachk.cli.verifyta_answers
from tachk.cli.commands.verifyta import run as console_script
from tachk.cli.main import app
from tachk.engine.options import Extrapolation, Options, Pace, SearchOrder
from tests.support.seeds import seeds

MODEL = """\
<?xml version="1.0" encoding="utf-8"?>
<nta><declaration>clock x; int isStable; broadcast chan go;</declaration>
<template><name>P</name>
<location id="id0"><name>A</name><label kind="invariant">x&lt;=5</label></location>
<location id="id1"><name>B</name></location><init ref="id0"/>
<transition><source ref="id0"/><target ref="id1"/><label kind="guard">x&gt;=2</label>
<label kind="synchronisation">go!</label><label kind="assignment">isStable = 1</label></transition></template>
<system>system P;</system>
<queries>{queries}</queries></nta>
"""
REACH, NEVER, DEADLOCK = "E&lt;&gt; P.B", "A[] not P.B", "A[] not deadlock"
LIVE, CHANCE = "E&lt;&gt; deadlock + 1 == 1", "Pr[&lt;=10](&lt;&gt; P.B)"


@dataclass(frozen=True)
class Result:
    out: str
    err: str
    status: int


def verifyta(*arguments: str) -> Result:
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err), pytest.raises(SystemExit) as end:
        app(["verifyta", *arguments], prog_name="tachk")
    return Result(out.getvalue(), err.getvalue(), int(end.value.code or 0))


def query(formula: str) -> str:
    return f"<query><formula>{formula}</formula><comment/></query>"


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Path]:
    (tmp_path / "m.xml").write_text(MODEL.format(queries="".join(map(query, (REACH, NEVER, DEADLOCK)))))
    (tmp_path / "mixed.xml").write_text(
        MODEL.format(queries="".join(map(query, (REACH, LIVE, CHANCE, DEADLOCK)))),
    )
    (tmp_path / "broken.xml").write_text(MODEL.format(queries=query(REACH)).replace("x&gt;=2", "x&gt;=y"))
    (tmp_path / "q.q").write_text("/* first */\nE<> P.B\n\n// second\nA[] not P.B\n")
    (tmp_path / "true.q").write_text("E<> P.B\n")
    (tmp_path / "false.q").write_text("A[] not P.B\n")
    (tmp_path / "holds.q").write_text("A[] x >= 0\n")
    (tmp_path / "refused.q").write_text("E<> deadlock + 1 == 1\n")
    with chdir(tmp_path):
        yield tmp_path


# Muppaal, UppaalMutants: `verifyta -q MODEL QUERIES`; no line at all means that the mutant does not compile.


def muppaal_kills(result: Result) -> bool:
    lines = iter(result.out.splitlines())
    if next(lines, None) is None:
        return True
    return any("NOT satisfied" in line or "MAY be satisfied" in line for line in lines)


def test_muppaal(folder: Path) -> None:
    assert not muppaal_kills(verifyta("-q", "m.xml", "true.q"))
    assert muppaal_kills(verifyta("-q", "m.xml", "false.q"))
    assert muppaal_kills(verifyta("-q", "broken.xml", "true.q"))
    assert not muppaal_kills(verifyta("-q", "m.xml", "refused.q")), "what tachk cannot check kills no mutant"


# Gamma: `verifyta -t0 -T MODEL QUERIES`; an empty standard error means that there is no trace, so that an A query is
# true and an E query false; a line with [error] there stops it.


def gamma_verdict(formula: str, result: Result) -> bool | str:
    if not result.err:
        return formula.startswith(("A[]", "A<>")) or "-->" in formula
    if "[error]" in result.err:
        return "error"
    gamma_trace(result.err)
    if "Formula is NOT satisfied" in result.out:
        return False
    return True if "Formula is satisfied" in result.out else "undefined"


def gamma_trace(text: str) -> list[tuple[str, object]]:
    """The back-annotator's automaton: what it takes from which lines."""
    found: list[tuple[str, object]] = []
    state = "initial"
    for raw in text.splitlines():
        line = raw.strip()
        if line in ("State", "State:"):
            state = "locations"
        elif line == "Transitions:":
            state = "transitions"
        elif line.startswith("Delay:"):
            found.append(("delay", int(line[len("Delay:") + 1 :])))
        elif line:
            if state == "locations":
                found.append(("locations", [w for w in line.split(" ") if w not in ("(", ")")]))
                state = "variables"
            elif state == "variables":
                found.append(("variables", dict(w.split("=") for w in line.split(" ") if w)))
            elif state == "transitions":
                actions = line[line.index("{") + 2 : line.index("}") - 1].split(", ")
                found.append(("actions", actions))
    return found


def test_gamma(folder: Path) -> None:
    assert gamma_verdict("E<> P.B", verifyta("-t0", "-T", "m.xml", "true.q")) is True
    assert gamma_verdict("A[] not P.B", verifyta("-t0", "-T", "m.xml", "false.q")) is False
    assert gamma_verdict("A[] x >= 0", verifyta("-t0", "-T", "m.xml", "holds.q")) is True
    assert gamma_verdict("E<> deadlock + 1 == 1", verifyta("-t0", "-T", "m.xml", "refused.q")) == "error"
    assert gamma_trace(verifyta("-t0", "-T", "m.xml", "true.q").err) == [
        ("locations", ["P.A"]),
        ("variables", {"x": "0", "isStable": "0"}),
        ("delay", 2),
        ("locations", ["P.A"]),
        ("variables", {"x": "2", "isStable": "0"}),
        ("actions", ["x >= 2", "go!", "isStable := 1"]),
        ("locations", ["P.B"]),
        ("variables", {"x": "2", "isStable": "1"}),
    ]


# PyUPPAAL: `-v` tells the version behind the word UPPAAL; then `MODEL -f NAME -t 1`, `MODEL -X NAME -t 1 -o 0`. It
# raises on any standard error that does not announce a trace.


def pyuppaal(result: Result) -> str:
    known = ("Writing example trace to", "Writing counter example", "[warning] Strict invariant.")
    if result.err and not any(words in result.err for words in known) and "Showing" not in result.out:
        raise ValueError(result.err)
    return result.err + result.out


def test_pyuppaal(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    words = pyuppaal(verifyta("-v")).split(" ")
    assert int(words[words.index("UPPAAL") + 1].split(".")[0]) == 4
    monkeypatch.setenv("UPPAAL_COMPILE_ONLY", "")
    said = pyuppaal(verifyta("m.xml", "-f", "demo", "-t", "1", "-o", "0"))
    assert "Writing example trace to demo-1.xtr\n" in said
    assert "Writing counter example to demo-2.xtr\n" in said
    assert sorted(path.name for path in folder.glob("*.xtr")) == ["demo-1.xtr", "demo-2.xtr", "demo-3.xtr"]
    assert "XMLTrace outputted to: demo1.xml\n" in pyuppaal(verifyta("m.xml", "true.q", "-X", "demo", "-t", "1"))
    assert (folder / "demo1.xml").read_text().startswith('<?xml version="1.0" encoding="UTF-8"?>\n<trace ')
    assert "Showing example trace." in pyuppaal(verifyta("m.xml", "true.q", "-t", "1"))
    assert pyuppaal(verifyta("m.xml", "holds.q")).count("\n -- Formula is satisfied.\n") == 1
    with pytest.raises(ValueError, match="not a number"):
        pyuppaal(verifyta("m.xml", "refused.q"))
    monkeypatch.setenv("UPPAAL_COMPILE_ONLY", "1")
    compiled = pyuppaal(verifyta("m.xml"))
    assert compiled.startswith("layout\n0:clock:0:t(0)\n1:clock:1:x\n2:var:-32768:32767:0:0:isStable\n3:location::A\n")


# The others.


def test_pyuppaal_of_2011_and_tamus(folder: Path) -> None:
    result = verifyta("-o0", "-S1", "-q", "m.xml", "q.q")
    assert re.findall(r"^Verifying \w+ (\d+) at ", result.out, re.M) == ["1", "2"]
    assert "Options" not in result.out
    result = verifyta("-t1", "-o0", "-S1", "-q", "m.xml", "true.q")
    assert re.findall(r"->P\.(\w+)", result.err) == ["B"]


def test_strategoutil_and_stompc(folder: Path) -> None:
    result = verifyta("m.xml", "true.q", "--learning-method", "4", "--good-runs", "100", "--nosummary")
    assert not result.err, "it raises on any"
    assert "Formula is satisfied" in result.out


def test_uppaal_experiment_runner(folder: Path) -> None:
    result = verifyta("--seed", "12345678901", "m.xml", "q.q")
    assert result.status == 0
    assert re.findall(r"Verifying formula (\d+)", result.out) == ["1", "2"]


def test_experiments_of_brandhoej(folder: Path) -> None:
    result = verifyta("m.xml", "q.q", "--silence-progress", "--summary")
    assert result.status == 0
    assert len(re.findall(r"States explored\s*:\s*(\d+)", result.out)) == 2
    assert len(re.findall(r"CPU user time used\s*:", result.out)) == 2


def test_simmdiff(folder: Path) -> None:
    result = verifyta("-t", "0", "-r", "-1234567", "-q", "m.xml", "true.q")
    assert "Transitions:" in result.err
    assert result.out


def test_uppyyl(folder: Path) -> None:
    result = verifyta("-t", "0", "-X", "obs", "m.xml")
    assert "-- Formula is satisfied." in result.out
    assert (folder / "obs1.xml").exists()


def test_scripts_that_give_the_model_alone(folder: Path) -> None:
    result = verifyta("m.xml")
    assert re.findall(r"Formula is( NOT)? satisfied", result.out) == ["", " NOT", " NOT"]
    assert (result.status, result.err) == (0, "")


def test_wrapper_of_artmus208(folder: Path) -> None:
    assert verifyta("--version").status == 0
    assert verifyta("-t0", "m.xml", "q.q").status == 0
    one = verifyta("--search-order", "0", "--query-index", "1", "m.xml", "q.q")
    assert re.findall(r"^Verifying formula (\d+)", one.out, re.M) == ["2"]


def test_scripts_that_write_the_intermediate_format(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("UPPAAL_COMPILE_ONLY", "1")
    assert verifyta("m.xml", "-").out.count("\n\n") == 6


def test_queries_from_standard_input(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("E<> P.B\n"))
    assert "Formula is satisfied" in verifyta("-u", "m.xml", "-").out


# Numbers, places, streams and statuses.


def test_formulas_that_are_not_checked_keep_their_numbers(folder: Path) -> None:
    result = verifyta("mixed.xml")
    found = re.findall(r"^Verifying formula (\d+) at (\S+)\n -- (.*)", result.out, re.M)
    assert [(number, place) for number, place, _ in found] == [
        (str(number), f"/nta/queries/query[{number}]/formula") for number in (1, 2, 3, 4)
    ]
    assert [said.startswith("Formula is") for _, _, said in found] == [True, False, True, True]
    assert result.out.count("satisfied") == 3
    assert result.err.count("[error]") == 1
    assert result.status == 3


def test_places_in_a_file_of_queries(folder: Path) -> None:
    found = re.findall(r"^Verifying formula (\d+) at (.*)$", verifyta("m.xml", "q.q").out, re.M)
    assert found == [("1", "q.q:2"), ("2", "q.q:5")]


def test_no_output_and_a_message_for_a_model_that_is_wrong(folder: Path) -> None:
    result = verifyta("broken.xml")
    assert (result.out, result.status) == ("", 2)
    assert "broken.xml:6:77: [error] unknown name `y`" in result.err


def test_an_unknown_process_is_an_error(folder: Path) -> None:
    (folder / "absent.q").write_text("E<> P.B\nE<> Q.B\n")
    result = verifyta("m.xml", "absent.q")
    assert result.out.count("satisfied") == 1
    assert "absent.q:2:5: [error] unknown name `Q`" in result.err
    assert result.status == 2


def test_a_trace_of_valuations(folder: Path) -> None:
    err = verifyta("-yt0", "m.xml", "true.q").err
    assert "State\n( P.A )\nx<=5 isStable=0\n" in err
    assert "State\n( P.B )\nx>=2 isStable=1\n" in err


def test_no_trace_unless_requested(folder: Path) -> None:
    assert verifyta("m.xml").err == ""
    assert "Generating no trace" in verifyta("m.xml").out


@pytest.mark.parametrize(
    ("arguments", "summary"),
    [
        (["-t2"], "Generating fastest trace"),
        (["-o2", "-r5"], "Search order is random depth first"),
        (["-t1", "-o1"], "Search order is breadth first"),
        (["-o6"], "tachk: there is no search order 6 here"),
        (["-A"], "tachk: -A has no effect: zones are kept exact"),
        (["-S2"], "tachk: -S 2 has no effect: all states are stored"),
        (["-Z", "-H27"], "tachk: -H has no effect"),
        (["-ZH", "27"], "tachk: -Z has no effect"),
        (["-D", "0.01", "-E=0.1"], "tachk: -D has no effect"),
        (["--diag=1"], "Generating shortest trace"),
        (["-n3", "-u", "-s"], "Options for the verification:"),
    ],
)
def test_options_are_honoured_or_noted(folder: Path, arguments: Sequence[str], summary: str) -> None:
    result = verifyta(*arguments, "m.xml", "holds.q")
    assert summary in result.out
    assert (result.status, result.err) == (0, "")


def test_harmless_values_are_not_noted(folder: Path) -> None:
    quiet = ["-S0", "-S0", "-O", "std", "--key", "K", "--lease=168", "-T", "-n", "4"]
    assert "tachk" not in verifyta(*quiet, "m.xml", "holds.q").out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "no model is given"),
        (["-k", "m.xml"], "there is no option -k"),
        (["--sumary", "m.xml"], "did you mean --summary?"),
        (["-t3", "m.xml"], "-t does not take '3'"),
        (["m.xml", "-f"], "-f needs a value"),
        (["-r", "x", "m.xml"], "-r takes a number"),
        (["m.xml", "q.q", "r.q"], "one model and one file of queries"),
        (["--query-index", "7", "m.xml"], "there is no query 7"),
        (["absent.xml"], "absent.xml"),
        (["--summary=1", "m.xml"], "takes no value"),
    ],
)
def test_wrong_command_lines(folder: Path, arguments: Sequence[str], message: str) -> None:
    result = verifyta(*arguments)
    assert message in result.err
    assert (result.status, result.out) == (2, "")


def test_help_has_the_form_that_scripts_look_for() -> None:
    result = verifyta("-h")
    assert "-h [ --help ]" in result.out
    assert result.status == 0


def test_console_script(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "argv", ["tachk-verifyta", "-q", "m.xml", "true.q"])
    with pytest.raises(SystemExit) as end:
        console_script()
    assert end.value.code == 0
    assert capsys.readouterr().out == "\nVerifying formula 1 at true.q:1\n -- Formula is satisfied.\n"


def test_format_verifyta_of_verify(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        app(["verify", "mixed.xml", "--format", "verifyta", "--trace", "shortest"], prog_name="tachk")
    assert end.value.code == 10
    said = capsys.readouterr()
    assert "Generating shortest trace" in said.out
    assert re.findall(r"Verifying formula (\d+) at .*\n -- Formula is (.*)", said.out) == [
        ("1", "satisfied."),
        ("3", "satisfied."),
        ("4", "NOT satisfied."),
    ]
    assert said.err.count("Transitions:") == 2


def test_a_search_order_is_no_file(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        app(["verify", "m.xml", "-o0"], prog_name="tachk")
    assert end.value.code == 2
    assert "-o 0 is a search order of UPPAAL" in capsys.readouterr().err
    assert not (folder / "0").exists()


def test_the_version_needs_no_model_checker() -> None:
    """A wrapper asks for it before every run."""
    code = (
        "import sys\nfrom tachk.cli.commands.verifyta import run\nsys.argv = ['tachk-verifyta', '-v']\n"
        "try:\n    run()\nexcept SystemExit:\n    pass\nassert 'tachk.api.model' not in sys.modules"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, check=False).returncode == 0


@pytest.mark.parametrize("seed", seeds(range(60)))
def test_no_command_line_is_a_defect(folder: Path, seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO(""))
    random = Random(seed)
    words = [
        "m.xml",
        "mixed.xml",
        "q.q",
        "false.q",
        "absent",
        "",
        "-",
        "-t",
        "0",
        "1",
        "9",
        "-y",
        "-u",
        "-q",
        "-f",
        "x",
    ]
    words += [
        "-X",
        "-o2",
        "-r",
        "-7",
        "-T",
        "-A",
        "-S3",
        "--seed",
        "--query-index=2",
        "--key",
        "--",
        "-uqy",
        "--s",
        "é",
    ]
    result = verifyta(*random.choices(words, k=random.randint(0, 7)))
    assert result.status in (0, 2, 3)
    assert "Traceback" not in result.err


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["-t1"], Options(SearchOrder.BFS, shortest=True)),
        (["-t2", "-o1"], Options(SearchOrder.DFS, pace=Pace.FASTEST)),
        (["-t0", "-o1"], Options(SearchOrder.DFS)),
        (["-o2", "-r", "-1"], Options(SearchOrder.RANDOM_DFS, 2**32 - 1)),
        (["-n1"], Options(SearchOrder.BFS, extrapolation=Extrapolation.NONE)),
        (["-n", "2"], Options(SearchOrder.BFS, extrapolation=Extrapolation.MAX)),
        ([], Options(SearchOrder.BFS)),
        (["-S0"], Options(SearchOrder.BFS)),
        (["-S", "2", "-t1"], Options(SearchOrder.BFS, shortest=True)),
        (["--statespace-consumption=1", "-S0"], Options(SearchOrder.BFS)),
    ],
)
def test_what_the_engine_is_asked(
    folder: Path, arguments: Sequence[str], expected: Options, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Options] = []
    real = tachk.cli.verifyta_answers.verify
    monkeypatch.setattr(
        tachk.cli.verifyta_answers, "verify", lambda n, q, how, **k: asked.append(how) or real(n, q, how, **k)
    )
    verifyta(*arguments, "m.xml", "true.q")
    assert asked == [expected]
