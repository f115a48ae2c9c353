"""Programs that are reached by TCP and UDP."""

from __future__ import annotations

import json
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction

import pytest

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.simulation.testing.socket_program import SocketProgram
from tachk.simulation.testing.system_adapter import SystemEndedError

READY = b'{"event": "ready"}\n'
LIGHT = b'{"event": "light", "on": 1}\n'
NEVER = Fraction(10**9)


@contextmanager
def lamp(kind: socket.SocketKind) -> Iterator[str]:
    """Where a lamp listens that answers each press; it closes the connection when it is told to."""
    with socket.socket(socket.AF_INET, kind) as listening:
        listening.bind(("127.0.0.1", 0))
        serve = _serve_stream if kind is socket.SOCK_STREAM else _serve_datagrams
        if kind is socket.SOCK_STREAM:
            listening.listen()
        server = threading.Thread(target=serve, args=(listening,))
        server.start()
        yield f"127.0.0.1:{listening.getsockname()[1]}"
        server.join()


def _serve_stream(listening: socket.socket) -> None:
    connection, _ = listening.accept()
    with connection, connection.makefile("rb") as lines:
        connection.sendall(READY)
        for line in lines:
            if json.loads(line)["event"] == "stop":
                return
            connection.sendall(LIGHT[:5])
            connection.sendall(LIGHT[5:] + LIGHT)


def _serve_datagrams(listening: socket.socket) -> None:
    while True:
        octets, sender = listening.recvfrom(1 << 16)
        if not octets.strip():
            listening.sendto(READY, sender)
        elif json.loads(octets)["event"] == "stop":
            return
        else:
            listening.sendto(LIGHT + LIGHT.strip(), sender)


@pytest.mark.parametrize("kind", [socket.SOCK_STREAM, socket.SOCK_DGRAM])
def test_lines_go_to_and_fro(kind: socket.SocketKind) -> None:
    with lamp(kind) as place:
        system = SocketProgram(place, kind, Fraction(10**6))
        system.start()
        sent = system.send("press", {"hard": 1})
        for _ in range(2):
            seen = system.next_output(NEVER)
            assert seen is not None and (seen.name, seen.cells) == ("light", {"on": 1})
            assert seen.time >= sent >= 0
        assert system.next_output(system.time()) is None
        system.send("stop", {})
        if kind is socket.SOCK_STREAM:
            with pytest.raises(SystemEndedError, match="has closed the connection"):
                system.next_output(NEVER)
        system.close()


@pytest.mark.parametrize("place", ["7000", "localhost:", ":7000", "localhost:70000", "localhost:http"])
def test_places_that_are_none(place: str) -> None:
    with pytest.raises(UsageError, match="is no place of a program"):
        SocketProgram(place, socket.SOCK_STREAM, Fraction(1))


def test_program_that_is_not_there() -> None:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))  # it does not listen
        system = SocketProgram(f"127.0.0.1:{one.getsockname()[1]}", socket.SOCK_STREAM, Fraction(10**6))
        with pytest.raises(UsageError, match="cannot be reached: Connection refused"):
            system.start()
        system.abandon()
