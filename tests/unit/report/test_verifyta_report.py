"""The lines that scripts around verifyta look for."""

from __future__ import annotations

import re

from tachk import api
from tachk.diagnostics.span import Source
from tachk.engines.protocol import Limits
from tachk.frontend.load import load_model
from tachk.report.verifyta_report import run_to_verifyta

MODEL = """\
process P() { clock x; init location A { to B { guard x > 1; } } location B; }
system P;
property reach : E<> P.B;
property stay : A[] P.A;
property chance : Pr[<=10] (<> P.B);
"""


def report(limits: Limits | None = None) -> str:
    model = api.Model("m.ta", load_model(Source("m.ta", MODEL)))
    return run_to_verifyta(model.verify(limits=limits, trace=False).record)


def test_verdicts_and_figures() -> None:
    text = report()
    assert re.findall(r"^Verifying formula (\d+) at line (\d+)$", text, re.M) == [("1", "3"), ("2", "4")]
    assert re.findall(r"^ -- (Formula .*)$", text, re.M) == ["Formula is satisfied.", "Formula is NOT satisfied."]
    assert re.search(r"^ -- States explored : \d+ states$", text, re.M)
    assert re.search(r"^ -- CPU user time used : \d+ ms$", text, re.M)
    assert re.search(r"^ -- Resident memory used : \d+ KiB$", text, re.M)
    assert "-- tachk: chance is not checked: " in text


def test_a_limit_is_maybe() -> None:
    text = report(Limits(depth=0))
    assert " -- Formula is MAYBE satisfied.\n -- tachk: depth limit\n" in text
