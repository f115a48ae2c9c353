"""The pytest file of a test suite."""

from __future__ import annotations

import json
from collections.abc import Sequence

_TEMPLATE = '''"""Replays the runs of this folder on the model. Written by `tachk tests`."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent
MODEL = FOLDER / {model}
DEFINITIONS: list[str] = {definitions}


def check(command: str, file: str, *options: str) -> None:
    arguments = [command, str(MODEL), file, *DEFINITIONS, *options]
    done = subprocess.run([sys.executable, "-m", "tachk", *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
'''

_OF_RUNS = '''

RUNS = {runs}


@pytest.mark.parametrize("run", RUNS)
def test_run(run: str) -> None:
    """It is a run of the model."""
    check("replay", str(FOLDER / run), "--quiet")
'''

_OF_RECORDINGS = '''

RECORDINGS = {recordings}


@pytest.mark.parametrize("recording", RECORDINGS)
def test_recording(recording: str) -> None:
    """The events are those of a run of the model."""
    check("conform", str(FOLDER / recording))
'''

_OF_TESTS = '''

SCRIPTS = {scripts}
SYSTEM = os.environ.get("TACHK_ADAPTER")


@pytest.mark.skipif(SYSTEM is None, reason="TACHK_ADAPTER names no system, such as process:./program")
@pytest.mark.parametrize("recording", SCRIPTS)
def test_system(recording: str) -> None:
    """The system does what the model allows while it gets the inputs of the run."""
    check("test", "--inputs=" + str(FOLDER / recording), "--adapter", str(SYSTEM))
'''

_OF_PROOFS = '''

def test_proofs() -> None:
    """What no run covers is impossible: the certificate proves it of a model that notes what is taken."""
    arguments = ["certify", str(FOLDER / {noting}), str(FOLDER / {proofs}), *DEFINITIONS]
    done = subprocess.run([sys.executable, "-m", "tachk", *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
'''


def pytest_file(
    model: str,
    definitions: Sequence[str],
    runs: Sequence[str],
    recordings: Sequence[str],
    scripts: Sequence[str],
    proofs: tuple[str, str] | None = None,
) -> str:
    """The text of the file.

    Args:
        model: its path from the folder of the file.
        definitions: those of ``-D``, as they were given.
        runs, recordings: the names of files of the folder.
        scripts: the recordings that have inputs of a system.
        proofs: those of the model that notes what is taken and of the certificate about it; None: there is none.
    """
    given = [word for each in definitions for word in ("-D", each)]
    template = _TEMPLATE if scripts else _TEMPLATE.replace("import os\n", "")
    for section, is_there in (
        (_OF_RUNS, runs),
        (_OF_RECORDINGS, recordings),
        (_OF_TESTS, scripts),
        (_OF_PROOFS, proofs is not None),
    ):
        template += section if is_there else ""
    noting, certificate = proofs or ("", "")
    return template.format(
        model=_quoted(model),
        definitions=_listed(given),
        runs=_listed(runs),
        recordings=_listed(recordings),
        scripts=_listed(scripts),
        noting=_quoted(noting),
        proofs=_quoted(certificate),
    )


def _listed(names: Sequence[str]) -> str:
    """A list as a formatter would write it."""
    quoted = [_quoted(name) for name in names]
    line = f"[{', '.join(quoted)}]"
    return line if len(line) <= 60 else "[\n" + "".join(f"    {each},\n" for each in quoted) + "]"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
