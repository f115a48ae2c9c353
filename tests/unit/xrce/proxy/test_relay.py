"""The sockets of the relay, between a client and an Agent of the test, and its capture."""

from __future__ import annotations

import asyncio
import io
import socket
import struct
import sys
import time
from pathlib import Path

import pytest

from tachk.base.span import Source
from tachk.xrce.events import decode
from tachk.xrce.messages import Endpoint
from tachk.xrce.proxy.decisions import Decisions
from tachk.xrce.proxy.fault_plan import parse_fault_plan
from tachk.xrce.proxy.recording import CaptureWriter, Sorted
from tachk.xrce.proxy.relay import Plan, Relay
from tests.unit.xrce.proxy.packets import acknack, write_data


def bound() -> socket.socket:
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.bind(("127.0.0.1", 0))
    made.setblocking(False)
    return made


def free_port() -> int:
    with bound() as found:
        return int(found.getsockname()[1])


async def exchange(script: str, file: io.BytesIO) -> list[bytes]:
    """A client writes three samples, an Agent answers each that arrives; gives what both get."""
    loop = asyncio.get_running_loop()
    with bound() as agent, bound() as client:
        port = free_port()
        plan = Plan([Endpoint("127.0.0.1", port)], Endpoint(*agent.getsockname()), None)
        relay = Relay(plan, Decisions(parse_fault_plan(Source("s", script))), CaptureWriter(file))
        ready = asyncio.Event()
        running = asyncio.create_task(relay.run(ready.set))
        await ready.wait()
        got = []
        for number in (1, 2, 3):
            await loop.sock_sendto(client, write_data(number), ("127.0.0.1", port))
        for first in (2, 3):
            octets, source = await loop.sock_recvfrom(agent, 2048)
            await loop.sock_sendto(agent, acknack(first), source)
            got += [octets, (await loop.sock_recvfrom(client, 2048))[0]]
        running.cancel()
        with pytest.raises(asyncio.CancelledError):
            await running
    return got


def test_packets_go_to_and_fro_and_are_recorded_on_both_sides() -> None:
    file = io.BytesIO()
    got = asyncio.run(exchange("drop WRITE_DATA 1", file))
    assert got == [write_data(2), acknack(2), write_data(3), acknack(3)]
    file.seek(0)
    seen = [(event.sequence, event.fields.get("first"), event.to_agent) for event in decode(file, _agents(file))]
    client_to_agent = [sequence for sequence, _, to_agent in seen if to_agent]
    assert sorted(client_to_agent) == [1, 2, 2, 3, 3]
    assert sorted(first for _, first, to_agent in seen if not to_agent) == [2, 2, 3, 3]  # type: ignore[type-var]


async def busy(file: io.BytesIO) -> list[tuple[int, int]]:
    """Two clients send while nobody looks at the sockets of the relay; when they did."""
    spans = []
    with bound() as agent, bound() as first, bound() as second:
        ports = [free_port(), free_port()]
        plan = Plan([Endpoint("127.0.0.1", port) for port in ports], Endpoint(*agent.getsockname()), None)
        ready = asyncio.Event()
        running = asyncio.create_task(Relay(plan, Decisions(()), CaptureWriter(file)).run(ready.set))
        await ready.wait()
        until_datagrams_are_stamped()
        for number, client, port in ((1, second, ports[1]), (2, first, ports[0]), (3, second, ports[1])):
            begin = time.time_ns()
            client.sendto(write_data(number), ("127.0.0.1", port))
            spans.append((begin, time.time_ns()))
        while waiting(ports[1]) != 2 * waiting(ports[0]) or not waiting(ports[0]):
            pass  # a busy kernel delivers what was sent a little later, and not always in order
        got = [(await asyncio.get_running_loop().sock_recvfrom(agent, 2048))[0] for _ in spans]
        assert got == [write_data(1), write_data(2), write_data(3)]
        running.cancel()
        with pytest.raises(asyncio.CancelledError):
            await running
    return spans


def until_datagrams_are_stamped() -> None:
    """Waits until the kernel notes when a datagram comes, which it begins to do a little after a socket wants it."""
    with bound() as own:
        own.setsockopt(socket.SOL_SOCKET, 35, 1)  # SO_TIMESTAMPNS
        stamped = False
        while not stamped:
            own.sendto(b"x", own.getsockname())
            while not waiting(own.getsockname()[1]):
                pass
            sent = time.time_ns()
            _, ((_, _, stamp),), *_ = own.recvmsg(1, 64)
            seconds, nanoseconds = struct.unpack("@2l", stamp)
            stamped = seconds * 1_000_000_000 + nanoseconds < sent


def waiting(port: int) -> int:
    """The octets of the kernel that wait at a UDP port of this machine, all datagrams being equally long."""
    lines = [line.split() for line in Path("/proc/net/udp").read_text().splitlines()[1:]]
    return sum(int(line[4].split(":")[1], 16) for line in lines if int(line[1].split(":")[1], 16) == port)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux notes when a datagram came")
def test_packets_are_taken_in_their_order_and_recorded_when_they_came() -> None:
    file = io.BytesIO()
    spans = asyncio.run(busy(file))
    octets, at, times = file.getvalue(), 24, []
    while at < len(octets):
        seconds, nanoseconds, size = struct.unpack_from("<3I", octets, at)
        times.append(seconds * 1_000_000_000 + nanoseconds)
        at += 16 + size
    assert times == sorted(times) and len(times) == 6
    slack = 100_000  # between two clocks of the system
    assert [begin - slack <= came <= end + slack for (begin, end), came in zip(spans, times, strict=False)] == [
        True
    ] * 3


def test_what_is_known_late_is_written_in_its_place() -> None:
    file = io.BytesIO()
    ordered = Sorted(CaptureWriter(file))
    ends = Endpoint("127.0.0.1", 5), Endpoint("127.0.0.1", 6)
    for moment, octets in ((3, b"c"), (1, b"a"), (3, b"d"), (4, b"e"), (2, b"b")):
        ordered.packet(moment, *ends, octets)
    ordered.write(4)
    assert written(file) == b"abcd"
    ordered.write(None)
    assert written(file) == b"abcde"


def written(file: io.BytesIO) -> bytes:
    """The last byte of each packet."""
    return file.getvalue()[24 + 16 + 42 :: 16 + 43]


def _agents(file: io.BytesIO) -> set[int]:
    """The ports to which the first leg and the second one of the capture go."""
    octets, at, ports = file.getvalue(), 24, set()
    while at < len(octets):
        size = struct.unpack_from("<I", octets, at + 8)[0]
        frame = octets[at + 16 : at + 16 + size]
        if frame[46] == 7 or frame[42:44] == b"\x81\x80":
            ports.add(struct.unpack_from(">H", frame, 36)[0])
        at += 16 + size
    return ports


def test_headers_are_those_of_udp_over_ipv4() -> None:
    file = io.BytesIO()
    recording = CaptureWriter(file)
    recording.packet(1_500_000_000_123_456_789, Endpoint("127.0.0.1", 5), Endpoint("10.0.0.2", 6), b"abc")
    header, frame = file.getvalue()[:40], file.getvalue()[40:]
    assert header[:4] == bytes.fromhex("4d3cb2a1")
    assert struct.unpack("<4I", header[24:]) == (1_500_000_000, 123_456_789, 45, 45)
    total = sum(struct.unpack(">10H", frame[14:34]))
    assert (total & 0xFFFF) + (total >> 16) == 0xFFFF
    assert frame[26:34] == bytes([127, 0, 0, 1, 10, 0, 0, 2])
    assert frame[34:] == struct.pack(">HHHH", 5, 6, 11, 0) + b"abc"
