"""What the events of a recording must be so that a test can exchange them with a system."""

from __future__ import annotations

from collections.abc import Sequence

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.words import Direction
from tachk.model.expressions import Constant, Expression, Index
from tachk.model.network import Network, Process
from tachk.model.recording import RecordingMap, VisibleEvents
from tachk.recordings.conformance.event_streams import channel_variable
from tachk.simulation.testing.event_columns import is_broadcast
from tachk.simulation.testing.event_lines import EVENT, TIME


def check_visible(network: Network, mapping: RecordingMap, visible: VisibleEvents) -> None:
    """Raises UsageError for columns that are named as what each event has, and for a channel on which the environment
    talks to itself: `tachk conform` and the system know nothing of such a step."""
    for name, _ in visible.columns:
        if name in (EVENT, TIME):
            raise UsageError(f"`{visible.event}` has a column `{name}`, as each event has", "give it another name")
    if is_broadcast(visible):
        return
    replaced = [process for n, process in enumerate(network.processes) if n in mapping.replaced]
    sender, receiver = (_first(replaced, visible, direction) for direction in (Direction.SEND, Direction.RECEIVE))
    if sender is not None and receiver is not None:
        raise UsageError(
            f"`{visible.event}` may go from {sender.name} to {receiver.name}, which are both replaced",
            "let each visible channel be between the environment and the system",
        )


def _first(processes: Sequence[Process], visible: VisibleEvents, direction: Direction) -> Process | None:
    """The first process with an edge that may be such an event."""
    for process in processes:
        for edge in process.edges:
            sync = edge.synchronisation
            if sync is not None and sync.direction is direction and _may_be(sync.channel, visible):
                return process
    return None


def _may_be(channel: Expression, visible: VisibleEvents) -> bool:
    if channel_variable(channel) is not channel_variable(visible.channel):
        return False
    indices: list[Expression] = []
    while isinstance(channel, Index):
        indices.insert(0, channel.index)
        channel = channel.base
    return not any(
        isinstance(one, Constant) and isinstance(other, Constant) and one.value != other.value
        for one, other in zip(indices, visible.indices, strict=True)
    )
