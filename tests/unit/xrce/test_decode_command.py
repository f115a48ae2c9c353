"""`tachk xrce decode`."""

from __future__ import annotations

import json
from io import BytesIO, TextIOWrapper
from pathlib import Path

import jsonschema
import pytest
from click.testing import CliRunner

from tachk.cli.main import app
from tachk.xrce.wire import SubmessageKind
from tests.unit.xrce.captures import ACKNACK, CREATE_CLIENT, HEARTBEAT, WRITE_DATA, pcap, udp

ROOT = Path(__file__).resolve().parents[3]
SCHEMA = json.loads((ROOT / "docs/schema/decode.schema.json").read_text(encoding="utf-8"))


@pytest.fixture
def capture(tmp_path: Path) -> Path:
    path = tmp_path / "run.pcap"
    packets = [udp(CREATE_CLIENT), udp(WRITE_DATA), udp(ACKNACK, 8888, 40000), udp(HEARTBEAT), udp(b"GET / HTTP/1.1")]
    path.write_bytes(pcap(packets)[:-1])
    return path


def test_text(capture: Path):
    result = CliRunner().invoke(app, ["xrce", "decode", str(capture)])
    assert result.exit_code == 0
    words = [line.split(maxsplit=6)[-1] for line in result.output.splitlines()]
    assert [line[:13] for line in result.output.splitlines()] == [f"     0.00{n}000" for n in (0, 1, 2, 3, 3)]
    assert words == [
        "CREATE_CLIENT key CCCCDDDD, session 81, messages of up to 508 bytes",
        "80:4  WRITE_DATA 0015, 4 bytes: 03000000 (request 17)",
        "ACKNACK stream 80: all before 4 arrived, missing 4",
        "HEARTBEAT stream 80: holds 4 to 4",
        "malformed: the file ends inside packet 5",
    ]


def test_json_follows_its_schema(capture: Path, tmp_path: Path):
    output = tmp_path / "out.jsonl"
    assert (
        CliRunner().invoke(app, ["xrce", "decode", str(capture), "--format", "jsonl", "-o", str(output)]).exit_code == 0
    )
    lines = [json.loads(line) for line in output.read_text(encoding="utf-8").splitlines()]
    for line in lines:
        jsonschema.validate(line, SCHEMA)
    assert [line["kind"] for line in lines] == ["CREATE_CLIENT", "WRITE_DATA", "ACKNACK", "HEARTBEAT", "malformed"]


def test_the_schema_knows_every_kind_and_no_other():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert SCHEMA["properties"]["kind"]["enum"] == [*(kind.name for kind in SubmessageKind), "malformed"]


def test_standard_input(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("sys.stdin", TextIOWrapper(BytesIO(pcap([udp(HEARTBEAT)]))))
    result = CliRunner().invoke(app, ["xrce", "decode", "-"], input=pcap([udp(HEARTBEAT)]))
    assert "HEARTBEAT" in result.output


def test_a_port_that_nobody_uses_is_named(tmp_path: Path):
    capture = tmp_path / "run.pcap"
    capture.write_bytes(pcap([udp(HEARTBEAT)]))
    result = CliRunner().invoke(app, ["xrce", "decode", str(capture), "--port", "2018", "--port", "2019"])
    assert result.exit_code == 0
    assert "no packet to or from port 2018, 2019" in result.stderr


def test_a_file_that_is_no_capture(tmp_path: Path):
    path = tmp_path / "notes.txt"
    path.write_text("a text")
    result = CliRunner().invoke(app, ["xrce", "decode", str(path)])
    assert result.exit_code == 2
    assert "neither a pcap nor a pcapng capture" in result.stderr
    assert CliRunner().invoke(app, ["xrce", "decode", str(tmp_path / "none.pcap")]).exit_code == 2


@pytest.mark.parametrize(
    ("capture", "hint"),
    [
        ("captures/stale_acknack.pcap", "sessions are created at the ports 19401, 19488: try --port 19401"),
        ("serial_line_damaged.pcap", "the packets hold a serial line: try --serial"),
    ],
)
def test_where_messages_are(capture: str, hint: str) -> None:
    result = CliRunner().invoke(app, ["xrce", "decode", str(ROOT / "tests/data" / capture)])
    assert (result.exit_code, result.stdout) == (0, "")
    assert result.stderr == f"no packet to or from port 8888; {hint}\n"
