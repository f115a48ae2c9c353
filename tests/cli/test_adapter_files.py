"""The C header and the Python class that make adapters: the thermostat with each of them is as its model says."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ADAPTER = ROOT / "examples/adapter"
MODEL = ROOT / "examples/thermostat/thermostat.ta"

pytestmark = [pytest.mark.drawn, pytest.mark.skipif(os.name != "posix", reason="poll and select of streams")]

IN_C = """
#include "tachk_adapter.h"

int main(void) {
    char line[256];
    int cold = 0, on = 0, got;
    long rest = tachk_milliseconds() - 500;
    tachk_begin();
    for (;;) {
        long left = rest + 500 - tachk_milliseconds();
        if (cold && !on && left <= 0) {
            tachk_output("heater", "\\"on\\": %d", on = 1);
            continue;
        }
        got = tachk_input(line, sizeof line, cold && !on ? (int)left : -1);
        if (got < 0) return 0;
        if (got && tachk_is(line, "reading")) cold = (int)tachk_column(line, "cold", 0);
        if (!cold && on) {
            tachk_output("heater", "\\"on\\": %d", on = 0);
            rest = tachk_milliseconds();
        }
    }
}
"""
IN_PYTHON = """
import time
from tachk_adapter import Adapter

adapter, cold, on, rest = Adapter(), 0, 0, time.monotonic() - 0.5
while True:
    left = rest + 0.5 - time.monotonic()
    if cold and not on and left <= 0:
        on = 1
        adapter.output("heater", on=on)
        continue
    try:
        event = adapter.input(left if cold and not on else None)
    except EOFError:
        break
    if event is not None and event["event"] == "reading":
        cold = event["cold"]
    if not cold and on:
        on = 0
        adapter.output("heater", on=on)
        rest = time.monotonic()
"""


def outcome_of(command: str) -> subprocess.CompletedProcess[str]:
    arguments = ["test", str(MODEL), "--adapter", f"process:{command}", "--for", "3s", "--late", "200ms", "--seed", "1"]
    return subprocess.run([sys.executable, "-m", "tachk", *arguments], capture_output=True, text=True, timeout=120)


def compiled(folder: Path, text: str) -> Path:
    (folder / "program.c").write_text(text, encoding="utf-8")
    options = ["-std=c99", "-D_POSIX_C_SOURCE=200809L", "-Wall", "-Wextra", "-Werror", "-Wno-unused-function"]
    command = ["cc", *options, f"-I{ADAPTER}", "-o", str(folder / "program"), str(folder / "program.c")]
    subprocess.run(command, check=True)
    return folder / "program"


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
def test_header(tmp_path: Path) -> None:
    done = outcome_of(str(compiled(tmp_path, IN_C)))
    assert done.returncode in (0, 20) and "fail" not in done.stdout, done.stdout + done.stderr


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
def test_header_reads_lines_as_they_come(tmp_path: Path) -> None:
    """In pieces, several at once, too long ones, and columns of each kind."""
    text = """
#include "tachk_adapter.h"
int main(void) {
    char line[64];
    tachk_begin();
    tachk_output("both", "\\"n\\": %d, \\"on\\": %s", 3, "true");
    while (tachk_input(line, sizeof line, -1) > 0)
        printf("%d %ld %ld\\n", tachk_is(line, "reading"), tachk_column(line, "n", -7), tachk_column(line, "event", 9));
    return 0;
}
"""
    program = compiled(tmp_path, text)
    lines = ['{"event": "reading", "n": 12}', '{"event":"read","n":-3}', '{"event": "reading", "n": true}', "x" * 5000]
    lines += ['{"event": "reading", "text": "n", "n": null}', '{"event": "readings"}']
    done = subprocess.run([program], input="\n".join(lines) + "\n", capture_output=True, text=True, timeout=20)
    said = done.stdout.splitlines()
    assert said[0] == '{"event": "ready"}'
    assert said[1] == '{"event": "both", "n": 3, "on": true}'
    assert said[2:] == ["1 12 0", "0 -3 0", "1 1 0", "1 -7 0", "0 -7 0"]


def test_class(tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(IN_PYTHON, encoding="utf-8")
    shutil.copy(ADAPTER / "tachk_adapter.py", tmp_path)
    done = outcome_of(f"{sys.executable} {program}")
    assert done.returncode in (0, 20) and "fail" not in done.stdout, done.stdout + done.stderr


@pytest.mark.parametrize("name", ["tachk_adapter.h", "tachk_adapter.py"])
def test_adapters_are_short(name: str) -> None:
    assert len((ADAPTER / name).read_text(encoding="utf-8").splitlines()) <= 100
