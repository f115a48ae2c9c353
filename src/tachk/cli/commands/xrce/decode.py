"""`tachk xrce decode`: print the DDS-XRCE messages in a capture, a line for each submessage."""

from __future__ import annotations

import json
import sys
from contextlib import nullcontext
from pathlib import Path
from typing import Any, Final

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass
from tachk.cli import options
from tachk.cli.destination import destination
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus


@click.command(name="decode")
@click.argument("file", metavar="FILE", type=options.type_of_file)
@options.agent_ports(
    "The UDP or TCP port of an Agent, or of a proxy in front of it. Can be given several times. "
    "Without it 8888, and with --signals each port to which a session is created."
)
@click.option(
    "--serial",
    is_flag=True,
    help="FILE holds the bytes of a serial line, with eProsima's framing: alone, or as the packets of a capture.",
)
@click.option(
    "form", "--format", type=click.Choice(["text", "jsonl"]), default="text", show_default=True, help="Form of a line."
)
@click.option(
    "signals",
    "--signals",
    metavar="FILE",
    type=options.written_file,
    help="Write what each stream has sent, acknowledged and lost over time to a .csv or .parquet file; print no lines.",
)
@click.option("output", "-o", "--output", metavar="FILE", type=options.written_file, help="Write the lines to a file.")
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Print the DDS-XRCE messages in a capture, a line for each submessage.

    FILE is a pcap or pcapng capture; - reads one from standard input as it comes, for instance from tcpdump -w -.
    What goes to or from the port and is not a message of DDS-XRCE gets a line that says malformed, and why.

    The exit status is 0 if FILE is a capture, whatever is in it, and 2 if it is not.
    """

    arguments = distributed(given, Decoding)
    options.finish(lambda: run_decode(*arguments), seconds)


_ANY_PORT: Final = "give the port of the Agent with --port"


@dataclass(frozen=True, slots=True)
class Decoding:
    """Attributes:
    serial: the file holds the bytes of a serial line.
    form: text or jsonl.
    signals: where signals over time go; None: the events are printed.
    """

    file: Path
    ports: tuple[int, ...]
    serial: bool
    form: str
    signals: Path | None
    output: Path | None


def run_decode(decoding: Decoding) -> ExitStatus:
    """Raises UsageError for a file that is not a capture."""
    from tachk.xrce.events import DEFAULT_PORT, decode, decode_serial
    from tachk.xrce.packets import CaptureError
    from tachk.xrce.report.json import event_to_json
    from tachk.xrce.report.text import event_to_text

    if decoding.signals is not None:
        return _write_signals(decoding, decoding.signals)
    is_input = str(decoding.file) == "-"
    found = 0
    with (
        nullcontext(sys.stdin.buffer) if is_input else decoding.file.open("rb") as stream,
        destination(decoding.output) as out,
    ):
        start = None
        try:
            for event in (
                decode_serial(stream) if decoding.serial else decode(stream, decoding.ports or (DEFAULT_PORT,))
            ):
                start = event.time if start is None else start
                found += 1
                if decoding.form == "text":
                    print(event_to_text(event, start), file=out, flush=is_input)
                else:
                    print(json.dumps(event_to_json(event), ensure_ascii=False), file=out, flush=is_input)
        except CaptureError as error:
            raise UsageError(
                f"{decoding.file}: {error}",
                "tcpdump -i any -w FILE.pcap udp port 8888 makes a capture; --serial reads the bytes of a serial line",
            ) from None
    if not found and not decoding.serial:
        ports = ", ".join(map(str, decoding.ports or (DEFAULT_PORT,)))
        where = _where(decoding.file) if not is_input else ""
        print(f"no packet to or from port {ports}; {where or _ANY_PORT}", file=sys.stderr)
    return ExitStatus.AS_EXPECTED


def _where(path: Path) -> str:
    """With which options messages are found in a capture; empty if that is not known."""
    from tachk.xrce.events import decode_serial
    from tachk.xrce.signals.recorded import read_recorded

    with path.open("rb") as stream:
        ports = sorted({client.agent.port for client in read_recorded(stream, (), signals=False).clients})
    if ports:
        created = f"port {ports[0]}" if len(ports) == 1 else f"the ports {', '.join(map(str, ports))}"
        return f"sessions are created at {created}: try --port {ports[0]}"
    with path.open("rb") as stream:
        if any(event.kind is not None for event in decode_serial(stream)):
            return "the packets hold a serial line: try --serial"
    return ""


def _write_signals(decoding: Decoding, to: Path) -> ExitStatus:
    if decoding.serial:
        raise UsageError("bytes of a serial line have no times, which signals need", "leave out --serial, or --signals")
    if decoding.output is not None:
        raise UsageError("--signals says where signals go, --output where lines go", "give one of the two")
    from tachk.xrce.traces.signal_files import write_signals
    from tachk.xrce.traces.trace_packets import open_packets

    write_signals(open_packets(decoding.file, None, None, decoding.ports).read(), to)
    return ExitStatus.AS_EXPECTED
