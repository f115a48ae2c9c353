"""`python -m bench` measures, remembers and compares."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

if not (ROOT / "bench").is_dir():
    pytest.skip("needs a checkout", allow_module_level=True)


def test_a_run_is_measured_remembered_and_compared_with_the_one_before(tmp_path: Path) -> None:
    history = tmp_path / "history.json"
    command = [sys.executable, "-m", "bench", "run", "--only", "train_gate=2", "--repeat", "1", "--history", history]
    first = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    (line,) = [line for line in first.stdout.splitlines() if line.startswith("| train_gate")]
    assert line.startswith("| train_gate | 2 | tachk | not reached | 11 | 11 |")
    (entry,) = json.loads(history.read_text(encoding="utf-8"))
    entry["rows"][0] |= {"stored": 70, "cpu_seconds": 1000.0}
    history.write_text(json.dumps([entry]), encoding="utf-8")
    second = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    (compared,) = [line for line in second.stdout.splitlines() if "| 1000.00 |" in line]
    assert compared.startswith("| train_gate | 2 | tachk | 1000.00 |") and compared.endswith("| 70 | 11 |")
    assert len(json.loads(history.read_text(encoding="utf-8"))) == 2


def test_every_program_can_be_imported() -> None:
    names = sorted(path.stem for path in (ROOT / "bench").glob("*.py") if path.stem != "__main__")
    program = f"""
import sys
sys.path[:0] = [".", "bench"]
for name in {names}:
    try:
        __import__(name)
    except ModuleNotFoundError as missing:
        if missing.name != "rtamt":
            raise
"""
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
