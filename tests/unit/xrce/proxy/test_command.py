"""`tachk xrce proxy`: its options, what it says, its exit status."""

from __future__ import annotations

import json
import socket
from pathlib import Path

import pytest

from tachk.cli.main import app
from tachk.xrce.proxy.relay import Relay
from tests.unit.xrce.proxy.packets import write_data
from tests.unit.xrce.proxy.test_counterexample import STALE


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    status = app.main(["xrce", "proxy", *arguments], prog_name="tachk", standalone_mode=False)
    assert isinstance(status, int)
    found = capsys.readouterr()
    return status, found.out, found.err


def test_the_rules_of_scripts_of_the_command_line_and_of_a_run_are_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "s.txt").write_text("drop DATA 5 # a comment\n")
    (tmp_path / "t.json").write_text(json.dumps(STALE))
    given = ("--script", str(tmp_path / "s.txt"), "--rule", "drop 5 % of packets", "--from-trace")
    status, out, _ = run(capsys, "--listen", "19001", "--show", *given, str(tmp_path / "t.json"))
    assert status == 0
    assert out.splitlines()[:2] == ["drop the 1st DATA 5", "drop 5 % of packet"]
    assert len(out.splitlines()) == 6


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--listen", "0", "--to", "h:1"), "--listen 0: no [HOST:]PORT"),
        (("--listen", "70000", "--to", "h:1"), "--listen 70000"),
        (("--listen", "1", "--listen", "127.0.0.1:1", "--to", "h:1"), "two clients at the same port"),
        (("--listen", "1", "--to", "8888"), "--to 8888: no HOST:PORT"),
        (("--listen", "1"), "--to is missing"),
        (("--listen", "1", "--to", "no such host:1"), "no such host is not known as a host"),
        (("--listen", "TAKEN", "--to", "127.0.0.1:1"), "Address already in use"),
        (("--listen", "1", "--rule", "drop DAT"), "--rule:1:6: error[E0952]"),
        (("--listen", "1", "--script", "gone"), "gone: No such file or directory"),
        (("--listen", "1", "--script", "binary"), "binary is not text in UTF-8"),
        (("--listen", "1", "--from-trace", "binary"), "binary is not a text in UTF-8"),
        (("--listen", "1", "--from-trace", "list"), "list is not a result of tachk"),
    ],
)
def test_wrong_options_get_a_message(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: tuple[str, ...],
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "binary").write_bytes(b"\xff\xfe")
    (tmp_path / "list").write_text("[]")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = str(taken.getsockname()[1])
        status, _, err = run(capsys, *(argument.replace("TAKEN", port) for argument in arguments))
    assert status == 2
    assert message in err


@pytest.mark.parametrize(
    ("rule", "status", "told"),
    [
        ("drop WRITE_DATA", 0, "     1 x  drop the 1st WRITE_DATA\n"),
        ("drop DATA", 10, "     0 x  drop the 1st DATA\n"),
        ("drop 1 % of DATA", 0, "     0 x  drop 1 % of DATA\n"),
        ("delay WRITE_DATA until DATA", 0, "not sent any more: packet 1 on 19001 client->agent\n"),
    ],
)
def test_the_end_reports_how_often_each_rule_applied(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], rule: str, status: int, told: str
) -> None:
    from tachk.xrce.messages import Endpoint
    from tachk.xrce.proxy.decisions import RelayArrival
    from tachk.xrce.proxy.rules import PacketDirection

    async def one_packet(relay: Relay, ready: object) -> None:
        arrival = RelayArrival(19001, Endpoint("127.0.0.1", 5), PacketDirection.TO_AGENT, write_data(7), 0)
        relay._report(arrival, relay._decisions.arrived(arrival))

    monkeypatch.setattr(Relay, "run", one_packet)
    found, out, _ = run(capsys, "--listen", "19001", "--to", "127.0.0.1:8888", "--rule", rule)
    assert found == status
    assert out.endswith(told)
