"""Networks with an observer beside them, and the steps of the observer on a run."""

from __future__ import annotations

from fractions import Fraction

from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.records import dataclass
from tachk.model.network import Network
from tachk.model.query import Observer, Query
from tachk.model.run import TimedTrace
from tachk.transform.extension import Extension, with_process
from tachk.transform.transformation import Exactness


@dataclass(frozen=True, slots=True)
class ObserverMove:
    """``time``: since the start of the run; ``location``: where the observer is from then on."""

    time: Fraction
    location: str


@dataclass(frozen=True, slots=True)
class ObservedNetwork(Extension):
    """A network with an observer as its last process, or as it is."""

    def moves(self, run: TimedTrace) -> tuple[ObserverMove, ...]:
        """The steps of the observer on a run of the network, without locations that it leaves at once."""
        if self.network is self.original:
            return ()
        observer = len(self.original.processes)
        locations = self.network.processes[observer].locations
        moves = (
            ObserverMove(step.state.time, locations[step.state.discrete.locations[observer]].name)
            for step in run.steps
            if step.transition is not None
            and self.lift_transition(step.transition) is None
            and not locations[step.state.discrete.locations[observer]].committed
        )
        return tuple(moves)


def observed(network: Network, observer: Observer | None) -> ObservedNetwork:
    """The network with the observer, if there is one."""
    watched = network if observer is None else with_process(network, observer.process)
    return ObservedNetwork(network, watched, Exactness.SAME_ANSWERS)


def check_observable(network: Network, query: Query) -> None:
    """Raises UnsupportedError if an observer would keep the network from acting, which priorities make it do."""
    if query.observer is not None and network.has_priorities:
        raise UnsupportedError(
            Diagnostic(
                "E0732",
                "temporal properties are not checked in models with priorities of channels or processes",
                query.span,
                "let a location of the model mark the violation, and ask with A[] that it is not reached",
            )
        )
