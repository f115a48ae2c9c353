"""The action of `tachk measure`."""

from __future__ import annotations

import sys
from pathlib import Path

from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass
from tachk.base.time_units import length_of
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus
from tachk.report.json_text import json_text
from tachk.xrce.conformance.packet_events import read_capture
from tachk.xrce.measuring.measure import measure
from tachk.xrce.report.measurement import ModelTime, measurement_to_json, measurement_to_text, settings_line


@dataclass(frozen=True, slots=True)
class MeasureArguments:
    """``form``: text, json or settings; ``model``: whose constants settings are, if any."""

    files: tuple[Path, ...]
    ports: tuple[int, ...]
    model: str | None
    form: str
    output: Path | None


def run_measure(measuring: MeasureArguments) -> ExitStatus:
    """Raises UsageError for a file that is no capture, for a model without a unit of time, and for a capture with
    something of which a model for recordings does not speak."""
    time = _time_of(measuring.model)
    if time.is_for_recordings:
        for file in measuring.files:
            read_capture(file, measuring.ports)  # refuses what such a model does not speak of
    found = measure(*measuring.files, ports=measuring.ports)
    for problem in found.problems:
        print(f"warning: {problem}", file=sys.stderr)
    with destination(measuring.output) as out:
        match measuring.form:
            case "json":
                text = json_text(measurement_to_json(found, time))
            case "settings":
                text = settings_line(found, time) + "\n"
            case _:
                text = measurement_to_text(found, time)
        print(text, end="", file=out)
    return ExitStatus.AS_EXPECTED


def _time_of(path: str | None) -> ModelTime:
    if path is None:
        return ModelTime()
    model = api.load(path)
    network = model.network
    unit = length_of(network.time_unit) if network.time_unit else None
    if unit is None:
        raise UsageError(
            f"{path} does not say how long its unit of time is", "settings need that: time_unit = 1 ms; in the model"
        )
    names = frozenset(name for name, _ in network.constants)
    return ModelTime(float(unit / 10**6), names, path, model.loaded.recording is not None)
