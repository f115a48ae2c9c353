from __future__ import annotations

import json
from pathlib import Path

import pytest

import tachk
from tachk.formats.written_reports import validator
from tachk.simulation.statistics.estimate import Estimated

MODELS = Path(__file__).parents[3] / "models"

LAMP = """
const int SOON = 5;
chan press;
process Lamp() {
    clock y;
    init location Off { to Low { sync press?; assign y = 0; } }
    location Low {
        to Bright { guard y < SOON; sync press?; }
        to Off { guard y >= SOON; sync press?; }
    }
    location Bright { to Off { sync press?; } }
}
process User() { init location Idle { to Idle { sync press!; } } }
system Lamp, User;
property bright : E<> Lamp.Bright expect holds;
property never_low : A[] not Lamp.Low expect fails;
property smc : Pr[<=10](<> Lamp.Bright);
"""


@pytest.fixture
def lamp(tmp_path: Path) -> Path:
    path = tmp_path / "lamp.ta"
    path.write_text(LAMP, encoding="utf-8")
    return path


def test_a_model_has_its_properties_and_constants(lamp: Path) -> None:
    model = tachk.load(lamp)
    assert [query.name for query in model.properties] == ["bright", "never_low"]
    assert model.constants == {"SOON": 5}
    assert [process.name for process in model.network.processes] == ["Lamp", "User"]


def test_verify_checks_all_properties(lamp: Path) -> None:
    report = tachk.load(lamp).verify()
    assert [verdict.answer for verdict in report] == [tachk.Answer.HOLDS, tachk.Answer.FAILS]
    assert report.met is True
    smc = report.estimates["smc"]
    assert smc.met
    assert isinstance(smc.found, Estimated)
    assert [row["property"] for row in report.to_rows()] == ["bright", "never_low", "smc"]
    with pytest.raises(KeyError, match=r"report.estimates\['smc'\] is its answer"):
        report["smc"]


def test_constants_are_keyword_arguments(lamp: Path) -> None:
    report = tachk.load(lamp, SOON=0).verify()
    assert report["bright"].answer is tachk.Answer.FAILS
    assert report.met is False
    assert tachk.load(lamp, SOON="2 + 1").constants == {"SOON": 3}


def test_queries_and_named_properties_are_checked_alone(lamp: Path, tmp_path: Path) -> None:
    file = tmp_path / "more.q"
    file.write_text("A[] not deadlock\n", encoding="utf-8")
    model = tachk.load(lamp)
    report = model.verify("E<> Lamp.Low", property="bright", query_files=[file])
    assert [(v.query.name, v.query.text) for v in report] == [
        ("bright", "E<> Lamp.Bright"),
        ("q1", "A[] not deadlock"),
        ("q2", "E<> Lamp.Low"),
    ]
    assert [v.query.name for v in model.verify(property=["never_low", "bright"])] == ["never_low", "bright"]


def test_every_wrong_query_is_reported(lamp: Path) -> None:
    with pytest.raises(tachk.InputError) as error:
        tachk.load(lamp).verify("E<> Lamp.Blue", "A[] nothing")
    assert len(error.value.diagnostics) == 2


def test_wrong_names_are_usage_errors(lamp: Path) -> None:
    with pytest.raises(tachk.UsageError):
        tachk.load(lamp).verify(property="brigth")
    with pytest.raises(tachk.UsageError):
        tachk.load(lamp, LATE=1)
    with pytest.raises(tachk.UsageError):
        tachk.load(lamp.with_name("gone.ta"))


def test_a_limit_is_an_answer(lamp: Path) -> None:
    verdict = tachk.load(lamp).verify("A[] true", limits=tachk.Limits(states=1))[0]
    assert verdict.answer is tachk.Answer.UNKNOWN
    assert verdict.reason == "state limit"


def test_progress_and_traces_are_optional(lamp: Path) -> None:
    verdict = tachk.load(lamp).verify(property="bright", trace=False)[0]
    assert verdict.trace is None
    assert verdict.answer is tachk.Answer.HOLDS


def test_report_is_a_sequence_with_names(lamp: Path) -> None:
    report = tachk.load(lamp).verify()
    assert len(report) == 2
    assert report[0] is report["bright"]
    assert report[-1:] == (report["never_low"],)
    with pytest.raises(KeyError, match="'other'; there are 'bright', 'never_low'"):
        report["other"]
    assert str(report.run(0)) == str(report.run("bright"))
    for wrong in (2, -3, "other"):
        with pytest.raises(tachk.UsageError, match=r"0: bright, 1: never_low"):
            report.run(wrong)


def test_what_a_shell_shows_is_short(lamp: Path) -> None:
    report = tachk.load(lamp).verify()
    assert repr(report) == f"<Report on {lamp}: bright: holds, never_low: fails, smc: 0.9097 to 0.9995>"
    assert repr(report["bright"]) == "<Verdict bright: holds, E<> Lamp.Bright>"
    judged = tachk.monitor("G a", {"time": [0, 1], "a": [1, 0]})
    assert repr(judged) == "<MonitorReport on the trace: p1: false>"
    assert repr(judged["p1"]) == "<MonitorVerdict p1: false, G a>"


def test_what_is_wrong_with_a_property_that_was_requested(lamp: Path) -> None:
    lamp.write_text(LAMP + "property open : F G (Lamp.Bright || F[0,2] Lamp.Bright);\n", encoding="utf-8")
    model = tachk.load(lamp)
    with pytest.raises(tachk.InputError, match="E0730"):
        model.verify(property="open")
    assert list(model.verify(property="smc").estimates) == ["smc"]
    with pytest.raises(tachk.UsageError, match=r"no property 'brigth' \(did you mean `bright`\?\)"):
        model.verify(property="brigth")


def test_queries_keep_their_numbers_beside_rejected_ones(lamp: Path, tmp_path: Path) -> None:
    queries = tmp_path / "some.q"
    queries.write_text("F G (Lamp.Bright || F[0,2] Lamp.Bright)\nE<> Lamp.Bright\n", encoding="utf-8")
    report = tachk.load(lamp).verify("F[0,3] Lamp.Low", "E<> Lamp.Low", query_files=[queries])
    assert [verdict.query.name for verdict in report] == ["q2", "q3", "q4"]
    assert [query.name for query in report.record.not_checked] == ["q1"]
    with pytest.raises(KeyError, match="q1 is not checked: to violate this, something temporal would have to be seen"):
        report["q1"]
    assert report.met is not True


def test_the_package_lists_its_names() -> None:
    assert {"load", "monitor", "Monitor"} <= set(dir(tachk))


def test_presentations(lamp: Path) -> None:
    report = tachk.load(lamp).verify()
    validator("verify").validate({"runs": [json.loads(json.dumps(report.to_dict()))]})
    assert "2 passed" in str(report)
    assert report._repr_html_().startswith("<table>")


def test_rows_make_a_data_frame(lamp: Path) -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(row for soon in (0, 5) for row in tachk.load(lamp, SOON=soon).verify().to_rows())
    assert frame[frame.property == "bright"][["SOON", "answer"]].values.tolist() == [[0, "fails"], [5, "holds"]]


def test_unknown_attribute_of_the_package() -> None:
    with pytest.raises(AttributeError, match="nothing"):
        _ = tachk.nothing


def test_models_with_other_constants_are_different() -> None:
    path = MODELS / "classics/fischer.ta"
    three, four = tachk.load(path, N=3), tachk.load(path, N=4)
    assert "const int N = 3" in tachk.diff(four, three)
    assert tachk.diff(path, four) == ""
    assert tachk.diff(str(path), three) == tachk.diff(four, three)


@pytest.mark.parametrize("limit", ["states", "seconds", "memory_bytes", "depth", "seconds_each"])
def test_a_limit_is_not_negative(limit: str) -> None:
    with pytest.raises(tachk.UsageError, match=limit):
        tachk.Limits(**{limit: -1})
