"""Addresses of sockets on the command line."""

from __future__ import annotations

import socket

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import is_whole
from tachk.xrce.messages import Endpoint


def place(text: str, option: str, needs_host: bool = False) -> Endpoint:
    """The endpoint that ``[HOST:]PORT`` names, at 127.0.0.1 without a host. Raises UsageError."""
    host, colon, port = text.rpartition(":")
    if not is_whole(port) or not 1 <= int(port) <= 65535 or (needs_host and not host) or (colon and not host):
        raise UsageError(f"{option} {text}: no {'HOST:PORT' if needs_host else '[HOST:]PORT'}", "like 127.0.0.1:8888")
    try:
        return Endpoint(socket.gethostbyname(host or "127.0.0.1"), int(port))
    except OSError:
        raise UsageError(f"{option} {text}: {host} is not known as a host with an address of IPv4") from None
