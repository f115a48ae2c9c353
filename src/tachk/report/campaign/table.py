"""What a campaign has found, as a table that can be written in every form."""

from __future__ import annotations

import csv
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.whole_files import whole_file
from tachk.report.campaign.text import campaign_text
from tachk.report.json_report import Json
from tachk.verify.campaign.job import COLUMNS, Row
from tachk.verify.campaign.run import Campaign


@dataclass(frozen=True, slots=True)
class Sweep:
    """One row for each combination of values and each property.

    Attributes:
        model: the path as given.
    """

    model: str
    campaign: Campaign = field(repr=False)

    @property
    def rows(self) -> tuple[Row, ...]:
        """Each a flat dictionary: ``pandas.DataFrame(sweep.rows)``."""
        return self.campaign.rows

    @property
    def columns(self) -> tuple[str, ...]:
        return (*self.campaign.grid.names, *COLUMNS)

    def to_dict(self) -> dict[str, Json]:
        """What docs/schema/sweep.schema.json describes."""
        campaign = self.campaign
        return {
            "model": self.model,
            "constants": [{"name": axis.name, "values": list(axis.values)} for axis in campaign.grid.axes],
            "cells": campaign.cells,
            "unfinished": campaign.unfinished,
            "interrupted": campaign.interrupted,
            "rows": [dict(row) for row in self.rows],
        }

    def to_csv(self) -> str:
        out = StringIO()
        writer = csv.DictWriter(out, self.columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(self.rows)
        return out.getvalue()

    def to_parquet(self, path: str | Path) -> None:
        """Writes a file. Raises UsageError where pyarrow is not installed."""
        try:
            import pyarrow
            from pyarrow import parquet
        except ImportError:
            raise UsageError("Parquet files need pyarrow", "pip install 'tachk[parquet]'") from None
        kinds = {"TEXT": pyarrow.string(), "INTEGER": pyarrow.int64(), "REAL": pyarrow.float64()}
        columns: dict[str, Any] = {name: [row[name] for row in self.rows] for name in self.columns}
        for axis in self.campaign.grid.axes:
            if not all(isinstance(value, int) for value in axis.values):
                columns[axis.name] = list(map(str, columns[axis.name]))
        arrays = {
            name: pyarrow.array(values, kinds[COLUMNS[name]]) if name in COLUMNS else pyarrow.array(values)
            for name, values in columns.items()
        }
        with whole_file(Path(path)) as part:
            parquet.write_table(pyarrow.table(arrays), part)

    def to_text(self) -> str:
        """What `tachk sweep` prints."""
        return campaign_text(self.model, self.campaign)

    def plot(self, path: str | Path, show: str = "answer") -> None:
        """Draws a heat map for each property.

        Args:
            path: its ending says the format.
            show: the column that is drawn, such as ``states_stored``.

        Raises UsageError for an unknown format or column, or more maps than a picture can show.
        """
        from tachk.report.campaign.heat_map import plot_campaign

        plot_campaign(self.model, self.campaign, path, show)

    def __str__(self) -> str:
        return self.to_text()
