"""A small Agent of DDS-XRCE for tests, which speaks real packets by UDP: argument 1 is its port.

It is as `small_agent.ta` says: it confirms each sample. With a second argument `forgetful` it confirms no more than
three.
"""

from __future__ import annotations

import socket
import sys

from tachk.xrce.bridge.packets import ProtocolWord, Translator
from tachk.xrce.bridge.session import AgentSession


def main() -> None:
    forgetful = sys.argv[2:] == ["forgetful"]
    session, received = AgentSession(), 0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", int(sys.argv[1])))
        while True:
            octets, client = one.recvfrom(1 << 16)
            reply = session.arrived(octets, 0)
            if session.is_open and not reply:
                translator = Translator(False, session.before)
                for word in translator.words(octets):
                    if word.kind == 0:
                        received = max(received, word.number + 1)
                        confirmed = min(received, 3) if forgetful else received
                        reply.append(translator.packet(ProtocolWord(2, confirmed, 0)))
            for answer in reply:
                one.sendto(answer, client)


if __name__ == "__main__":
    main()
