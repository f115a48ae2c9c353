"""`tachk xrce measure`: measure the parameters of a DDS-XRCE system in captures of it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass
from tachk.cli import options
from tachk.cli.destination import destination
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.report.json_text import json_pieces

if TYPE_CHECKING:
    from tachk.xrce.report.measurement import ModelTime


@click.command(name="measure")
@click.argument("files", metavar="FILE...", nargs=-1, required=True, type=options.type_of_file)
@options.agent_ports(
    "The port of an Agent, or of a proxy in front of it; without this option 8888 and every port at "
    "which a session is created. Can be given several times."
)
@click.option(
    "model",
    "--for",
    metavar="MODEL",
    type=click.Path(),
    help="Write settings in the unit of time of this model, and only constants that it has; without this option in "
    "milliseconds.",
)
@click.option(
    "form",
    "--format",
    type=click.Choice(["text", "json", "settings"]),
    default="text",
    show_default=True,
    help="Form of the report; settings: a line of -D options for tachk verify, or for tachk conform if the model has a "
    "`recording`.",
)
@click.option("output", "-o", "--output", metavar="FILE", type=options.written_file, help="Write the report to a file.")
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Measure the parameters of a DDS-XRCE system in captures of it.

    FILE is a pcap or pcapng capture; several are put together. Heartbeats, round trips, repairs, windows, losses and
    dead time are printed with minimum, median and maximum, the packets they came from and how sure they are, and as
    constants of a model: tachk verify MODEL $(tachk xrce measure FILE --for MODEL --format settings)
    """

    arguments = distributed(given, MeasureArguments)
    options.finish(lambda: run_measure(*arguments), seconds)


@dataclass(frozen=True, slots=True)
class MeasureArguments:
    """``form``: text, json or settings; ``model``: whose constants settings are, if any."""

    files: tuple[Path, ...]
    ports: tuple[int, ...]
    model: str | None
    form: str
    output: Path | None


def run_measure(measuring: MeasureArguments) -> ExitStatus:
    """Raises UsageError for a file that is not a capture, for a model without a unit of time, and for a capture with
    something of which a model for recordings does not speak."""
    from tachk.xrce.conformance.packet_events import read_capture
    from tachk.xrce.measuring.measure import measure
    from tachk.xrce.report.measurement import measurement_to_json, measurement_to_text, settings_line

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
                pieces = json_pieces(measurement_to_json(found, time))
            case "settings":
                pieces = iter([settings_line(found, time) + "\n"])
            case _:
                pieces = iter([measurement_to_text(found, time)])
        (out or sys.stdout).writelines(pieces)
    return ExitStatus.AS_EXPECTED


def _time_of(path: str | None) -> ModelTime:
    from tachk.api import model as api
    from tachk.base.time_units import length_of
    from tachk.xrce.report.measurement import ModelTime

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
