"""The study of examples/paper, in small."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.drawn(8)

STUDY = Path(__file__).parents[2] / "examples/paper/study.py"


def test_a_small_study(tmp_path: Path) -> None:
    """One loss is enough to see every part of the page; two subscribers that do not linger are disturbed."""
    size = ["--runs", "3", "--drawn", "200", "--losses", "1", "--rates", "0.3", "--lingers", "1"]
    subprocess.run(
        [sys.executable, str(STUDY), "--folder", str(tmp_path), *size], check=True, stdout=subprocess.DEVNULL
    )
    rows = json.loads((tmp_path / "sweep.json").read_text(encoding="utf-8"))["rows"]
    found = {(row["LOSSES"], row["LINGER"]): row["answer"] for row in rows if row["property"] == "NIWS"}
    assert found == {(0, 1): "holds", (1, 1): "fails"}
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    for words in ("<h2>3 runs</h2>", "LOSSES = 0</h2>", "LOSSES = 1</h2>", "What mends it", "loss_rates.svg"):
        assert words in text
