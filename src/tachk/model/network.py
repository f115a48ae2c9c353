"""A network of timed automata: processes side by side, sharing variables, clocks and channels.

A network is fully instantiated: one `Process` for each instance of a template, in the order of the system line.
Its semantics is stated in docs/semantics.md.
"""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.records import dataclass
from tachk.base.span import NOWHERE, Span
from tachk.base.words import Direction
from tachk.model.expressions import Expression, Variable
from tachk.model.types import ChannelType

DEFAULT_PRIORITY = 0

Chance = Expression | Diagnostic
"""A rate or weight, an integer or floating point expression; or why it is none. Only simulation looks at it."""


@dataclass(frozen=True, slots=True)
class Location:
    """A location of a process.

    Attributes:
        invariant: boolean expression or None; a conjunction of clock constraints, integer conditions and disjunctions
            in which at most one side has clocks.
        rates: pairs (clock, rate): while control is here the clock runs with that rate, an integer expression that is
            0 (stopped) or 1.
        exponential_rate: of the time that the process waits here where no invariant ends it; None: 1.
        hybrid_rates: pairs (hybrid clock, floating point expression): how fast it changes while control is here.
        observes: the process is not a part of what the network describes: committed locations of others do not keep it
            from acting, and where it is committed itself it alone acts.
    """

    name: str
    invariant: Expression | None = None
    rates: tuple[tuple[Expression, Expression], ...] = ()
    urgent: bool = False
    committed: bool = False
    doc: str = ""
    span: Span = NOWHERE
    exponential_rate: Chance | None = None
    hybrid_rates: tuple[tuple[Expression, Expression], ...] = ()
    observes: bool = False

    @property
    def commitment(self) -> int:
        """The level of commitment: the processes with the largest one must move first; 0: not committed."""
        return 1 + self.observes if self.committed else 0

    def may_go(self, most: int) -> bool:
        """True if the committed rule lets the process go where this is the largest commitment of all."""
        return self.observes or self.commitment >= most


@dataclass(frozen=True, slots=True)
class Synchronisation:
    """``channel!`` or ``channel?``; the channel expression has a `ChannelType`."""

    channel: Expression
    direction: Direction
    span: Span = NOWHERE


@dataclass(frozen=True, slots=True)
class Branching:
    """The branchpoint of an edge: edges of the process with the same way into it are its branches.

    Attributes:
        way: its number in the process.
        selects: the number of the edge's select variables that belong to the way in.
        weight: the relative frequency of the branch; None: 1.
    """

    way: int
    selects: int = 0
    weight: Chance | None = None


@dataclass(frozen=True, slots=True)
class Edge:
    """An edge from one location of a process to another.

    Attributes:
        source, target: location numbers in the process.
        selects: bound variables; the edge stands for one edge for each combination of their values.
        guard: boolean expression or None (true).
        updates: executed left to right.
        spans: the places of the pieces of text this edge comes from (an edge through a branchpoint has two).
    """

    source: int
    target: int
    selects: tuple[Variable, ...] = ()
    guard: Expression | None = None
    synchronisation: Synchronisation | None = None
    updates: tuple[Expression, ...] = ()
    doc: str = ""
    spans: tuple[Span, ...] = (NOWHERE,)
    branch: Branching | None = None

    @property
    def begins(self) -> bool:
        """True if a transition begins with the edge, which sends or is internal: its updates come before all others."""
        return self.synchronisation is None or self.synchronisation.direction is Direction.SEND

    @property
    def is_urgent(self) -> bool:
        """True if the edge synchronises over an urgent channel."""
        channel = None if self.synchronisation is None else self.synchronisation.channel.type
        return isinstance(channel, ChannelType) and channel.urgent


@dataclass(frozen=True, slots=True)
class Process:
    """An instance of a template.

    Attributes:
        name: ``P``, or ``T(1)`` for an instance made by a free parameter.
        template: the name of the template.
        variables: the local variables, clocks and channels, in declaration order.
        priority: process priority; higher goes first.
    """

    name: str
    template: str
    locations: tuple[Location, ...]
    edges: tuple[Edge, ...]
    initial: int = 0
    variables: tuple[Variable, ...] = ()
    priority: int = DEFAULT_PRIORITY
    span: Span = NOWHERE


@dataclass(frozen=True, slots=True)
class Signal:
    """A named observable of the state."""

    name: str
    expression: Expression
    span: Span = NOWHERE


@dataclass(frozen=True, slots=True)
class Network:
    """A network of timed automata, instantiated: processes with the variables, clocks and channels that they share.

    Attributes:
        variables: the global variables, clocks and channels, in declaration order.
        default_priority: the priority of internal edges and of channels without one of their own.
        constants: the global integer constants with their values, for reports.
        time_unit: what one time unit means, for output only: ``"1 ms"``.
        hidden: templates and processes that printed runs leave out, for output only.
        lasting: the variables declared `meta` that states hold nevertheless, see `tachk.model.metas`.
    """

    processes: tuple[Process, ...]
    variables: tuple[Variable, ...] = ()
    default_priority: int = DEFAULT_PRIORITY
    constants: tuple[tuple[str, int], ...] = ()
    signals: tuple[Signal, ...] = ()
    time_unit: str = ""
    hidden: tuple[str, ...] = ()
    lasting: frozenset[Variable] = frozenset()

    def __repr__(self) -> str:
        names = [process.name for process in self.processes]
        shown = ", ".join(names if len(names) <= 8 else [*names[:7], f"and {len(names) - 7} more"])
        return f"<Network of {shown or 'no process'}>"

    def resets(self, variable: Variable) -> bool:
        """True if the variable is not part of the state: it has its initial value whenever a transition begins."""
        return variable.declared_meta and variable not in self.lasting

    @property
    def has_priorities(self) -> bool:
        """True if any two transitions can differ in priority."""
        of_channels = {priority for variable in self.all_variables() for priority in variable.priorities}
        return not of_channels <= {self.default_priority} or len({p.priority for p in self.processes}) > 1

    def hides(self, process: Process) -> bool:
        """True if printed runs leave the process out."""
        return process.name in self.hidden or process.template in self.hidden

    @property
    def has_hybrid_clocks(self) -> bool:
        """Whether some clock is ``hybrid``: only simulation gives it its rates."""
        return any(variable.has_hybrid_clocks for variable in self.all_variables())

    def all_variables(self) -> tuple[Variable, ...]:
        """Global variables first, then those of each process in order: the order of slots everywhere in tachk."""
        return self.variables + tuple(v for p in self.processes for v in p.variables)
