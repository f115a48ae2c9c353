"""The times of packets, which the kernel notes."""

from __future__ import annotations

import socket
import threading
import time

from tachk.xrce.testing.packet_socket import HOST, Address, PacketSocket


def test_packets_keep_their_order_and_have_the_time_at_which_they_came() -> None:
    """They are read only after all have come, so the time of reading would be another one on Linux."""
    receiver, count = PacketSocket(), 50
    found: list[tuple[int, bytes, Address]] = []
    done = threading.Event()

    def take(moment: int, octets: bytes, address: Address) -> None:
        found.append((moment, octets, address))
        if len(found) == count:
            done.set()

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.bind((HOST, 0))
        before = time.monotonic_ns()
        for number in range(count):
            sender.sendto(bytes([number]), (HOST, receiver.port))
        receiver.read_into(take)
        assert done.wait(60)
        receiver.close()
        assert [octets for _, octets, _ in found] == [bytes([number]) for number in range(count)]
        moments = [moment for moment, _, _ in found]
        assert moments == sorted(moments)
        assert before - 10**9 < moments[0] and moments[-1] <= time.monotonic_ns()
        assert {address for _, _, address in found} == {sender.getsockname()}
