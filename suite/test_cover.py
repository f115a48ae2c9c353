"""Replays the runs of this folder on the model. Written by `tachk tests`."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent
MODEL = FOLDER / "../examples/thermostat/thermostat.ta"
DEFINITIONS: list[str] = []
RUNS = ["thermostat-1.run"]
RECORDINGS: list[str] = ["thermostat-1.jsonl"]


def check(command: str, file: str, *options: str) -> None:
    arguments = [command, str(MODEL), str(FOLDER / file), *DEFINITIONS, *options]
    done = subprocess.run([sys.executable, "-m", "tachk", *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("run", RUNS)
def test_run(run: str) -> None:
    """It is a run of the model."""
    check("replay", run, "--quiet")


@pytest.mark.parametrize("recording", RECORDINGS)
def test_recording(recording: str) -> None:
    """The events are those of a run of the model."""
    check("conform", recording)
