"""An event of a run."""

from __future__ import annotations

from tachk.base.records import dataclass
from tachk.base.words import Direction
from tachk.model.expressions import Expression


@dataclass(frozen=True, slots=True)
class BecomesTrue:
    """A condition, without clocks and ``deadlock``, becomes true; at the start of a run if it is true there.

    Attributes:
        settled: it does not count where a process is in a committed location.
    """

    condition: Expression
    settled: bool = False


@dataclass(frozen=True, slots=True)
class Fires:
    """A synchronisation over a channel, or over any of an array of channels.

    Attributes:
        channel: a channel variable, perhaps with indices that do not depend on the state.
        direction: SEND for each sender's edge, RECEIVE for each receiver's.
    """

    channel: Expression
    direction: Direction


Event = BecomesTrue | Fires
