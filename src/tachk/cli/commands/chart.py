"""`tachk chart`: draw a sequence chart of a capture or of a run."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import DIGITS
from tachk.base.records import dataclass
from tachk.base.whole_files import write_whole
from tachk.cli import options
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.formats.written_reports import check_report, read_json
from tachk.report.drawing.png import to_png

if TYPE_CHECKING:
    from tachk.report.drawing.sequence.chart import Chart
    from tachk.report.drawing.sequence.layout import TimeAxis
    from tachk.report.sequence.run_steps import RunSteps


@click.command(name="chart")
@click.argument("file", metavar="FILE", type=options.type_of_file)
@click.option(
    "output",
    "-o",
    "--output",
    metavar="FILE",
    type=options.written_file,
    default=Path("chart.svg"),
    show_default=True,
    help="An .svg or .png file.",
)
@click.option(
    "begin", "--from", metavar="TIME", help="Draw from this time, such as 2.5 s or 300 ms; a number counts seconds."
)
@click.option("end", "--to", metavar="TIME", help="Draw up to this time.")
@click.option(
    "axis",
    "--time",
    type=click.Choice(["compressed", "scale"]),
    default="compressed",
    show_default=True,
    help="compressed: a line for each message; scale: equal times are equal lengths. Long silences are left out.",
)
@click.option(
    "name",
    "--property",
    metavar="NAME",
    help="Of a report of tachk verify: the run about this property; without this option the first run.",
)
@options.agent_ports(
    "Of a capture: the port of an Agent, or of a proxy in front of it; without this option 8888 and "
    "every port at which a session is created. Can be given several times."
)
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Draw a sequence chart: who sent which message to whom, and which were lost.

    FILE is a pcap or pcapng capture of DDS-XRCE, or a report with runs: tachk verify MODEL --trace some --format json.
    """

    arguments = distributed(given, ChartArguments)
    options.finish(lambda: run_chart(*arguments), seconds)


MOST_EVENTS = 1000
"""A chart of more is not readable."""

_TIME = re.compile(rf"\s*({DIGITS}(?:\.{DIGITS})?)\s*([a-zµμ]+)?\s*")


@dataclass(frozen=True, slots=True)
class ChartArguments:
    """Arguments of `tachk chart`."""

    file: Path
    output: Path
    begin: str | None
    end: str | None
    axis: str
    name: str | None
    ports: tuple[int, ...]


def run_chart(arguments: ChartArguments) -> ExitStatus:
    """Raises UsageError for what cannot be drawn."""
    from tachk.report.drawing.sequence.layout import TimeAxis
    from tachk.report.sequence.repetitions import shown_once

    chart = _read(arguments)
    part = chart.part(_time(arguments.begin, chart.unit), _time(arguments.end, chart.unit))
    axis = TimeAxis(arguments.axis)
    write_chart(part.used() if axis is TimeAxis.SCALE else shown_once(part.used()), arguments.output, axis)
    print(f"written: {arguments.output}")
    return ExitStatus.AS_EXPECTED


def _read(arguments: ChartArguments) -> Chart:
    from tachk.cli.arguments import MODEL_SUFFIXES
    from tachk.report.sequence.of_run import chart_of_run
    from tachk.xrce.packets import CaptureError
    from tachk.xrce.report.sequence_chart import chart_of_capture
    from tachk.xrce.transmissions import read_transmissions

    if arguments.file.suffix in MODEL_SUFFIXES:
        raise UsageError(
            f"{arguments.file} is a model; a chart shows a run of it, or a capture",
            f"for a run: tachk verify {arguments.file} --format json -o run.json; tachk chart run.json",
        )
    with arguments.file.open("rb") as stream:
        is_report = stream.read(1) in (b"{", b" ", b"\n")
    if is_report:
        return chart_of_run(_report(arguments))
    if arguments.name is not None:
        raise UsageError(f"{arguments.file}: --property chooses among the runs of a report of tachk verify")
    try:
        recording = read_transmissions(arguments.file, arguments.ports)
    except CaptureError as error:
        raise UsageError(
            f"{arguments.file}: {error}", "tcpdump -i any -w FILE.pcap udp port 8888 makes a capture"
        ) from None
    if not recording.transmissions:
        raise UsageError(
            f"{arguments.file}: no message to or from the ports of an Agent", "--port says where the Agent listens"
        )
    return chart_of_capture(recording, arguments.file.name)


def _report(arguments: ChartArguments) -> RunSteps:
    from tachk.report.sequence.run_steps import steps_of_report

    how = "a report of tachk verify --format json is expected"
    document = read_json(arguments.file, how)
    if isinstance(document.get("runs"), list):
        check_report(document, "verify", arguments.file, how)
    return steps_of_report(document, str(arguments.file), arguments.name)


def check_chart_file(output: Path) -> None:
    """Raises UsageError where a chart cannot be written to a file of this name."""
    if output.suffix.lower() not in (".svg", ".png"):
        raise UsageError(f"{output}: charts are written as .svg or .png", "the ending of the name decides")
    if not output.parent.is_dir():
        raise UsageError(f"there is no folder {output.parent} for the chart", "make it first")


def write_chart(chart: Chart, output: Path, axis: TimeAxis) -> None:
    """Writes the picture; the ending of the name says in which format. Raises UsageError."""
    from tachk.report.drawing.sequence.layout import lay_out
    from tachk.report.drawing.sequence.sequence_svg import draw_chart

    check_chart_file(output)
    if not chart.events:
        raise UsageError("there is nothing to draw: no message is sent", "--from and --to may leave everything out")
    if len(chart.events) > MOST_EVENTS:
        raise UsageError(
            f"a chart of {len(chart.events)} messages is not readable; at most {MOST_EVENTS} are drawn",
            "--from and --to choose a part",
        )
    picture = draw_chart(lay_out(chart, axis))
    if output.suffix.lower() == ".png":
        write_whole(output, to_png(picture.svg))
    else:
        write_whole(output, picture.svg)


def _time(text: str | None, unit: str) -> Fraction | None:
    """A time in the unit of a chart; a number without unit counts seconds, or units where the chart has none."""
    from tachk.base.time_units import length_of

    if text is None:
        return None
    match = _TIME.fullmatch(text)
    given = "s" if match is None or match[2] is None else match[2]
    length, of_chart = length_of(given), length_of(unit) if unit else None
    if match is None or length is None:
        raise UsageError(f"{text!r} is not a time", "write it like 300 ms or 2.5 s; a number counts seconds")
    return Fraction(match[1]) * (length / of_chart if of_chart else 1)
