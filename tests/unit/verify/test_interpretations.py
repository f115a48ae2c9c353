"""Channel priorities without `default`: the answer where all its places agree, else a remark on the one taken."""

from __future__ import annotations

import pytest

import tachk
from tachk.api import model as api
from tachk.base.span import Source
from tachk.formats.catalogue import export_model
from tachk.formats.loading.load import load_model
from tachk.frontend.loaded import other_interpretations_of
from tachk.report.verifyta_report import run_to_verifyta

MODEL = """\
chan a, b;
int n;
chan priority a < b;
process P() {
    init location s { to t { sync a!; } to u { assign n = 1; } to v { sync b!; } }
    location t; location u; location v;
}
process Q() { init location s { to s { sync a?; } to s { sync b?; } } }
system P, Q;
property low : E<> P.t;
property inside : E<> P.u;
property high : E<> P.v;
"""
PLACES = ("default < a < b", "a, default < b", "a < default < b", "a < b, default", "a < b < default")


def model(priorities: str = "a < b") -> api.Model:
    return api.Model(load_model(Source("m.ta", MODEL.replace("a < b", priorities))), "m.ta")


def test_the_readings_are_the_places_that_default_can_have() -> None:
    for queries in ((), ("E<> P.u && n == 1",)):
        answers = [[v.answer for v in model(place).verify(*queries)] for place in PLACES]
        found = list(model().verify(*queries))
        assert [v.answer for v in found] == answers[0]
        for at, verdict in enumerate(found):
            assert bool(verdict.assumption) == (len({a[at].value for a in answers}) > 1)
    readings = [(place, loaded.network) for place, loaded in other_interpretations_of(model().loaded)]
    assert [place for place, _ in readings] == [
        "as high as a",
        "between a and b",
        "as high as b",
        "above all others",
    ]
    for (_, network), written in zip(readings, PLACES[1:], strict=True):
        assert [v.priorities for v in network.variables] == [v.priorities for v in model(written).network.variables]
        assert network.default_priority == model(written).network.default_priority


def test_what_is_said() -> None:
    report = model().verify()
    assert [d.code for d in model().warnings] == ["W0409"]
    assert report["low"].assumption == ""
    assert report["inside"].assumption == (
        "`default` is taken to be below all others; it holds if it is as high as b or above all others"
    )
    assert f"inside: {report['inside'].assumption}" in report.to_text()
    results = report.to_dict()["results"]
    assert isinstance(results, list)
    assert [bool(result["assumption"]) for result in results] == [False, True, True]  # type: ignore[call-overload,index]
    assert f" -- tachk: {report['high'].assumption}\n" in run_to_verifyta(report.record)


@pytest.mark.parametrize("priorities", PLACES)
def test_nothing_is_said_where_the_model_says_it(priorities: str) -> None:
    told = model(priorities)
    assert not told.warnings
    assert not any(verdict.assumption for verdict in told.verify())


def test_an_answer_that_a_limit_keeps_from_being_confirmed_rests_on_its_reading() -> None:
    text = MODEL.replace("property low : E<> P.t;\nproperty inside : E<> P.u;\n", "")
    found = api.Model(load_model(Source("m.ta", text)), "m.ta").verify(
        options=tachk.Options().off("pruning"), limits=tachk.Limits(depth=1)
    )
    assert found["high"].answer is tachk.Answer.HOLDS
    assert "it is unknown if it is" in found["high"].assumption


def test_the_declaration_is_written_as_it_was_read() -> None:
    assert "chan priority a < b;" in export_model(model().loaded, "xta").text
