"""A small client of DDS-XRCE for tests, which speaks real packets by UDP: argument 1 is the port of its Agent.

It is as `tests/unit/xrce/testing/small_client.ta` says: a line "write" on stdin lets it send the next sample, an
ACKNACK that names a sample as missing lets it send that again. With a second argument `twice` it sends it twice.
"""

from __future__ import annotations

import json
import select
import socket
import sys
import time
from contextlib import suppress

from tachk.xrce.bridge.packets import ProtocolWord, Translator
from tachk.xrce.bridge.session import ClientSession

_AGAIN = 0.1
"""Seconds after which it asks again."""


def main() -> None:
    twice = sys.argv[2:] == ["twice"]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as agent:
        agent.connect(("127.0.0.1", int(sys.argv[1])))
        session = ClientSession(b"test", "Numbers", reads=False, writes=True)
        while not session.is_open:  # the Agent may not listen yet
            with suppress(ConnectionRefusedError):
                for octets in session.due(time.monotonic_ns()):
                    agent.send(octets)
                if select.select([agent], [], [], _AGAIN)[0]:
                    for octets in session.arrived(agent.recv(1 << 16), time.monotonic_ns()):
                        agent.send(octets)
        sys.stdout.write(json.dumps({"event": "ready"}) + "\n")
        sys.stdout.flush()
        translator, samples = Translator(True, session.before), 0
        while True:
            ready, _, _ = select.select([agent, sys.stdin], [], [])
            if sys.stdin in ready:
                if not sys.stdin.readline():
                    return
                agent.send(translator.packet(ProtocolWord(0, samples, samples + 1)))
                samples += 1
            if agent in ready:
                for word in translator.words(agent.recv(1 << 16)):
                    for _ in range((2 if twice else 1) if word.kind == 2 and word.detail else 0):
                        agent.send(translator.packet(ProtocolWord(0, word.number, word.number + 1)))


if __name__ == "__main__":
    main()
