"""Damaged inputs of all forms and random command lines: always an answer or a sentence, never a defect.

`python -m tests.fuzz.run` tries as many as are wanted; this is a small part of it, always the same.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.drawn


def test_nothing_is_a_defect(tmp_path: Path) -> None:
    # In a process of its own: a child that is forked has to come from one without threads.
    arguments = ["--no-limits", "--inputs", "2", "--commands", "12", "--seed", "0", "--folder", str(tmp_path)]
    done = subprocess.run(
        [sys.executable, "-m", "tests.fuzz.run", *arguments],
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
