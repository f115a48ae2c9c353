"""Proposed edges tried on the events near the place where a recording leaves the model.

One search tries many of them: a variable says which edge is the one, and is set when that is taken first. Where an
edge makes a difference before it is taken, since a process that can receive a broadcast must, and since no time passes
where an urgent channel is ready, the variable is set at the beginning.

That the events near the place are a run with an edge does not say that the whole recording is one.
"""

from __future__ import annotations

from collections.abc import Iterable

from tachk.base.records import replace
from tachk.base.words import Direction
from tachk.engine.options import Limits
from tachk.model.builder import NetworkBuilder, Term
from tachk.model.expressions import VariableKind
from tachk.model.network import Edge
from tachk.model.types import ChannelType
from tachk.recordings.conformance.components import IndependentComponent
from tachk.recordings.conformance.conform import Conformance
from tachk.recordings.conformance.event_streams import Constants, EventStreams
from tachk.recordings.conformance.events import EventLog
from tachk.recordings.conformance.nearest_log import NearestLogSearch
from tachk.recordings.conformance.trace_product import TraceProduct, trace_product
from tachk.verify.repair.chosen_search import ChosenValue, accepting_choices
from tachk.verify.repair.extended_model import ExtendedModel


class EdgeScreening:
    """The events near the place where one recording leaves a model.

    Attributes:
        near: the search for edits there; it knows the events and the states from which the parts of the model go on.

    Args:
        before, behind: how many events before and behind that place are near.
    """

    def __init__(
        self,
        model: ExtendedModel,
        recording: EventLog,
        constants: Constants,
        found: Conformance,
        limits: Limits,
        before: int,
        behind: range,
    ) -> None:
        self.model = model
        self.near = NearestLogSearch(
            model.without_any, model.mapping, recording, constants, found, limits, before, behind
        )
        builder = NetworkBuilder("repair.", VariableKind.GLOBAL)
        self._edit = builder.integer("edge", 0, len(model.proposed))
        (self._variable,) = builder.variables
        self._felt = {
            number
            for process in model.network.processes
            for edge in process.edges
            if (number := model.number_of(edge)) is not None and _is_felt_before(edge)
        }

    def accepting(self, wanted: Iterable[int], recording: EventLog | None = None) -> set[int]:
        """The numbers of the wanted edges with which the events near the place are a run.

        Args:
            recording: other events in place of these.
        """
        recording = self.near.recording if recording is None else recording
        choices = [ChosenValue(number, self._variable, number + 1, number in self._felt) for number in sorted(wanted)]
        return accepting_choices(self.near, recording, choices, self._product, self.model.number_of)

    def _product(self, streams: EventStreams, component: IndependentComponent, numbers: frozenset[int]) -> TraceProduct:
        """The network that follows the events of a part of the model, with some of the edges."""
        network = self.model.with_edges(self.model.network, lambda each: each is None or each in numbers)
        return self._with_choice(trace_product(network, self.model.mapping, streams, component.processes))

    def _with_choice(self, product: TraceProduct) -> TraceProduct:
        """The network in which each proposed edge says that it is the one; its number, and one more."""
        processes = tuple(
            replace(process, edges=tuple(self._choosing(edge) for edge in process.edges))
            for process in product.network.processes
        )
        network = replace(product.network, processes=processes, variables=(*product.network.variables, self._variable))
        return replace(product, network=network)

    def _choosing(self, edge: Edge) -> Edge:
        number = self.model.number_of(edge)
        if number is None:
            return edge
        chosen = self._edit == number + 1
        allowed = chosen if number in self._felt else chosen | (self._edit == 0)
        guard = allowed if edge.guard is None else allowed & Term(edge.guard)
        updates = (*edge.updates, self._edit.assign(number + 1).expression)
        return replace(edge, guard=guard.expression, updates=updates)


def _is_felt_before(edge: Edge) -> bool:
    """True if the edge makes a difference where it is possible and not taken."""
    if edge.synchronisation is None:
        return False
    type_ = edge.synchronisation.channel.type
    assert isinstance(type_, ChannelType)
    return type_.urgent or (type_.broadcast and edge.synchronisation.direction is Direction.RECEIVE)
