"""A lamp, its button and recordings of both."""

from __future__ import annotations

import gzip
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from click.testing import CliRunner

import tachk
from tachk.base.job import OutOfTimeError
from tachk.cli.main import app
from tachk.report.conformance.json import conformance_to_json
from tachk.report.conformance.text import conformance_to_text

ROOT = Path(__file__).parents[4]
MODEL = ROOT / "examples/dimmer/dimmer.ta"
SCHEMA = json.loads((ROOT / "docs/schema/conform.schema.json").read_text(encoding="utf-8"))


def accepted(tmp_path: Path, rows: str, **given: Any) -> bool | None:
    file = tmp_path / "events.csv"
    file.write_text(f"time,event,on,level\n{rows}", encoding="utf-8")
    return tachk.conform(MODEL, file, **given).accepted


def test_run_of_the_model(tmp_path: Path) -> None:
    found = tachk.conform(MODEL, ROOT / "examples/dimmer/pressed.csv")
    assert found.accepted
    assert found.runs[0].moments is not None
    assert len(found.runs[0].path) == 5
    assert len(found.runs[0].moments.ticks) == 6


def test_files_of_events_are_read_as_logs_are(tmp_path: Path) -> None:
    """Compressed, with other separators, and with the line that tells a spreadsheet its separator."""
    text = (ROOT / "examples/dimmer/pressed.csv").read_text(encoding="utf-8")
    forms = {
        "a.csv.gz": gzip.compress(text.encode()),
        "b.tsv": text.replace(",", "\t").encode(),
        "c.csv": f'"sep=;"\n{text}'.replace(",", ";").encode(),
        "d.jsonl.gz": gzip.compress(
            b'{"time": 2, "event": "press"}\n{"time": 6, "event": "light", "on": 1, "level": 7}\n'
        ),
        "e.events": text.encode(),
    }
    for name, content in forms.items():
        file = tmp_path / name
        file.write_bytes(content)
        assert tachk.conform(MODEL, file).accepted, name


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("cut.csv.gz", "is cut off"),
        ("a.parquet", "events are read from CSV"),
        ("a.pcap.gz", "events are read from CSV"),
    ],
)
def test_files_of_events_that_cannot_be_read(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / name).write_bytes(gzip.compress((ROOT / "examples/dimmer/pressed.csv").read_bytes())[:70])
    with pytest.raises(tachk.UsageError, match=message):
        tachk.conform(MODEL, tmp_path / name)


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ("2,press,,\n6,light,1,7\n", True),
        ("2,press,,\n6,light,1,8\n", False),  # another content
        ("2,press,,\n6,light,1,\n", True),  # an empty cell is not compared
        ("2,press,,\n6,light,0,0\n", False),  # another channel of the array
        ("6,light,1,7\n", False),  # without a cause
        ("2,press,,\n20,other,,\n", False),  # silence where there must be none
        ("2,press,,\n7,other,,\n", True),  # it may still come
        ("2,press,,\n9,light,1,7\n", True),  # pressed at 3 at the latest, on at 8 at the earliest
        ("2,press,,\n10,light,1,7\n", False),
    ],
)
def test_small_recordings(tmp_path: Path, rows: str, expected: bool) -> None:
    assert accepted(tmp_path, rows) is expected


def test_lateness_is_of_what_is_recorded(tmp_path: Path) -> None:
    """The lamp is not seen before it goes on, the button may take effect later than it was recorded."""
    assert accepted(tmp_path, "2,press,,\n4,light,1,7\n", tolerance="0", late="3") is False
    assert accepted(tmp_path, "2,press,,\n10,light,1,7\n", tolerance="0", late="3") is True
    assert accepted(tmp_path, "2,press,,\n14,light,1,7\n", tolerance="0", late="3") is False


def test_latenesses_apart(tmp_path: Path) -> None:
    """The lamp goes on 3 to 5 after the press, which came to it later than recorded, or was itself seen later."""
    for light, input_late, output_late in ((10, 3, 0), (10, 0, 3), (10, 2, 1), (5, 0, 0)):
        late = {"input": str(input_late), "output": str(output_late)}
        assert accepted(tmp_path, f"2,press,,\n{light},light,1,7\n", tolerance="0", late=late) is True
    for light, input_late, output_late in ((10, 2, 0), (10, 0, 2), (10, 1, 1), (4, 3, 3)):
        late = {"input": str(input_late), "output": str(output_late)}
        assert accepted(tmp_path, f"2,press,,\n{light},light,1,7\n", tolerance="0", late=late) is False


def test_a_lateness_alone_leaves_the_other_as_it_is(tmp_path: Path) -> None:
    model = tmp_path / "dimmer.ta"
    text = MODEL.read_text(encoding="utf-8")
    for said, late, expected in (
        ("late 4 ms;", {"input": "1ms"}, (1, 4)),
        ("late 4 ms;", {"output": "1ms"}, (4, 1)),
        ("late output 4 ms;", None, (2, 4)),
        ("late input 4 ms; late output 5 ms;", {"output": "0.5ms"}, (4, Fraction(1, 2))),
        ("late input 4 ms;", "3ms", (3, 3)),
        ("late input 4 ms;", {}, (4, 2)),
    ):
        model.write_text(text.replace("tolerance 1 ms;", f"{said} tolerance 2 ms;"), encoding="utf-8")
        found = tachk.conform(model, ROOT / "examples/dimmer/pressed.csv", late=late)
        assert (found.uncertainty.input_late, found.uncertainty.output_late) == expected
        assert (found.tolerance, found.late) == (2, max(expected))


def test_a_lateness_that_is_given_stays_while_the_tolerance_is_found() -> None:
    found = tachk.conform(MODEL, ROOT / "examples/dimmer/too_soon.csv", tolerance="auto", late={"input": "0ms"})
    assert found.accepted
    assert (found.uncertainty.input_late, found.uncertainty.output_late) == (0, found.tolerance)


@pytest.mark.parametrize("late", [{"in": "1ms"}, {"input": 3}, {"output": "soon"}, {"": "1ms"}, 3])
def test_a_wrong_lateness_is_an_error(late: Any) -> None:
    with pytest.raises(tachk.UsageError):
        tachk.conform(MODEL, ROOT / "examples/dimmer/pressed.csv", late=late)


def test_latenesses_of_the_command_line() -> None:
    """One that is about inputs or outputs is about no others; none is given twice."""
    for given, expected in (
        (["20ms"], "late 20 ms"),
        (["input=1ms"], "late 1 ms"),
        (["input=2ms"], "late input 2 ms, late output 1 ms"),
        (["output=4ms", "input = 2ms"], "late input 2 ms, late output 4 ms"),
        (["20ms", "input = 0ms"], ""),
        (["output=3ms", "input=2ms", "output=4ms"], ""),
        (["output=3ms", "2ms"], ""),
    ):
        options = [text for each in given for text in ("--late", each)]
        recording = str(ROOT / "examples/dimmer/pressed.csv")
        result = CliRunner().invoke(app, ["conform", str(MODEL), recording, *options])
        if expected:
            assert result.exit_code == 0
            assert f"with tolerance 1 ms, {expected}\n" in result.output
        else:
            assert result.exit_code == 2 and "twice" in result.output


def test_least_tolerance(tmp_path: Path) -> None:
    rows = "2,press,,\n6,light,1,7\n40,light,0,0\n"
    least = tachk.conform(MODEL, _written(tmp_path, rows), tolerance="auto").tolerance
    assert accepted(tmp_path, rows, tolerance=str(least))
    assert not accepted(tmp_path, rows, tolerance=str(least - 1))


def _written(tmp_path: Path, rows: str) -> Path:
    file = tmp_path / "events.csv"
    file.write_text(f"time,event,on,level\n{rows}", encoding="utf-8")
    return file


def test_what_the_model_allows() -> None:
    found = tachk.conform(MODEL, ROOT / "examples/dimmer/too_soon.csv")
    assert found.accepted is False
    assert found.refusal is not None
    assert found.recording.events[found.refusal.event or 0].place == "line 4"
    assert [
        (enabled_event.cells, enabled_event.earliest, enabled_event.latest)
        for enabled_event in found.refusal.enabled_events
    ] == [((("on", 0), ("level", 0)), 55, 108)]


def test_offers_have_the_words_of_the_recording(tmp_path: Path) -> None:
    """What a row calls a value by the name of a constant is called so where the model would have had it."""
    model = tmp_path / "dimmer.ta"
    model.write_text(MODEL.read_text(encoding="utf-8") + "const int GOES_ON = 1;\n", encoding="utf-8")
    file = _written(tmp_path, "2,press,,\n6,light,GOES_ON,7\n60,light,0,0\n61,press,,\n90,light,GOES_ON,7\n")
    found = tachk.conform(model, file)
    assert found.accepted is False
    assert "the model allows light(on=GOES_ON, level=7)" in conformance_to_text(found, "dimmer.ta")


def test_smallest_edit(tmp_path: Path) -> None:
    """Without the second press nothing explains that the lamp stays on."""
    found = tachk.conform(MODEL, _written(tmp_path, "2,press,,\n6,light,1,7\n6,light,1,7\n60,light,0,0\n"))
    assert found.accepted is False
    assert found.edit is not None
    assert found.edit.what == "lost"
    assert found.recording.events[found.edit.event].place in ("line 3", "line 4")


@pytest.mark.parametrize(
    ("rows", "edit"),
    [
        ("2,press,,\n6,light,1,8\n20,other,,\n", "line 3 had been light(on=1, level=7)"),
        ("2,press,,\n14,light,1,7\n20,other,,\n", "line 3, light(on=1, level=7), had come 6 ms earlier"),
    ],
)
def test_other_edits(tmp_path: Path, rows: str, edit: str) -> None:
    found = tachk.conform(MODEL, _written(tmp_path, rows))
    assert f"it would be a run if {edit}" in conformance_to_text(found, "dimmer.ta")
    jsonschema.validate(conformance_to_json([found], "dimmer.ta"), SCHEMA)


def test_coverage() -> None:
    arguments = ["conform", str(MODEL), str(ROOT / "examples/dimmer/pressed.csv"), "--coverage", "--format", "json"]
    report = json.loads(CliRunner().invoke(app, arguments).stdout)
    jsonschema.validate(report, SCHEMA)
    assert [edge["times"] for edge in report["coverage"]] == [2, 2, 1]


def test_several_recordings() -> None:
    """Each is held against the model; edges are counted in those that are runs."""
    files = [str(ROOT / "examples/dimmer" / name) for name in ("pressed.csv", "too_soon.csv", "pressed.csv")]
    found = CliRunner().invoke(app, ["conform", str(MODEL), *files, "--coverage", "--format", "json"])
    report = json.loads(found.stdout)
    jsonschema.validate(report, SCHEMA)
    assert found.exit_code == 10
    assert [(each["recording"], each["accepted"]) for each in report["answers"]] == [
        *zip(files, (True, False, True), strict=True)
    ]
    assert [edge["times"] for edge in report["coverage"]] == [4, 4, 2]


@pytest.mark.parametrize(
    ("files", "status"), [(("pressed.csv", "pressed.csv"), 20), (("too_soon.csv", "pressed.csv"), 10)]
)
def test_exit_status_of_several_recordings(files: tuple[str, ...], status: int) -> None:
    """One that is not a run weighs more than one that is not decided."""
    limit = ["--max-states", "4"]
    found = CliRunner().invoke(
        app, ["conform", str(MODEL), *(str(ROOT / "examples/dimmer" / f) for f in files), *limit]
    )
    assert found.exit_code == status


def test_order_of_what_was_sent_and_what_arrives(tmp_path: Path) -> None:
    """A press may not happen before the light of the row that it names."""
    rows = ["0,press,,,,", "4,light,1,7,a,", "60,light,0,0,b,", "60,press,,,,b", "63,light,1,7,,"]
    file = tmp_path / "events.csv"
    file.write_text("time,event,on,level,id,after\n" + "\n".join(rows), encoding="utf-8")
    found = tachk.conform(MODEL, file)
    assert found.accepted
    assert found.runs[0].moments is not None
    assert len(found.runs[0].path) == 5


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("2,light,3,7\n", "line 2: on = 3 is outside"),
        ("2,light,on,7\n", "`on`, which is neither"),
        ("2,press\n", "2 cells"),
        ("2,light,1,2147483648\n", "line 2: level is 2147483648, which no model can say"),
        ("2,light,1,-2147483649\n", "line 2: level is -2147483649, which"),
        (f"2,press,,\n3,light,1,{10**25}\n", "line 3: level is 1"),
        (f"3,light,1,0x{'f' * 5000}\n", r"line 2: level is 0xffffffffffffffffffffffffffff\.\.\., which no"),
        (f"3,light,1,{'9' * 5000}\n", r"line 2: level is `999999999999999999999999999999\.\.\.`, which is neither"),
        ("2,press,,\n2147483647,press,,\n", "line 3, may happen more than 2147483647 units"),
        ("1e999,press,,\n", "line 2, may happen more than"),
        ("1e999999999,press,,\n", "line 2: `1e999999999` is not a time"),
        ("x,press,,\n", "is not a time"),
        ("3,press,,\n2,press,,\n", "backwards"),
    ],
)
def test_wrong_files(tmp_path: Path, rows: str, message: str) -> None:
    with pytest.raises(tachk.UsageError, match=message):
        accepted(tmp_path, rows)


@pytest.mark.parametrize(
    ("level", "message"),
    [
        ("2147483648", "line 2: level is 2147483648, which no model can say"),
        ("99999999999999999999", "line 2: level is 99999999999999999999, which no model can say"),
        ("9" * 5000, "line 2: this has a number of too many digits"),
        ("[" * 100_000, "line 2: this"),
    ],
)
def test_numbers_beyond_all_models_in_json_lines(tmp_path: Path, level: str, message: str) -> None:
    file = tmp_path / "events.jsonl"
    file.write_text(f'{{"time": 2, "event": "press"}}\n{{"time": 6, "event": "light", "on": 1, "level": {level}}}\n')
    with pytest.raises(tachk.UsageError, match=message):
        tachk.conform(MODEL, file)


@pytest.mark.parametrize("number", [-(2**31), 2**31 - 1])
def test_the_largest_numbers_are_events_that_the_model_does_not_do(tmp_path: Path, number: int) -> None:
    assert accepted(tmp_path, f"2,press,,\n6,light,1,{number}\n") is False


def test_an_explanation_can_be_left_out() -> None:
    found = [tachk.conform(MODEL, ROOT / "examples/dimmer/too_soon.csv", explain=each) for each in ("none", "full")]
    assert [each.accepted for each in found] == [False, False]
    assert found[0].refusal is None and found[0].edit is None
    assert found[1].refusal is not None and found[1].edit is not None
    assert len(conformance_to_text(found[0], "dimmer.ta").splitlines()) == 3
    with pytest.raises(tachk.UsageError, match="not a kind of explanation"):
        tachk.conform(MODEL, ROOT / "examples/dimmer/too_soon.csv", explain="long")


def test_limit(tmp_path: Path) -> None:
    found = CliRunner().invoke(
        app, ["conform", str(MODEL), str(ROOT / "examples/dimmer/pressed.csv"), "--max-states", "2"]
    )
    assert found.exit_code == 20


@pytest.mark.parametrize(("file", "status"), [("pressed.csv", 0), ("too_soon.csv", 10)])
def test_json(file: str, status: int) -> None:
    arguments = ["conform", str(MODEL), str(ROOT / "examples/dimmer" / file), "--format", "json"]
    found = CliRunner().invoke(app, arguments)
    assert found.exit_code == status
    jsonschema.validate(json.loads(found.stdout), SCHEMA)


def test_json_lines(tmp_path: Path) -> None:
    file = tmp_path / "events.jsonl"
    file.write_text('{"time": 2, "event": "press"}\n{"time": 6, "event": "light", "on": true, "level": 7}\n')
    assert tachk.conform(MODEL, file).accepted


def test_formatter_keeps_the_block() -> None:
    assert CliRunner().invoke(app, ["fmt", "--check", str(MODEL)]).exit_code == 0


def test_what_is_outside_need_not_be_ready(tmp_path: Path) -> None:
    model = tachk.loads(
        "urgent chan press; process P { init location A { to B { sync press?; } } location B; } system P;"
        "recording { visible press as press(); }"
    )
    file = tmp_path / "press.csv"
    file.write_text("time,event\n10,press\n", encoding="utf-8")
    assert tachk.conform(model, file).accepted


@pytest.mark.parametrize(
    ("name", "left_out"),
    [
        ("tachk.recordings.conformance.conform._earliest", "where the recording leaves the model"),
        (
            "tachk.recordings.conformance.conform_file.smallest_edit",
            "whether an edit of the recording would make it a run",
        ),
    ],
)
def test_time_is_over_before_it_is_explained(monkeypatch: pytest.MonkeyPatch, name: str, left_out: str) -> None:
    def out_of_time(*_: object) -> None:
        raise OutOfTimeError

    monkeypatch.setattr(name, out_of_time)
    found = tachk.conform(MODEL, ROOT / "examples/dimmer/too_soon.csv")
    assert found.accepted is False
    text = conformance_to_text(found, "dimmer.ta")
    assert "not a run of the model" in text
    assert f"the time limit was over before it was known {left_out}" in text
    jsonschema.validate(conformance_to_json([found], "dimmer.ta"), SCHEMA)
