"""DDS-XRCE as a reader of captures: `tachk.recordings.captures.CaptureReader`. Loads nothing before it reads."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from tachk.base.diagnostics.diagnostic import UsageError

if TYPE_CHECKING:
    from tachk.recordings.conformance.event_streams import Constants
    from tachk.recordings.conformance.events import Cell, EventLog
    from tachk.recordings.traces.trace import TraceSource

CLIENT = "client"
"""The column of clients in events in the words of `models/micro_xrce_dds/protocol.ta`."""

_CONSTANTS = {
    "TOPICS": "topics, those from which nobody reads counted as one",
    "READERS": "data readers a client at most, as many for each topic",
    "LIMITED_READS": "kind of READ_DATA that is limited or cancels",
    "READ_SECONDS": "s as max_elapsed_time of READ_DATA",
    "CANCELS": "kind of READ_DATA for 0 samples",
    "READ_BYTES": "octets a second as max_bytes_per_second of READ_DATA",
    "SAMPLE_BYTES": "octets in a sample",
}
"""What constants of the automata count that a recording gives."""
_PLAIN = {"TOPICS": 1, "READERS": 1}
"""The values of those that are not 0 in a model that does not declare them."""


class DdsXrce:
    """Captures of the packets between clients and Agents."""

    suffixes = (".pcap", ".pcapng")

    def open_trace(self, path: Path, time: str | None, unit: str | None, ports: Sequence[int]) -> TraceSource:
        from tachk.xrce.traces.trace_packets import open_packets

        return open_packets(path, time, unit, ports)

    def read_events(self, path: Path, ports: Sequence[int]) -> EventLog:
        from tachk.xrce.conformance.packet_events import read_capture

        return read_capture(path, ports)

    def samples_in(self, detail: Cell | None) -> int:
        from tachk.xrce.conformance.payloads import samples_in

        return samples_in(detail)

    def check_room(self, recording: EventLog, constants: Constants) -> None:
        from tachk.xrce.conformance.payloads import BEST_EFFORT, PieceCounter

        largest, clients, best_effort, pieces = 0, set[str](), False, PieceCounter()
        for event in recording.events:
            cells = event.cells
            if CLIENT in cells:
                clients.add(str(cells[CLIENT]).strip())  # a log has text where a capture has numbers
                detail = cells.get("detail")
                largest = max(largest, detail) if isinstance(detail, int) else largest
                best_effort |= cells.get("kind") == BEST_EFFORT
            pieces.add(event)
        for name, found, what in (
            ("CLIENTS", len(clients), "clients (or sessions)"),
            ("PIECES", pieces.most(), "pieces of one sample before its last one"),
            ("LARGEST_WORD", largest, "as content of a message that carries several samples"),
        ):
            known = constants(name)
            if known is not None and found > known:
                raise UsageError(
                    f"{recording.source} has {found} {what}, but the model {known}", f"set -D {name}={found}"
                )
        for name, wanted in recording.constants.items():
            known = constants(name)
            plain = _PLAIN.get(name, 0)
            if (plain if known is None else known) != wanted:
                what = _CONSTANTS[name]
                raise UsageError(
                    f"{recording.source} has {wanted} {what}, but the model {plain if known is None else known}",
                    f"set -D {name}={wanted}",
                )
        if best_effort and constants("BEST_EFFORT_STREAMS") == 0:
            raise UsageError(
                f"{recording.source} has messages of best-effort streams, but the model has no such streams",
                "set -D BEST_EFFORT_STREAMS=true",
            )


DDS_XRCE = DdsXrce()
