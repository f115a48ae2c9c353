"""docs/own_program.md does what it says, in order, in a copy of the folder of its program.

Tests by the clock of the wall may say nothing on a busy machine: they only have to find no fault where there is none.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from contextlib import chdir
from pathlib import Path

import pytest

from tests.cli.test_documents import CHECKOUT, FENCE, check_in_page, read_commands

PAGE = CHECKOUT / "docs/own_program.md"
EXAMPLE = CHECKOUT / "examples/pump"
AS_MODELLED, INCONCLUSIVE = 0, 20

pytestmark = [
    pytest.mark.drawn(8),
    pytest.mark.skipif(shutil.which("cc") is None or os.name != "posix", reason="there is no C compiler"),
]


def shell(text: str, folder: Path) -> int:
    """The status of commands among which `tachk` is this one."""
    tachk = f'tachk() {{ "{sys.executable}" -m tachk "$@"; }}\n'
    return subprocess.run(["sh", "-e", "-c", tachk + text], cwd=folder, timeout=120).returncode


def test_page_goes_as_it_says(tmp_path: Path) -> None:
    folder = tmp_path / "pump"
    text = PAGE.read_text(encoding="utf-8")
    (tmp_path / "examples").symlink_to(EXAMPLE.parent)
    done = []
    for fence in FENCE.finditer(text):
        language, file, body = fence.groups()
        where = folder if folder.exists() else tmp_path
        if language == "sh":
            assert shell(body, where) in (AS_MODELLED, INCONCLUSIVE), body
        elif language == "console":
            with chdir(where):
                for command in read_commands(body, text[: fence.start(3)].count("\n")):
                    check_in_page(PAGE, command)
                    done.append(command.arguments[0])
        elif file:
            (folder / file).write_text(body, encoding="utf-8")
    assert done == ["check", "conform", "conform", "test", "test", "conform", "verify"]
    header, *rows = (folder / "mine.csv").read_text(encoding="utf-8").splitlines()
    assert header == "time [ms],event,down,on"
    assert {row.split(",")[1] for row in rows} == {"button", "pump"}
    (folder / "bin").mkdir()
    tachk = folder / "bin" / "tachk"
    tachk.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m tachk "$@"\n', encoding="utf-8")
    tachk.chmod(0o755)
    path = {**os.environ, "PATH": f"{tachk.parent}:{os.environ['PATH']}"}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_pump.py"]
    assert subprocess.run(command, cwd=folder, env=path, timeout=120).returncode == 0


def test_page_quotes_the_files() -> None:
    files = [path.read_text(encoding="utf-8") for path in EXAMPLE.iterdir()]
    quoted = [body for language, _, body in FENCE.findall(PAGE.read_text(encoding="utf-8")) if language in ("c", "ta")]
    assert len(quoted) == 4
    for body in quoted:
        assert any(body in text for text in files), body
