"""A wheel in an empty environment: skipped unless TACHK_WHEEL names one and uv is there."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / ".ci/first_verdict.py"
WHEEL = os.environ.get("TACHK_WHEEL")


@pytest.mark.skipif(WHEEL is None, reason="TACHK_WHEEL names no wheel: pip wheel --no-deps -w dist .")
@pytest.mark.skipif(find_spec("uv") is None, reason="uv is not installed")
def test_first_verdict_in_an_empty_environment() -> None:
    """Small enough, without a compiler, and the verdict is right; the times are printed."""
    assert WHEEL is not None
    ended = subprocess.run([sys.executable, SCRIPT, WHEEL], capture_output=True, text=True, timeout=300)
    assert ended.returncode == 0, ended.stdout + ended.stderr
