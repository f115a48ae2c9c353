"""The mapping between recordings of a real system and a network: the ``recording { ... }`` of a model."""

from __future__ import annotations

from collections.abc import Mapping

from tachk.base.records import dataclass, field
from tachk.base.span import NOWHERE, Span
from tachk.base.words import Direction
from tachk.model.expressions import Constant, Expression, Variable
from tachk.model.network import Network
from tachk.model.timestamp_uncertainty import Allowances


@dataclass(frozen=True, slots=True)
class VisibleEvents:
    """Synchronisations that a recording shows, all of them, and nothing else as these.

    Attributes:
        channel: the channel, or the array of channels.
        indices: for each dimension of the array a constant, or a variable that stands for what the recording says.
        event: the name of these events in the recording.
        columns: what a recorded event says, by name: an expression of the indices, and of what variables hold and where
            processes are at the end of the step.
        per: the indices that the events of a stream have in common. The events of a stream happen in their recorded
            order, those of different streams as their times allow.
        direction: whether the model sends or receives; None: as the processes show that are left.
        words: of columns that show in which location a process is: the values that stand for its locations, by name.
    """

    channel: Expression
    indices: tuple[Constant | Variable, ...]
    event: str
    columns: tuple[tuple[str, Expression], ...]
    per: tuple[Variable, ...] = ()
    direction: Direction | None = None
    span: Span = NOWHERE
    words: Mapping[str, Mapping[str, int]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class RecordedModel:
    """Attributes:
    path: of the file, relative to the one that names it.
    constants: what constants of it are.
    """

    path: str
    constants: tuple[tuple[str, int], ...]


@dataclass(frozen=True, slots=True)
class RecordingMap:
    """Attributes:
    replaced: the numbers of the processes whose place the recording takes.
    hidden: channels, or arrays of channels, on which what is replaced may synchronise whenever it likes.
    allowances: what the model says of how exact recorded times are.
    model: the model that recordings are held against in place of this one; then the rest says nothing.
    """

    replaced: frozenset[int]
    visible: tuple[VisibleEvents, ...]
    hidden: tuple[Expression, ...]
    allowances: Allowances = Allowances()
    model: RecordedModel | None = None
    span: Span = NOWHERE

    def modelled(self, network: Network) -> tuple[int, ...]:
        """The numbers of the processes whose place the recording does not take."""
        return tuple(number for number in range(len(network.processes)) if number not in self.replaced)
