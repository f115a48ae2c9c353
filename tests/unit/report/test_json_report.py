from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import jsonschema
import pytest

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.report.json_report import run_to_json, runs_to_json
from tachk.report.record import NotChecked, NotRead, RunRecord

SCHEMA = json.loads((Path(__file__).parents[3] / "docs/schema/verify.schema.json").read_text(encoding="utf-8"))


def round_trip(record: RunRecord) -> dict:
    return json.loads(json.dumps(run_to_json(record)))


def test_output_follows_the_schema(record: RunRecord) -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    finding = Diagnostic("E0730", "it sets no deadline", record.network.processes[0].edges[0].spans[0])
    refused = replace(record, not_checked=(NotChecked("q2", "G p", finding.message, (finding,), "a title"),))
    unread = NotRead("broken.ta", finding.message, None, (finding,))
    output = json.loads(json.dumps(runs_to_json([record, refused, unread, NotRead("", "no model", "give one")])))
    jsonschema.validate(output, SCHEMA)
    assert [run["model"] for run in output["runs"]] == ["lamp.ta", "lamp.ta", "broken.ta", ""]
    (query,) = output["runs"][1]["not_checked"]
    assert (query["name"], query["title"], query["errors"][0]["code"]) == ("q2", "a title", "E0730")
    assert output["runs"][2]["errors"][0]["place"]["file"] == "lamp.ta"
    assert output["runs"][3]["errors"][0]["help"] == "give one"


def test_what_was_not_inspected_is_listed(record: RunRecord) -> None:
    first, *others = record.verdicts
    named = replace(record, verdicts=(replace(first, unexamined=("Link", "n")), *others))
    assert round_trip(record)["results"][0]["unexamined"] == []
    assert round_trip(named)["results"][0]["unexamined"] == ["Link", "n"]


def test_schema_rejects_a_fourth_answer(record: RunRecord) -> None:
    output = round_trip(record)
    output["results"][0]["answer"] = "maybe"
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"runs": [output]}, SCHEMA)


def test_trace_names_everything_and_keeps_times_exact(record: RunRecord) -> None:
    start, step, rest = round_trip(record)["results"][0]["trace"]
    assert start == {
        "time": "0",
        "locations": {"User": "idle", "Lamp": "off"},
        "variables": {"n": 0, "lit": False},
        "clocks": {"User.x": "0"},
    }
    assert step["delay"] == step["time"] == "5/2"
    assert step["transition"]["channel"] == "press[1]"
    assert [p["role"] for p in step["transition"]["participants"]] == ["sends", "receives"]
    assert step["transition"]["participants"][0]["select"] == {"b": 1}
    assert step["transition"]["participants"][0]["positions"] == ["lamp.ta:2:3"]
    assert step["variables"] == {"n": 3, "lit": True}
    assert rest["transition"] is None
    assert rest["delay"] == "1/3"
    assert "clocks" not in rest, "it shows its value of before plus the delay"


def test_fault_has_its_place_and_the_path_with_values(record: RunRecord) -> None:
    fault = round_trip(record)["results"][3]["fault"]
    assert fault["kind"] == "range"
    assert fault["position"] == "lamp.ta:2:3"
    assert fault["text"] == "n = n + 1"
    assert [state["variables"]["n"] for state in fault["path"]] == [0, 3]
    assert fault["path"][0]["clocks"] is None


def test_met_is_null_for_unknown(record: RunRecord) -> None:
    assert [r["met"] for r in round_trip(record)["results"]] == [False, True, None, None]
