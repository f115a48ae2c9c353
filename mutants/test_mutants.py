"""Replays the runs of this folder on the model. Written by `tachk tests`."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent
MODEL = FOLDER / "../examples/thermostat/thermostat.ta"
DEFINITIONS: list[str] = []


def check(command: str, file: str, *options: str) -> None:
    arguments = [command, str(MODEL), file, *DEFINITIONS, *options]
    done = subprocess.run([sys.executable, "-m", "tachk", *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


RECORDINGS = [
    "thermostat-mutants-1.jsonl",
    "thermostat-mutants-2.jsonl",
    "thermostat-mutants-3.jsonl",
]


@pytest.mark.parametrize("recording", RECORDINGS)
def test_recording(recording: str) -> None:
    """The events are those of a run of the model."""
    check("conform", str(FOLDER / recording))


SCRIPTS = [
    "thermostat-mutants-1.jsonl",
    "thermostat-mutants-2.jsonl",
    "thermostat-mutants-3.jsonl",
]
SYSTEM = os.environ.get("TACHK_ADAPTER")


@pytest.mark.skipif(SYSTEM is None, reason="TACHK_ADAPTER names no system, such as process:./program")
@pytest.mark.parametrize("recording", SCRIPTS)
def test_system(recording: str) -> None:
    """The system does what the model allows while it gets the inputs of the run."""
    check("test", "--inputs=" + str(FOLDER / recording), "--adapter", str(SYSTEM))
