"""Every run of the tests tries the same random examples, so that a failure is never a matter of luck.

Ctrl-C means what it means at a terminal, also where a shell runs the tests in the background and has them ignore it.
"""

from __future__ import annotations

import signal

from hypothesis import settings

signal.signal(signal.SIGINT, signal.default_int_handler)
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")
