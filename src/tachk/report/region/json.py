"""A region for programs: plain dictionaries that follow docs/schema/synthesize.schema.json, and rows of a table."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from io import StringIO

from tachk.base.plain_data import Fields, PlainData
from tachk.model.run import TimedTrace
from tachk.report.json_report import Json
from tachk.report.region.words import inequalities, knowledge
from tachk.verify.synthesis.bounds_of_parameters import NoBound
from tachk.verify.synthesis.region import Region, RegionCell

Row = Mapping[str, str | int | float | None]


def region_to_json(region: Region) -> dict[str, Json]:
    words = dict(knowledge(region))
    return {
        "model": region.model,
        "property": region.query.name,
        "query": region.query.text,
        "wanted": region.wanted.value,
        "constants": dict(region.constants),
        "parameters": [
            {
                **_PLAIN.of(parameter),
                "bound": None if isinstance(bound, NoBound) else bound.value,
                "why": words[parameter.name],
            }
            for parameter, bound in zip(region.parameters, region.bounds, strict=True)
        ],
        "inequalities": inequalities(region) or None,
        "cells": [_cell(region, cell) for cell in region.cells],
        "corners": [_values(region, cell) for cell in region.corners],
        "searched": region.searched,
        "interrupted": region.interrupted,
        "seconds": region.seconds,
    }


def _cell(region: Region, cell: RegionCell) -> dict[str, Json]:
    return {"values": _values(region, cell), **_PLAIN.of(cell)}


def _values(region: Region, cell: RegionCell) -> dict[str, int]:
    return {parameter.name: value for parameter, value in zip(region.parameters, cell.values, strict=True)}


def row_of(region: Region, cell: RegionCell) -> Row:
    """A cell as one flat row."""
    return {**_values(region, cell), **_PLAIN.of(cell)}


def _run(cell: RegionCell) -> TimedTrace | None:
    return None if cell.verdict is None else cell.verdict.trace


_PLAIN = PlainData(
    {
        RegionCell: Fields(
            "answer evidence reason states_stored=verdict.statistics.states_stored run_steps run_end "
            "certificate_zones=certificate.zones",
            run_steps=lambda cell: None if (run := _run(cell)) is None else len(run.path),
            run_end=lambda cell: None if (run := _run(cell)) is None else float(run.states[-1].time),
        )
    }
)


def region_to_csv(region: Region) -> str:
    """One line for each cell."""
    out = StringIO()
    rows = [row_of(region, cell) for cell in region.cells]
    writer = csv.DictWriter(out, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return out.getvalue()
