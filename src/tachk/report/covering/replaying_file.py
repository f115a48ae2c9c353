"""The pytest file of a test suite."""

from __future__ import annotations

import json
from collections.abc import Sequence

_TEMPLATE = '''"""Replays the runs of this folder on the model. Written by `tachk tests`."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent
MODEL = FOLDER / {model}
DEFINITIONS: list[str] = {definitions}
RUNS = {runs}
RECORDINGS: list[str] = {recordings}


def check(command: str, file: str, *options: str) -> None:
    arguments = [command, str(MODEL), str(FOLDER / file), *DEFINITIONS, *options]
    done = subprocess.run([sys.executable, "-m", "tachk", *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("run", RUNS)
def test_run(run: str) -> None:
    """It is a run of the model."""
    check("replay", run, "--quiet")
'''

_OF_RECORDINGS = '''

@pytest.mark.parametrize("recording", RECORDINGS)
def test_recording(recording: str) -> None:
    """The events are those of a run of the model."""
    check("conform", recording)
'''


def pytest_file(model: str, definitions: Sequence[str], runs: Sequence[str], recordings: Sequence[str]) -> str:
    """The text of the file.

    Args:
        model: its path from the folder of the file.
        definitions: those of ``-D``, as they were given.
        runs, recordings: the names of files of the folder.
    """
    given = [word for each in definitions for word in ("-D", each)]
    template = _TEMPLATE + (_OF_RECORDINGS if recordings else "")
    if not recordings:
        template = template.replace("RECORDINGS: list[str] = {recordings}\n", "")
    return template.format(
        model=_quoted(model), definitions=_listed(given), runs=_listed(runs), recordings=_listed(recordings)
    )


def _listed(names: Sequence[str]) -> str:
    """A list as a formatter would write it."""
    quoted = [_quoted(name) for name in names]
    line = f"[{', '.join(quoted)}]"
    return line if len(line) <= 60 else "[\n" + "".join(f"    {each},\n" for each in quoted) + "]"


def _quoted(text: str) -> str:
    return json.dumps(text)
