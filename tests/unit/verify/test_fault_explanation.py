"""Run-time errors are told as every other finding is: with a code, a place and a help line."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tachk.base.diagnostics.explanation import explanations
from tachk.base.diagnostics.render import render
from tachk.base.job import Job, under_way
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.meaning.discrete import prepare
from tachk.model.fault import RuntimeErrorKind
from tachk.model.run import RunTimeFault
from tachk.verify.fault_explanation import diagnostic_of, explain
from tachk.verify.verdict import Verdict
from tachk.verify.verify import verify

RUN_TIME_CODES = explanations("run_time_errors")


def first(text: str) -> Verdict:
    loaded = load_model(Source("m.ta", text))
    return verify(loaded.network, loaded.queries)[0]


def test_every_kind_has_a_code() -> None:
    kinds = list(RuntimeErrorKind)
    span = load_model(Source("m.ta", "process P() { init location a; }\nsystem P;")).document.span
    codes = [diagnostic_of(RunTimeFault(kind, span, (), None)).code for kind in kinds]
    assert sorted(codes) == list(RUN_TIME_CODES)


@pytest.mark.parametrize("code", [code for code in RUN_TIME_CODES if RUN_TIME_CODES[code].bad])
def test_the_example_of_a_code_meets_the_error_and_the_mended_one_does_not(code: str) -> None:
    explanation = RUN_TIME_CODES[code]
    fault = first(explanation.bad).fault
    assert fault is not None
    assert diagnostic_of(fault).code == code
    assert str(fault.span).startswith("m.ta:")
    assert first(explanation.good).fault is None


def test_a_loop_that_does_not_end_is_reported_at_its_edge() -> None:
    text = """int[0,1] n = 1;
int[0,3] m;
void wait() { while (n > 0) { } }
process P() {
    init location a { to b { assign m = m + 1; } }
    location b { to a { assign wait(); } }
}
system P;
property always : A[] P.a || P.b;"""
    fault = first(text).fault
    assert fault is not None
    assert (diagnostic_of(fault).code, fault.span.text) == ("E0768", "to a { assign wait(); }")


def test_a_run_time_error_is_rendered_like_a_mistake() -> None:
    fault = first(RUN_TIME_CODES["E0761"].bad).fault
    assert fault is not None
    assert render(diagnostic_of(fault)).splitlines() == [
        "m.ta:3:37: error[E0761]: run-time error: a value is outside its declared range: 4 is not in [0, 3]",
        "    3 |     init location a { to a { assign n = n + 1; } }",
        "      |                                     ^^^^^^^^^",
        "help: declare a wider range, or guard the edge so that this is not evaluated there",
    ]


def test_an_error_is_reported_without_its_times_where_there_is_no_time_left(monkeypatch: pytest.MonkeyPatch) -> None:
    text = """int[0,1] n = 0;
process P() { clock x; init location A { to B { guard x >= 3; } } location B { to B { assign n = n + 1; } } }
system P;
property p : A[] n < 2;"""
    model = prepare(load_model(Source("m.ta", text)).network)
    fault = first(text).fault
    assert fault is not None and fault.run is not None and fault.detail == "2 is not in [0, 1]"
    with under_way(Job(ends=0.0)):
        monkeypatch.setattr("tachk.verify.fault_explanation._LEAST_SECONDS", 0.0)
        hurried = explain(model, fault)
        assert explain(model, replace(fault, run=None, detail="")).run is None
    assert (hurried.kind, hurried.span, hurried.path) == (fault.kind, fault.span, fault.path)
    assert explain(model, replace(fault, run=None, detail="")).run is not None
