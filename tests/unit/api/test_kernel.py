"""In a kernel of Jupyter texts are those of plain Python, and the notebooks of examples run from top to bottom.

One kernel does it all.
"""

from __future__ import annotations

import ast
import re
import sys
import warnings
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

nbclient = pytest.importorskip("nbclient")
nbformat = pytest.importorskip("nbformat")
pytest.importorskip("ipykernel")
pytest.importorskip("pandas")
pytestmark = [
    pytest.mark.drawn,
    pytest.mark.skipif(sys.platform == "win32", reason="the kernel needs an event loop of another kind"),
]

ROOT = Path(__file__).parents[3]
FISCHER = ROOT / "models/classics/fischer.ta"
NOTEBOOKS = ("first_model", "sweep_and_plots", "monitoring_a_log")

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


def notebook(name: str) -> Any:
    return nbformat.read(ROOT / f"examples/notebooks/{name}.ipynb", as_version=4)


@cache
def executed() -> dict[str, list[Any]]:
    """The cells of each notebook, and those with the texts, with their outputs."""
    texts = [nbformat.v4.new_code_cell(TEXTS), nbformat.v4.new_code_cell("texts")]
    parts = {"texts": texts, **{name: notebook(name).cells for name in NOTEBOOKS}}
    whole = nbformat.v4.new_notebook(cells=[cell for cells in parts.values() for cell in cells])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the libraries that start the kernel
        nbclient.NotebookClient(whole, timeout=120, kernel_name="python3").execute()
    return parts


def _without_measurements(text: str) -> str:
    return re.sub(r"[\d.,]+ ?(s|ms|MB|kB|KB)?|\s+", " ", text)


def test_texts_in_a_kernel_are_those_of_plain_python() -> None:
    displayed, returned = (cell.outputs for cell in executed()["texts"])
    assert displayed == []
    inside = ast.literal_eval(returned[0].data["text/plain"])
    scope: dict[str, dict[str, str]] = {}
    exec(TEXTS, scope)
    outside = scope["texts"]
    assert {name: len(text) > 50 for name, text in outside.items()} == dict.fromkeys(outside, True)
    assert {name: _without_measurements(text) for name, text in inside.items()} == {
        name: _without_measurements(text) for name, text in outside.items()
    }


def outputs(name: str) -> Iterator[Any]:
    for cell in executed()[name]:
        yield from cell.get("outputs", ())


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_every_result_of_a_notebook_is_a_table_or_a_picture_and_a_short_text(name: str) -> None:
    shown = [found for found in outputs(name) if found.output_type == "execute_result"]
    assert len(shown) >= 6
    for found in shown:
        assert found.data.keys() - {"text/plain"} <= {"text/html", "image/svg+xml"}
        if found.data["text/plain"].startswith("<"):  # a result of tachk, not a data frame
            assert len(found.data["text/plain"]) < 200
    assert any("image/svg+xml" in found.data or "<svg" in found.data.get("text/html", "") for found in shown)


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_notebooks_come_without_outputs(name: str) -> None:
    assert all(
        not cell.outputs and cell.execution_count is None for cell in notebook(name).cells if cell.cell_type == "code"
    )


def test_the_notebooks_say_what_their_words_say() -> None:
    def text(name: str) -> str:
        return "\n".join(found.data["text/plain"] for found in outputs(name) if found.output_type == "execute_result")

    first = text("first_model")
    assert "never_stuck: fails, paid_for: fails" in first and "never_stuck: holds, paid_for: holds" in first
    assert "q1: holds, q2: holds, q3: Person.y ≤ 10 s" in first
    (error,) = (found for found in outputs("first_model") if found.output_type == "error")
    assert error.traceback[1].startswith("<text>:1:36: error[E0209]")
    assert "safe holds in 78 of 144 cells" in text("sweep_and_plots")
    log = text("monitoring_a_log")
    assert "p1: false, p2: true, p3: true" in log and "least T = 60" in log and "answered: fails" in log
