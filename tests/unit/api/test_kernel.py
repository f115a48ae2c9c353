"""What is said in words is the same inside a kernel of Jupyter, and is returned, not displayed."""

from __future__ import annotations

import ast
import re
import sys
import warnings
from pathlib import Path

import pytest

nbclient = pytest.importorskip("nbclient")
nbformat = pytest.importorskip("nbformat")
pytest.importorskip("ipykernel")
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the kernel needs an event loop of another kind")

FISCHER = Path(__file__).parents[3] / "models/classics/fischer.ta"

TEXTS = f"""
import sys
sys.path[:0] = {[path for path in sys.path if path]!r}
import tachk
model = tachk.load({str(FISCHER)!r}, N=2, WAIT=9)
report = model.verify()
trace = {{"time": [0, 1, 2], "x": [1, 2, 5]}}
texts = {{
    "report": report.to_text(),
    "every run": report.to_text(every_trace=True),
    "str": str(report),
    "run": report.run("mutual_exclusion").to_text(),
    "monitor": tachk.monitor("G (x < 3)", trace).to_text(),
    "sweep": model.sweep(over="WAIT=9..11", property="mutual_exclusion", processes=1).to_text(),
    "page": report.to_page(),
}}
"""


def _without_measurements(text: str) -> str:
    return re.sub(r"[\d.,]+ ?(s|ms|MB|kB|KB)?|\s+", " ", text)


def test_texts_in_a_kernel_are_those_of_plain_python() -> None:
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(TEXTS), nbformat.v4.new_code_cell("texts")])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the libraries that start the kernel
        nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    displayed, returned = (cell.outputs for cell in notebook.cells)
    assert displayed == []
    inside = ast.literal_eval(returned[0].data["text/plain"])
    scope: dict[str, dict[str, str]] = {}
    exec(TEXTS, scope)
    outside = scope["texts"]
    assert {name: len(text) > 50 for name, text in outside.items()} == dict.fromkeys(outside, True)
    assert {name: _without_measurements(text) for name, text in inside.items()} == {
        name: _without_measurements(text) for name, text in outside.items()
    }
