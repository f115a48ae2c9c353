"""What the runner of random commands takes for a defect."""

from __future__ import annotations

import os
import signal

import pytest

from tests.fuzz.worker import STATUSES, wrong


@pytest.mark.parametrize("status", sorted(STATUSES))
def test_a_status_that_is_documented_is_none(status: int) -> None:
    assert wrong(status << 8, "error: no such file") is None


@pytest.mark.parametrize(
    ("status", "said"),
    [
        (70 << 8, "error: this is a defect"),
        (99 << 8, ""),
        (0, 'Traceback (most recent call last):\n  File "a.py", line 1\nValueError: x'),
        (int(signal.SIGSEGV), ""),
        (int(signal.SIGXCPU), ""),
    ],
)
def test_anything_else_is_a_defect(status: int, said: str) -> None:
    assert wrong(status, said) is not None


def test_a_defect_is_reported_with_its_place() -> None:
    said = 'Traceback (most recent call last):\n  File "a.py", line 1, in f\n    g()\nValueError: x\nerror: report it'
    assert wrong(70 << 8, said) == 'status 70: ValueError: x at File "a.py", line 1, in f'
    assert os.WIFEXITED(70 << 8)
