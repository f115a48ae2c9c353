"""The life of the process of a server."""

from __future__ import annotations

import os
import signal
import socket

from tachk.cli.server.loop import Server
from tachk.cli.server.preload import preload
from tachk.cli.server.scripts import name_for_scripts


def run(descriptor: int, path: str, idle: float) -> None:
    """Serves a socket until the server is idle for so many seconds, or is stopped.

    Args:
        descriptor: of the socket, which takes connections already: they wait while tachk is loaded.
        path: where it stands.
    """
    # A signal that comes before the server can handle it, ends it once it can.
    signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM))
    os.set_inheritable(descriptor, False)
    listening = socket.socket(fileno=descriptor)
    name_for_scripts(path)
    preload()
    os.chdir("/")  # no folder that someone wants to remove, or a file system to unmount
    Server(listening, path, idle).serve()
