from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

from tachk.report.json_report import run_to_json
from tachk.report.record import RunRecord

SCHEMA = json.loads((Path(__file__).parents[3] / "docs/schema/verify.schema.json").read_text(encoding="utf-8"))


def round_trip(record: RunRecord) -> dict:
    return json.loads(json.dumps(run_to_json(record)))


def test_output_follows_the_schema(record: RunRecord) -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    jsonschema.validate(round_trip(record), SCHEMA)
    jsonschema.validate([round_trip(record), round_trip(record)], SCHEMA)


def test_schema_refuses_a_fourth_answer(record: RunRecord) -> None:
    output = round_trip(record)
    output["results"][0]["answer"] = "maybe"
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(output, SCHEMA)


def test_trace_names_everything_and_keeps_times_exact(record: RunRecord) -> None:
    start, step, rest = round_trip(record)["results"][0]["trace"]
    assert start == {
        "delay": None,
        "transition": None,
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
    assert rest["clocks"] == {"User.x": "17/6"}


def test_fault_has_its_place_and_the_path_with_values(record: RunRecord) -> None:
    fault = round_trip(record)["results"][3]["fault"]
    assert fault["kind"] == "range"
    assert fault["position"] == "lamp.ta:2:3"
    assert fault["text"] == "n = n + 1"
    assert [state["variables"]["n"] for state in fault["path"]] == [0, 3]
    assert fault["path"][-1]["clocks"] is None


def test_met_is_null_for_unknown(record: RunRecord) -> None:
    assert [r["met"] for r in round_trip(record)["results"]] == [False, True, None, None]
