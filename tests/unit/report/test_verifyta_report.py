"""The lines that scripts around verifyta look for."""

from __future__ import annotations

import re

import pytest

from tachk.api import model as api
from tachk.base.span import Source
from tachk.engine.options import Limits
from tachk.engine.outcome import Statistics
from tachk.formats.loading.load import load_model
from tachk.report.record import RunRecord
from tachk.report.run.verifyta_trace import concrete_trace, symbolic_trace
from tachk.report.verifyta_notes import peak_memory
from tachk.report.verifyta_report import note, run_to_verifyta, verdict_lines
from tachk.verify.verdict import Answer, Verdict

MODEL = """\
process P() { clock x; int n; init location A { to B { guard x > 1; assign n = 2, x = 0; } } location B; }
system P;
property reach : E<> P.B;
property chance : Pr[<=10] (<> P.B);
property later : E<> deadlock + 1 == 1;
property stay : A[] P.A;
"""


def record(text: str = MODEL, limits: Limits | None = None, trace: bool = False) -> RunRecord:
    return api.Model(load_model(Source("m.ta", text)), "m.ta").verify(limits=limits, trace=trace).record


def test_every_formula_counts_and_only_those_checked_have_a_verdict() -> None:
    text = run_to_verifyta(record())
    found = re.findall(r"^Verifying formula (\d+) at (.*)\n -- (.*)$", text, re.M)
    assert found == [
        ("1", "m.ta:3", "Formula is satisfied."),
        ("2", "m.ta:4", "Formula is satisfied."),
        ("3", "m.ta:5", "tachk: not checked: `deadlock` is not a number to compare or to count with"),
        ("4", "m.ta:6", "Formula is NOT satisfied."),
    ]
    assert text.count("satisfied") == 3


def test_figures() -> None:
    text = run_to_verifyta(record())
    assert len(re.findall(r"^ -- States explored : \d+ states$", text, re.M)) == 3
    assert len(re.findall(r"^ -- CPU user time used : \d+ ms$", text, re.M)) == 3
    virtual = {int(size) for size in re.findall(r"^ -- Virtual memory used : (\d+) KiB$", text, re.M)}
    resident = {int(size) for size in re.findall(r"^ -- Resident memory used : (\d+) KiB$", text, re.M)}
    known = peak_memory()
    assert known is not None
    assert max(virtual) <= known[0]
    assert 8000 < min(resident) <= max(resident) <= known[1], "the interpreter alone takes more"


def test_cpu_time_is_no_wall_clock_time(monkeypatch: pytest.MonkeyPatch) -> None:
    from tachk.engine import taking_turns, zone

    ticks = iter(0.25 * number for number in range(100))
    for module in (taking_turns, zone):
        monkeypatch.setattr(module, "user_seconds", lambda: next(ticks))
    assert " -- CPU user time used : 250 ms" in run_to_verifyta(record())


def test_a_limit_is_no_verdict() -> None:
    text = run_to_verifyta(record(limits=Limits(depth=0)))
    assert " -- tachk: no answer: depth limit\n" in text
    assert text.count("satisfied") == 1, "of the statistical query alone"


def test_what_an_over_approximation_finds_may_be() -> None:
    verdict = Verdict(record().verdicts[0].query, Answer.UNKNOWN, False, "stopwatches", Statistics())
    assert list(verdict_lines(verdict)) == [" -- Formula MAY be satisfied.", " -- tachk: stopwatches"]


def test_notes_hold_no_word_that_looks_like_a_verdict() -> None:
    assert note("UPPAAL answers\n may be satisfied") == " -- tachk: UPPAAL answers may be fulfilled"


def test_traces() -> None:
    found = record(trace=True)
    run = found.verdicts[0].trace
    assert run is not None
    assert concrete_trace(found.network, run) == (
        "\nState:\n( P.A )\nP.x=0 P.n=0\n\nDelay: 1.5\n\nState:\n( P.A )\nP.x=1.5 P.n=0\n"
        "\nTransitions:\n  P.A->P.B { x > 1, tau, n := 2, x := 0 }\n\nState:\n( P.B )\nP.x=0 P.n=2\n"
    )
    assert symbolic_trace(found.network, run) == (
        "\nState\n( P.A )\nP.n=0\n\nTransitions:\n  P.A->P.B { x > 1, tau, n := 2, x := 0 }\n\nState\n( P.B )\nP.n=2\n"
    )
    assert "Showing example trace.\n" in run_to_verifyta(found, "some")
    assert run_to_verifyta(found).count("Showing") == 0
