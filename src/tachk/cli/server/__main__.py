"""The process of a server: `binding.server_command` is its command line. It serves a socket that it inherits."""

from __future__ import annotations

import os
import sys

if __name__ == "__main__":  # processes that a request starts may import this module
    _HERE = os.path.dirname(os.path.abspath(__file__))
    _PACKAGE = os.path.dirname(os.path.dirname(_HERE))
    if sys.path and os.path.abspath(sys.path[0]) == _HERE:
        del sys.path[0]
    if not any(os.path.realpath(os.path.join(path, "tachk")) == os.path.realpath(_PACKAGE) for path in sys.path):
        sys.path.insert(0, os.path.dirname(_PACKAGE))

    from tachk.cli.server.process import run

    run(int(sys.argv[1]), sys.argv[2], float(sys.argv[3]))
