"""`tachk xrce bridge`: a process of its own, which speaks by UDP with a socket of the test."""

from __future__ import annotations

import select
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from io import BytesIO
from pathlib import Path

import pytest

from tachk.cli.main import app
from tachk.formats.loading.load import load_model
from tachk.xrce.bridge.bridging import Bridge
from tachk.xrce.bridge.clock import WallClock
from tachk.xrce.bridge.part import BridgedPart
from tachk.xrce.bridge.sockets import BridgeSocket
from tachk.xrce.events import SubmessageEvent, decode
from tachk.xrce.messages import Endpoint
from tachk.xrce.proxy.recording import CaptureWriter
from tachk.xrce.wire import SubmessageKind

MODEL = Path(__file__).parents[4] / "models" / "micro_xrce_dds" / "publication.ta"
MESSAGES = 3
SPEED = 20.0
CLIENT = ("application", "publisher")
AGENT = ("writer",)
LONG = 60
"""Seconds after which a test that hears nothing fails."""


@contextmanager
def command(*arguments: str) -> Iterator[subprocess.Popen[str]]:
    line = [
        sys.executable,
        "-m",
        "tachk",
        "xrce",
        "bridge",
        str(MODEL),
        "-D",
        f"MESSAGES={MESSAGES}",
        "--speed",
        str(SPEED),
    ]
    with subprocess.Popen([*line, *arguments], stdout=subprocess.PIPE, text=True) as process:
        try:
            yield process
        finally:
            process.kill()


class Other:
    """The other end, in the test."""

    def __init__(self, processes: tuple[str, ...], to: Endpoint | None) -> None:
        self._agent = None if to is None else to.port
        self._looked_at = 0
        self._clock = WallClock(SPEED)
        self._file = BytesIO()
        part = BridgedPart(load_model(MODEL, {"MESSAGES": MESSAGES}).network, processes)
        self.socket = BridgeSocket(Bridge(part, self._clock), None, to, CaptureWriter(self._file))

    def events(self) -> list[SubmessageEvent]:
        return list(decode(BytesIO(self._file.getvalue()), [self._agent or self.socket.address.port]))

    def speak(self) -> None:
        """Until everything that was written is confirmed."""
        self.socket.run(self._clock, int(LONG * 1e9 * SPEED), self._is_confirmed)
        assert self._clock.now() < LONG * 1e9 * SPEED

    def _is_confirmed(self) -> bool:
        if self._looked_at == sum(self.socket.packets):
            return False  # nothing has come or gone
        self._looked_at = sum(self.socket.packets)
        confirmed = [e.fields["first"] for e in self.events() if e.kind is SubmessageKind.ACKNACK and not e.to_agent]
        return MESSAGES + 1 in confirmed

    def close(self) -> None:
        self.socket.close()


def ended(process: subprocess.Popen[str]) -> str:
    """What it says after Ctrl-C."""
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=LONG)
    return out


def options(processes: tuple[str, ...]) -> list[str]:
    return [word for name in processes for word in ("--process", name)]


def test_a_client_writes_to_the_agent_that_it_is_given(tmp_path: Path) -> None:
    capture = tmp_path / "session.pcap"
    with closing(Other(AGENT, None)) as agent:
        place = str(agent.socket.address)
        with command(*options(CLIENT), "--to", place, "--record", str(capture)) as process:
            agent.speak()
            assert process.stdout is not None
            assert process.stdout.readline().rstrip().endswith(f", to {place}")
            assert "of them mean nothing to the model" in ended(process)
            assert process.returncode == 0
        recorded = list(decode(BytesIO(capture.read_bytes()), [agent.socket.address.port]))
    written = {event.sequence for event in recorded if event.kind is SubmessageKind.WRITE_DATA}
    assert written == set(range(1, MESSAGES + 1))
    assert recorded[0].kind is SubmessageKind.CREATE_CLIENT


def test_an_agent_answers_at_the_port_that_it_is_given() -> None:
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with command(*options(AGENT), "--listen", str(port)) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == f"{MODEL}: Agent at 127.0.0.1:{port}\n"
        with closing(Other(CLIENT, Endpoint("127.0.0.1", port))) as client:
            client.speak()
        assert "packets sent" in ended(process)
        assert process.returncode == 0


def test_a_client_whom_nobody_answers_has_asked_and_had_no_session() -> None:
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as silent:
        silent.bind(("127.0.0.1", 0))
        with command(*options(CLIENT), "--to", f"127.0.0.1:{silent.getsockname()[1]}") as process:
            assert select.select([silent], [], [], LONG)[0]
            assert ", 0 received" in ended(process)
            assert process.returncode == 10


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (options(CLIENT), "--to is missing"),
        (options(AGENT), "--listen is missing"),
        ([*options(AGENT), "--listen", "TAKEN"], "Address already in use"),
        (options(("loss",)), "send on 0 links"),
    ],
)
def test_wrong_options_get_a_message(capsys: pytest.CaptureFixture[str], arguments: list[str], message: str) -> None:
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as taken:
        taken.bind(("127.0.0.1", 0))
        given = [str(taken.getsockname()[1]) if word == "TAKEN" else word for word in arguments]
        status = app.main(["xrce", "bridge", str(MODEL), *given], prog_name="tachk", standalone_mode=False)
    assert status == 2
    assert message in capsys.readouterr().err
