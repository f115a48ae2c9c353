"""Answers to statistical queries in verifyta's forms, read as public programs read them.

Each reader has the expressions of the program in its name. The probabilities are known: x is uniform on 0 to 5 when
the process leaves s, so that it has left by T with probability T / 5.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import chdir, redirect_stderr, redirect_stdout
from pathlib import Path

import pytest

from tachk.cli.main import app

MODEL = """\
clock x; int[0, 9] phase = 0;
process A() { init location s { invariant x <= 5; to t { assign phase = 4; } } location t; }
system A;
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path) -> Iterator[Path]:
    (tmp_path / "m.ta").write_text(MODEL)
    with chdir(tmp_path):
        yield tmp_path


def verifyta(query: str, *options: str, status: int = 0) -> str:
    Path("q.q").write_text(query + "\n")
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err), pytest.raises(SystemExit) as end:
        app(["verifyta", *options, "m.ta", "q.q"], prog_name="tachk")
    assert int(end.value.code or 0) == status, err.getvalue()
    assert bool(err.getvalue()) == bool(status), "programs take anything on standard error for a failure"
    return out.getvalue()


@pytest.fixture
def newer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TACHK_VERIFYTA_FORM", "5.0")


# ---- 4.1 ------------------------------------------------------------------------------------------------------------


def test_a_warehouse_study() -> None:
    """`verifyta -C -S 0 -H 32 -E 0.05 -u -s -q`: the end of the interval behind the operator."""
    out = verifyta("Pr[<=2](<> A.t)", "-C", "-S", "0", "-H", "32", "-E", "0.02")
    low, high = map(float, re.search(r"Pr\((?:<>|\[\]) \.\.\.\) in \[([\d.e-]+),([\d.e-]+)\]", out).groups())  # type: ignore[union-attr]
    assert low <= 0.4 <= high
    assert high - low <= 0.04


def test_a_stochastic_script() -> None:
    pattern = (
        r"Verifying formula (\d+)(?:.*?)Formula is(.*?)satisfied.*?Pr\(([^)]+)\) in \[([\d.]+),([\d.]+)\].*?"
        r"with confidence ([\d.]+)"
    )
    out = verifyta("Pr[<=2]([] A.s)\nPr[<=1](<> A.t)", "-a", "0.01", "-E", "0.1")
    found = re.findall(pattern, out, re.S)
    assert [(number, said, path) for number, said, path, *_ in found] == [
        ("1", " ", "[] ..."),
        ("2", " ", "<> ..."),
    ]
    assert [confidence.rstrip(".") for *_, confidence in found] == ["0.99", "0.99"]
    assert float(found[0][3]) <= 0.6 <= float(found[0][4])


def test_expected_values_of_a_java_wrapper() -> None:
    """Lines 1 and 2 behind the verdict, word by word."""
    lines = verifyta("E[<=10; 100](max: phase)", "-q").splitlines()
    at = lines.index(" -- Formula is satisfied.")
    runs, word, name, equals, mean = lines[at + 1].split()
    assert (runs, word, name, equals, mean) == ("(100", "runs)", "E(max)", "=", "4")
    assert re.fullmatch(r"Values in \[4,4\] mean=4 steps=1: 100", lines[at + 2])


def test_times_of_hits_are_counted() -> None:
    out = verifyta("Pr[<=10; 200](<> A.t)", "--histogram-bar-count", "10")
    low, high, mean, step, counts = re.search(
        r"Values in \[(.+),(.+)\] mean=(.+) steps=(.+): ([\d ]+)$", out, re.M
    ).groups()  # type: ignore[union-attr]
    assert 0 <= float(low) < float(mean) < float(high) <= 5
    assert float(step) == pytest.approx((float(high) - float(low)) / 10, rel=1e-4)
    assert len(counts.split()) == 10
    assert sum(map(int, counts.split())) == 200


def test_bars_of_a_width() -> None:
    out = verifyta("Pr[<=10; 200](<> A.t)", "-w", "1")
    assert re.search(r"steps=1: (\d+ ){4}\d+$", out, re.M)


def test_stratego_utilities() -> None:
    """The points of a name, all whole numbers; standard error must be empty."""
    out = verifyta("simulate [<=8; 2] { phase, x }", "-r", "7")
    points = re.search(r"phase:\n\[0\]:( \([\d.]+,[\d.]+\))*", out)
    assert points is not None
    times = [tuple(map(float, pair)) for pair in re.findall(r"\(([\d.]+),([\d.]+)\)", points[0])]
    assert times[0] == (0, 0)
    assert times[-1] == (8, 4)
    assert re.search(r"\nx:\n\[0\]: \(0,0\).*\n\[1\]: \(0,0\)", out)


def test_plasma_lab() -> None:
    """A line behind the verdict tells a test from an estimate."""

    def is_test(out: str) -> bool:
        lines = out.splitlines()
        line = lines[next(n for n, text in enumerate(lines) if "Formula is" in text) + 1]
        return "runs) H" in line or "runs) Pr(..)/Pr(..)" in line

    assert is_test(verifyta("Pr[<=4](<> A.t) >= 0.5"))
    assert is_test(verifyta("Pr[<=4](<> A.t) >= Pr[<=1](<> A.t)"))
    assert not is_test(verifyta("Pr[<=4](<> A.t)"))


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("Pr[<=4](<> A.t) >= 0.5", "satisfied.\n([0-9]+ runs) H0: Pr(<> ...) >= 0.5\nwith confidence 0.95.\n"),
        ("Pr[<=1](<> A.t) >= 0.5", "NOT satisfied.\n([0-9]+ runs) H1: Pr(<> ...) <= 0.5\nwith confidence 0.95.\n"),
        ("Pr[<=1](<> A.t) <= 0.5", "satisfied.\n([0-9]+ runs) H0: Pr(<> ...) <= 0.5\nwith confidence 0.95.\n"),
        ("Pr[<=1](<> A.t) >= Pr[<=4](<> A.t)", "NOT satisfied.\n([0-9]+ runs) Pr(..)/Pr(..) <= 1\n"),
    ],
)
def test_tests(query: str, said: str) -> None:
    pattern = re.escape(f" -- Formula is {said}").replace(re.escape("([0-9]+ runs)"), r"\(\d+ runs\)")
    assert re.search(pattern, verifyta(query))


def test_options_of_a_makefile() -> None:
    out = verifyta("Pr[<=2](<> A.t)", "--alpha", "0.03", "--beta", "0.03", "--epsilon", "0.03", "--seed=11")
    assert "Seed is 11" in out
    assert "with confidence 0.97." in out
    assert out == verifyta("Pr[<=2](<> A.t)", "-a0.03", "-B0.03", "-E0.03", "-r11")
    assert out != verifyta("Pr[<=2](<> A.t)", "-a0.03", "-B0.03", "-E0.03", "-r12")


def test_narrow_tests_take_more_runs() -> None:
    query = "Pr[<=4](<> A.t) >= 0.6"
    few, many = (int(re.search(r"\((\d+) runs\)", verifyta(query, *more))[1]) for more in ((), ("--delta-l", "0.001")))  # type: ignore[index]
    assert few < many


def test_no_decision_is_no_verdict() -> None:
    out = verifyta("Pr[<=2; 5](<> A.t) >= 0.4", status=20)
    assert "satisfied" not in out


def test_a_wrong_statistical_query_is_an_error() -> None:
    assert "satisfied" not in verifyta("Pr[<=2](<> A.nowhere)", status=2)
    assert "satisfied" not in verifyta("Pr[<=2](<> deadlock)", status=3)


# ---- 5.0 ------------------------------------------------------------------------------------------------------------

PROBABILITY = re.compile(
    r"\((?P<success>\d+)\/(?P<runs>\d+) runs\)\s+Pr\((?P<formula>.*?)\)\s+in\s+"
    r"\[(?P<low>[-+0-9.eE]+),(?P<high>[-+0-9.eE]+)\]\s+\((?P<ci_pct>[^)]+)\)",
)
EXPECTED = re.compile(
    r"\((?P<runs>\d+) runs\)\s+E\((?P<stat>.*?)\)\s*=\s*"
    r"(?P<value>[-+0-9.eE]+)\s+±\s+(?P<err>[-+0-9.eE]+)\s+\((?P<ci_pct>[^)]+)\)",
)


def test_an_audit_of_results(newer: None) -> None:
    found = PROBABILITY.search(verifyta("Pr[<=2](<> A.t)"))
    assert found is not None
    assert (found["formula"], found["ci_pct"]) == ("<> …", "95% CI")
    assert float(found["low"]) <= int(found["success"]) / int(found["runs"]) <= float(found["high"])
    found = EXPECTED.search(verifyta("E[<=2; 400](max: phase)"))
    assert found is not None
    assert (found["runs"], found["stat"], found["ci_pct"]) == ("400", "max", "95% CI")
    assert abs(float(found["value"]) - 1.6) <= 3 * float(found["err"])


def test_a_value_without_variance(newer: None) -> None:
    assert "(50 runs) E(min) = ≈ 0\n" in verifyta("E[<=2; 50](min: phase)")


def test_counts_of_the_complement(newer: None) -> None:
    hits, runs = re.search(r"-- Result: \((\d+)/(\d+) runs\) Pr\(\[\] …\) in", verifyta("Pr[<=1]([] A.s)")).groups()  # type: ignore[union-attr]
    assert int(hits) / int(runs) == pytest.approx(0.8, abs=0.1)


# ---- Stratego --------------------------------------------------------------------------------------------------------


def test_trees_of_strategies(monkeypatch: pytest.MonkeyPatch) -> None:
    """`verifyta --seed N -sWqy`: lines that begin with the number of runs, right behind the verdict."""
    monkeypatch.setenv("TACHK_VERIFYTA_FORM", "stratego")
    lines = verifyta("E[<=2; 400](max: phase)", "--seed", "7", "-sqy").split("\n")
    begin = next(number for number, line in enumerate(lines) if line.startswith("Verifying"))
    assert lines[begin + 1] == " -- Formula is satisfied."
    found = re.match(r"^\([\d]+ runs\) E\([\w]+\) = ([\d]+.[\d]+) ± ([\d]+.[\d]+)", lines[begin + 2])
    assert found is not None
    assert abs(float(found[1]) - 1.6) <= 3 * float(found[2])
    assert "\n(50 runs) E(min) = ≈ 0\n" in verifyta("E[<=2; 50](min: phase)")


def test_results_of_a_makefile(newer: None) -> None:
    """The number of the formula, where it stands, its result and the values, line by line."""
    out = verifyta("E[<=2; 400](max: phase)", "--alpha", "0.03", "--beta", "0.03", "--epsilon", "0.03")
    verdict = next(line for line in out.splitlines() if "E(" in line)
    assert re.search(r"^Verifying formula (\d+) at (.*?\.q:\d+)", out, re.M)
    assert re.search(r"\((\d+) runs\) E\(\w+\) = ([\d\.]+) ± ([\d\.e\-\+]+) \((\d+)% CI\)", verdict)
    assert re.search(r"Values in \[([0-9.]+),([0-9.]+)\].*?mean=([0-9.]+)", out)
    probability = next(line for line in verifyta("Pr[<=2](<> A.t)", "--alpha", "0.03").splitlines() if "Pr(" in line)
    found = re.search(r"\((\d+)/(\d+) runs\).*?\[([0-9.]+),([0-9.]+)\].*?(\d+)% CI", probability)
    assert found is not None
    assert found[5] == "97"


def test_data_points_of_an_experiment() -> None:
    """Each query's points behind a line that begins with a bracket and ends with a colon."""
    lines = [
        line.strip() for line in verifyta("simulate [<=10; 2] {(phase + 0.0) / 2}", "--seed", "428094").split("\n")
    ]
    assert sum(line.startswith("(") and line.endswith(":") for line in lines) == 1
    points = [re.findall(r"\(([^,]+),\s*([^)]+)\)", line.split(":", 1)[1]) for line in lines if line.startswith("[")]
    assert [[(float(first), float(last)) for first, last in run][-1] for run in points] == [(10, 2), (10, 2)]


def test_an_unknown_form(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TACHK_VERIFYTA_FORM", "6")
    assert verifyta("Pr[<=2](<> A.t)", status=2) == ""
