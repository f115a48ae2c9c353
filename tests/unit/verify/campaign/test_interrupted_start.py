"""Ctrl-C is for the program that sweeps, from the first moment of its processes on."""

from __future__ import annotations

import os
import signal
import sys
from typing import Any

import pytest

from tachk.verify.campaign import local

LOCAL: Any = local


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal")
def test_a_process_that_is_interrupted_while_it_starts_goes_on(capfd: pytest.CaptureFixture[str]) -> None:
    worker = LOCAL._started()
    try:
        os.kill(worker.process.pid, signal.SIGINT)
        worker.pipe.send("no job")
        worker.pipe.send("no cell")
        assert "Error" in worker.pipe.recv()  # why it could not compute that cell
    finally:
        LOCAL._end(worker)
    assert capfd.readouterr().err == ""
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, set())
