"""`P.loc` where rows come one by one: a row that gives `P` a text, and `P.loc` nothing, says whether that is ``loc``.

Where all columns are known beforehand, `tachk.recordings.monitors.locations` writes `P == "loc"` into the formula.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from tachk.recordings.traces.arrivals import topic_of
from tachk.recordings.traces.trace_arrays import is_missing

LocationNames = Mapping[str, tuple[str, str]]
"""Names such as `P.loc`, with the column `P` and the text `loc`."""


def location_names(names: Iterable[str]) -> LocationNames:
    """The names that may be locations of processes."""
    parts = {name: name.rpartition(".") for name in names if topic_of(name) is None}
    return {name: (process, location) for name, (process, _, location) in parts.items() if process and location}


def locations_in(names: LocationNames, row: Mapping[str, Any]) -> dict[str, bool]:
    """The truth of the names in a row, by the texts in it."""
    return {
        name: row[process] == location
        for name, (process, location) in names.items()
        if name not in row and isinstance(row.get(process), str)
    }


def locations_in_columns(names: LocationNames, columns: Mapping[str, Any]) -> dict[str, Any]:
    """The columns of the names, from columns of texts. What has no text has no value."""
    found = {}
    for name, (process, location) in names.items():
        if name in columns or process not in columns:
            continue
        cells = [None if is_missing(cell) else cell for cell in np.asarray(columns[process], dtype=object).tolist()]
        if all(cell is None or isinstance(cell, str) for cell in cells):
            found[name] = np.array([None if cell is None else cell == location for cell in cells], dtype=object)
    return found
