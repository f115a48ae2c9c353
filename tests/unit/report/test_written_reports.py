"""Reports read again: whatever is wrong with one is told with its place, and nothing is a defect."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random
from typing import Any

import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.exit_status import ExitStatus
from tachk.cli.main import app
from tachk.formats.written_reports import check_report, read_json
from tachk.report.json_report import runs_to_json
from tests.fuzz.reports import damaged

ROOT = Path(__file__).parents[3]
MODEL = """
    time_unit = 10 ms;
    int[0,1] d; chan c; clock x;
    process P() {
        init location A { invariant x <= 5; to B { guard x >= 1; sync c!; assign d = 1; } }
        location B { to A { assign x = 0; } }
    }
    process Q() { init location I { to Asleep { sync c?; } } location Asleep { to I; } }
    system P, Q;
    property reached : E<> P.B;
    property wrong : A[] 1 / d == 1;
    property met : A<> Q.Asleep;
    property most : bounds{P.A}: x;
    property formula : G (P.A -> F[0,3] P.B);
    property likely : Pr[<=20] (<> P.B);
"""


@pytest.fixture(scope="module")
def written() -> dict[str, Any]:
    report: dict[str, Any] = json.loads(json.dumps(runs_to_json([tachk.loads(MODEL).verify().record], False)))
    return report


def invoked(command: str, document: object, folder: Path) -> tuple[int, str]:
    path, output = folder / "report.json", folder / ("page.html" if command == "report" else "chart.svg")
    path.write_text(json.dumps(document), encoding="utf-8")
    done = CliRunner().invoke(app, [command, str(path), "-o", str(output)])
    return done.exit_code, done.output


def test_what_is_written_can_be_read(written: dict[str, Any], tmp_path: Path) -> None:
    assert invoked("chart", written, tmp_path)[0] == ExitStatus.AS_EXPECTED
    assert invoked("report", written, tmp_path)[0] in (ExitStatus.NOT_AS_EXPECTED, ExitStatus.UNKNOWN)


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        (("results", 0, "trace", 1, "transition"), 5, "$.runs[0].results[0].trace[1].transition"),
        (("results", 0, "trace", 0, "variables"), None, "$.runs[0].results[0].trace[0].variables"),
        (("results", 0, "stats", "peak_bytes"), "x", "$.runs[0].results[0].stats.peak_bytes"),
        (("results", 0, "answer"), "perhaps", "$.runs[0].results[0].answer"),
        (("results", 0, "trace", 1, "time"), "1/0", "$.runs[0].results[0].trace[1].time"),
        (("time_unit",), "7/2", "$.runs[0].time_unit"),
        (("results", 0, "stats", "states_stored"), 10**400, "too large"),
        (("results", 0, "stats", "seconds"), float("inf"), "not a number of JSON"),
        (("results", 0, "title"), "\ud800", "surrogates"),
        (("estimates", 0, "found", "high"), "x", "$.runs[0].estimates[0].found"),
    ],
)
@pytest.mark.parametrize("command", ["report", "chart"])
def test_the_place_is_named(
    command: str, place: tuple[Any, ...], value: object, said: str, written: dict[str, Any], tmp_path: Path
) -> None:
    document = json.loads(json.dumps(written))
    inner = document["runs"][0]
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    status, output = invoked(command, document, tmp_path)
    assert status == ExitStatus.BAD_INPUT
    assert said in output


@pytest.mark.parametrize("name", ["answer", "title", "trace", "stats", "notes", "assumption", "met"])
def test_what_is_missing_is_named(name: str, written: dict[str, Any], tmp_path: Path) -> None:
    document = json.loads(json.dumps(written))
    del document["runs"][0]["results"][0][name]
    for command in ("report", "chart"):
        status, output = invoked(command, document, tmp_path)
        assert status == ExitStatus.BAD_INPUT
        assert f"$.runs[0].results[0]: '{name}' is a required property" in output


def test_damaged_reports_are_no_defect(written: dict[str, Any], tmp_path: Path) -> None:
    random = Random(1)
    for _ in range(60):
        document = damaged(random, written)
        for command in ("report", "chart"):
            assert invoked(command, document, tmp_path)[0] != ExitStatus.INTERNAL_ERROR, document


def test_a_sweep_has_the_values_of_its_grid(tmp_path: Path) -> None:
    path = tmp_path / "m.ta"
    path.write_text("const int N = 1; process P() { init location A; } system P; property q : E<> N == 1;")
    output = tmp_path / "sweep.json"
    CliRunner().invoke(app, ["sweep", str(path), "-D", "N=1..2", "--format", "json", "-o", str(output)])
    document = json.loads(output.read_text(encoding="utf-8"))
    assert invoked("report", document, tmp_path)[0] == ExitStatus.AS_EXPECTED
    document["rows"][1]["N"] = 5
    status, told = invoked("report", document, tmp_path)
    assert status == ExitStatus.BAD_INPUT
    assert "$.rows[1]" in told


@pytest.mark.parametrize("content", [b"\xff{}", b"[1]", b"{", b"{" * 100_000, b'{"a": NaN}', b"[" * 100_000])
def test_what_is_no_object_is_no_report(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "x.json"
    path.write_bytes(content)
    with pytest.raises(UsageError):
        read_json(path, "")


def test_a_message_is_not_as_long_as_the_report(tmp_path: Path) -> None:
    with pytest.raises(UsageError) as raised:
        check_report({"runs": {"a" * 10_000: 1}}, "verify", tmp_path / "x.json", "")
    assert len(str(raised.value)) < 400


def test_statistical_answers_are_described_alike() -> None:
    of_verify, of_estimate = (
        json.loads((ROOT / f"docs/schema/{name}.schema.json").read_text(encoding="utf-8"))["$defs"]
        for name in ("verify", "estimate")
    )
    assert of_estimate.items() <= of_verify.items()
