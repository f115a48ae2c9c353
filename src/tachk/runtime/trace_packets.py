"""Captures of packets as traces: what reliable streams of DDS-XRCE have sent, acknowledged and lost, over time.

The columns of a client are named after its key, or its port where the capture does not hold its CREATE_CLIENT:
``client_AAAABBBB.to_agent.outstanding``; a stream other than 80 is named: ``to_agent_81``. Where one client is seen
at several ports of an Agent, because a relay was recorded on both sides, ``_at_9001`` follows its name.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from tachk.diagnostics.diagnostic import UsageError
from tachk.runtime.trace import Trace, Values
from tachk.runtime.trace_header import no_such_column
from tachk.time_units import NANOSECONDS
from tachk.xrce.events import DEFAULT_PORT
from tachk.xrce.packets import CaptureError
from tachk.xrce.streams import SIGNALS, StreamHistory, Streams, read_streams
from tachk.xrce.wire import FIRST_RELIABLE_STREAM

_UNIT = "s"


@dataclass(frozen=True, slots=True, eq=False)
class PacketRecording:
    """``signals``: where each column comes from."""

    name: str
    streams: Streams
    signals: dict[str, tuple[StreamHistory, str]]
    unit: str = _UNIT

    @property
    def columns(self) -> tuple[str, ...]:
        return tuple(self.signals)

    def read(self, columns: Collection[str] | None = None) -> Trace:
        wanted = self.columns if columns is None else columns
        for column in wanted:
            if column not in self.signals:
                raise no_such_column(column, self.columns, self.name)
        times = self.streams.times
        start = int(times[0])
        return Trace(
            self.name,
            times - start,
            {column: self._values(column) for column in self.columns if column in wanted},
            int(times[-1]) - start,
            NANOSECONDS[_UNIT],
            _UNIT,
            Fraction(0),
        )

    def _values(self, column: str) -> Values:
        history, signal = self.signals[column]
        return history.signal(signal, len(self.streams.times)).astype(float)


def open_packets(path: Path, time: str | None, unit: str | None, ports: Sequence[int]) -> PacketRecording:
    """Reads a capture. Its times are in seconds since its first message to or from an Agent.

    Args:
        ports: of Agents; without any, 8888.

    Raises UsageError, also where nothing is from or for these ports.
    """
    if time is not None or unit is not None:
        raise UsageError("a capture has its own times: it takes neither a time column nor a unit")
    try:
        with path.open("rb") as stream:
            streams = read_streams(stream, ports or (DEFAULT_PORT,))
    except CaptureError as error:
        raise UsageError(f"{path}: {error}") from None
    except FileNotFoundError:
        raise UsageError(f"there is no file {path}") from None
    if streams.problem:
        raise UsageError(f"{path}: {streams.problem}", f"tachk decode {path} tells what comes before")
    if not len(streams.times):
        asked = ", ".join(map(str, ports or (DEFAULT_PORT,)))
        raise UsageError(f"{path} has no packet to or from port {asked}", "give the port of the Agent with --port")
    return PacketRecording(str(path), streams, dict(_signals(streams)))


def _signals(streams: Streams) -> Iterator[tuple[str, tuple[StreamHistory, str]]]:
    seen = Counter(name for name, _ in {(_client(history), history.agent.port) for history in streams.histories})
    for history in streams.histories:
        client = _client(history)
        place = f"_at_{history.agent.port}" if seen[client] > 1 else ""
        way = "to_agent" if history.to_agent else "from_agent"
        other = "" if history.stream == FIRST_RELIABLE_STREAM else f"_{history.stream:02X}"
        for signal in SIGNALS:
            yield f"{client}{place}.{way}{other}.{signal}", (history, signal)


def _client(history: StreamHistory) -> str:
    return f"client_{history.key or history.client.port}"
