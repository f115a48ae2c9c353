"""Results as data frames of pandas, which is an extra."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from tachk.base.optional_packages import optional_packages


def data_frame(table: Sequence[Mapping[str, object]] | Mapping[str, object]) -> Any:
    """A `pandas.DataFrame` of rows, or of columns by their names.

    Columns of whole numbers stay whole where some are missing: their type is pandas' ``Int64`` then.

    Raises:
        MissingPackageError: pandas is not installed.
    """
    with optional_packages():
        import pandas
    frame = pandas.DataFrame(table if isinstance(table, Mapping) else list(table))
    for name in frame.columns:
        if frame[name].isna().any() and not isinstance(table, Mapping):
            present = [row[name] for row in table if row.get(name) is not None]
            if present and all(type(value) is int for value in present):
                frame[name] = pandas.array([row.get(name) for row in table], dtype="Int64")
    return frame
