"""Logs whose first rows do not give all columns a value: every reader begins with the first row that is complete."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.trace_files import open_trace

NONE = float("nan")
COLUMNS: dict[str, list[Any]] = {
    "t": [0.0, 0.5, 1.0, 2.5, 3.0],
    "x": [NONE, 4.0, NONE, 9.0, 3.0],
    "mode": [None, None, "on", None, "off"],
}


def forms(folder: Path) -> dict[str, Any]:
    frame = pd.DataFrame(COLUMNS)
    frame.to_csv(folder / "a.csv", index=False)
    frame.to_parquet(folder / "a.parquet")
    arrays = {name: np.array(cells, dtype=object if name == "mode" else None) for name, cells in COLUMNS.items()}
    shifted = frame.set_index(pd.Index([7, 8, 9, 10, 11]))
    return {
        "csv": folder / "a.csv",
        "parquet": folder / "a.parquet",
        "frame": frame,
        "shifted": shifted,
        "index": frame.set_index("t"),
        "lists": COLUMNS,
        "arrays": arrays,
    }


@pytest.mark.parametrize(
    ("formula", "rows"), [("G (x > 3)", 1), ('F (mode == "off" && x < 4)', 2), ("G[0, 1] (x <= 4)", 1)]
)
def test_readers_agree(formula: str, rows: int, tmp_path: Path) -> None:
    told = {}
    for name, trace in forms(tmp_path).items():
        report: Any = tachk.monitor(formula, trace).to_dict()
        result = report["results"][0]
        told[name] = (report["end"], result["verdict"], result["robustness"], report["notes"])
    which = "the first row is" if rows == 1 else "the first 2 rows are"
    expected = [f"{which} left out: until then, some column that is read has no value"]
    assert all(each == told["csv"] and each[-1] == expected for each in told.values()), told


def test_a_column_without_values(tmp_path: Path) -> None:
    frame = pd.DataFrame({"t": [0, 1], "x": [NONE, NONE]})
    frame.to_csv(tmp_path / "a.csv", index=False)
    for trace in (frame, tmp_path / "a.csv"):
        with pytest.raises(UsageError, match="column 'x' never has a value"):
            open_trace(trace).read(["x"])


def test_rows_of_errors_are_those_of_the_table() -> None:
    with pytest.raises(UsageError, match="time of row 3 lies before"):
        open_trace({"t": [0, 1, 2, 1], "x": [NONE, 1, 2, 3]}).read()
    with pytest.raises(UsageError, match="7 in row 3"):
        open_trace({"t": [0, 1, 2, 3], "x": np.array([None, "a", "b", 7], dtype=object)}).read()
