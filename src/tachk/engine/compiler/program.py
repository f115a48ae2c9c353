"""A network compiled to integers: what the C++ core runs.

The discrete state is one vector of *slots*. Slots ``0 .. processes-1`` hold the current location numbers; then one slot
follows for every scalar component of every variable in the order of `Network.all_variables`. That of a clock or channel
holds its
number, a constant, and therefore costs no bits in a packed state. Behind the state slots lie the *frame slots* of
functions and quantifiers; functions are not recursive, so every frame variable has a fixed slot.

Clocks are numbered from 1 in this order; clock 0 is the reference clock, always zero. Channels are numbered from 0.

Code is one array of 32-bit words for a stack machine (see `tachk.engine.compiler.bytecode.Opcode`); a piece of code is
named by the position of its first word, ``NO_CODE`` stands for "nothing to evaluate" (true for a condition).
"""

from __future__ import annotations

from enum import IntEnum

from tachk.base.records import dataclass
from tachk.base.span import Span

NO_CODE = -1


class Comparison(IntEnum):
    EQUAL = 0
    NOT_EQUAL = 1
    LESS = 2
    LESS_EQUAL = 3
    GREATER = 4
    GREATER_EQUAL = 5


@dataclass(frozen=True, slots=True)
class Test:
    """``slot comparison constant``: the conditions that are worth a path of their own because they cannot fail."""

    slot: int
    comparison: Comparison
    constant: int


@dataclass(frozen=True, slots=True)
class ClockConstraint:
    """``x_left - x_right < bound`` (strict) or ``<= bound``.

    Attributes:
        left, right: clock numbers, 0 is the reference clock.
        bound: the constant, unless ``bound_code`` is given, whose value replaces it.
        condition: code; the constraint is absent (true) where its value is 0.
        left_code, right_code: code that computes the clock number, for ``x[i]`` with a variable ``i``.
    """

    left: int
    right: int
    strict: bool
    bound: int = 0
    bound_code: int = NO_CODE
    condition: int = NO_CODE
    left_code: int = NO_CODE
    right_code: int = NO_CODE


class FlowTestKind(IntEnum):
    TRUTH = 0
    LESS = 1
    LESS_EQUAL = 2
    GREATER = 3
    GREATER_EQUAL = 4
    EQUAL = 5
    NOT_EQUAL = 6


@dataclass(frozen=True, slots=True)
class FlowTest:
    """A condition on hybrid clocks, which only simulations know: a comparison of floating point numbers, or any other.

    Attributes:
        affine: the difference of the sides is a sum of multiples of hybrid clocks.
        left, right: code; the right one is ``NO_CODE`` for a truth value.
    """

    kind: FlowTestKind
    affine: bool
    left: int
    right: int = NO_CODE


@dataclass(frozen=True, slots=True)
class Condition:
    """A conjunction: all tests, then the code, then the clock constraints, then what depends on hybrid clocks."""

    tests: tuple[Test, ...] = ()
    code: int = NO_CODE
    constraints: tuple[ClockConstraint, ...] = ()
    flow: tuple[FlowTest, ...] = ()


@dataclass(frozen=True, slots=True)
class Update:
    """Either only ``stores`` (slot, value) and ``resets``, or, where that cannot say it, ``code``.

    Attributes:
        resets: triples (clock, value, source), done in order: the clock gets the value of ``source``, which is 0 for
            none, and so much more.
    """

    stores: tuple[tuple[int, int], ...] = ()
    resets: tuple[tuple[int, int, int], ...] = ()
    code: int = NO_CODE


@dataclass(frozen=True, slots=True)
class ProgramLocation:
    """Attributes:
    stopped: pairs (clock, code): the clock stands still where the code's value is 0 (``NO_CODE``: always).
    lower, upper: triples collected by the bound analysis: (clock, largest constant in lower-bound, resp. upper-bound,
        constraints that matter from here on before the next reset). A clock that is missing does not matter here.
    """

    invariant: Condition = Condition()
    urgent: bool = False
    committed: bool = False
    observes: bool = False
    stopped: tuple[tuple[int, int], ...] = ()
    lower: tuple[tuple[int, int], ...] = ()
    upper: tuple[tuple[int, int], ...] = ()


@dataclass(frozen=True, slots=True)
class ProgramEdge:
    """One edge for one combination of values of its select variables.

    Attributes:
        edge: its number in ``network.processes[process].edges``.
        selects: the values of its select variables.
        channel: channel number; -1 for an internal edge; the first of the possible ones if ``channel_code`` is given.
        channels: how many channels from that one on the edge may name.
        sends: ``!`` rather than ``?``.
    """

    process: int
    edge: int
    selects: tuple[int, ...]
    source: int
    target: int
    guard: Condition = Condition()
    channel: int = -1
    channels: int = 0
    channel_code: int = NO_CODE
    sends: bool = False
    update: Update = Update()


@dataclass(frozen=True, slots=True)
class ProgramChannel:
    name: str
    broadcast: bool
    urgent: bool
    priority: int


@dataclass(frozen=True, slots=True)
class Slot:
    """Attributes:
    name: for output: ``P``, ``P.x``, ``a[2].b``.
    low, high: the legal range; a store outside is a run-time error.
    meta: reset to ``initial`` before every transition and left out of the stored state.
    """

    name: str
    low: int
    high: int
    initial: int
    meta: bool = False


@dataclass(frozen=True, slots=True)
class Interchangeable:
    """Interchangeable processes: a transposition of any two, or a rotation of all, keeps the behaviour.

    Attributes:
        slots: for each member its slots, the corresponding ones in the same order; its location first.
        clocks, channels: the same for clocks and channels.
        names: the slots that may hold names of members, each with the number of its table.
        tables: each with the name of each member.
        cyclic: the members can only be moved on, all by the same number of places, the last ones to the front.
    """

    slots: tuple[tuple[int, ...], ...]
    clocks: tuple[tuple[int, ...], ...]
    channels: tuple[tuple[int, ...], ...]
    names: tuple[tuple[int, int], ...]
    tables: tuple[tuple[int, ...], ...]
    cyclic: bool = False


@dataclass(frozen=True, slots=True)
class Program:
    """Attributes:
    locations: for each process, its locations.
    slots: the state slots, then ``frame_slots`` more that are not part of the state.
    state_slots: how many of ``slots`` are the state.
    sites: sorted pairs (code position, place in the text): the place of an instruction is that of the last pair at or
        before it.
    maximum_constants: for each clock (entry 0 unused) the largest constant it is compared with anywhere; -1 for none.
    diagonals: the triples (left, right, raw) of difference constraints between two real clocks in the model;
        raw = 2 * bound + (0 if strict else 1).
    has_priorities: some channel or process has a priority that differs from another.
    has_stopwatches: some location stops a clock.
    copies_clocks: some update sets a clock to the value of a clock.
    largest_reset: the largest value a clock may begin with, be set to, or be advanced by.
    computed_unit: divides every time that code computes, the bounds of constraints and the values of clocks; 0 if they
        are all 0.
        interchangeable: groups of processes that a search for the goals need not distinguish.
    starts: the clocks that do not begin with 0, each with what it shows at first.
    """

    process_priorities: tuple[int, ...]
    locations: tuple[tuple[ProgramLocation, ...], ...]
    edges: tuple[ProgramEdge, ...]
    channels: tuple[ProgramChannel, ...]
    clock_names: tuple[str, ...]
    slots: tuple[Slot, ...]
    state_slots: int
    code: tuple[int, ...]
    sites: tuple[tuple[int, Span], ...]
    default_priority: int
    maximum_constants: tuple[int, ...]
    diagonals: tuple[tuple[int, int, int], ...] = ()
    has_priorities: bool = False
    has_stopwatches: bool = False
    copies_clocks: bool = False
    largest_reset: int = 0
    computed_unit: int = 0
    interchangeable: tuple[Interchangeable, ...] = ()
    starts: tuple[tuple[int, int], ...] = ()

    @property
    def clocks(self) -> int:
        """The number of clocks, the reference clock not counted."""
        return len(self.clock_names)


class DeadlockLiteral(IntEnum):
    ABSENT = 0
    REQUIRED = 1
    FORBIDDEN = -1


@dataclass(frozen=True, slots=True)
class Disjunct:
    condition: Condition
    deadlock: DeadlockLiteral = DeadlockLiteral.ABSENT


@dataclass(frozen=True, slots=True)
class Goal:
    """A set of states to be reached: the union of its disjuncts. Its code lives in the program it was lowered with.

    Attributes:
        decides: the search goes on for it; otherwise it is noted if it is met on the way, without a path.
    """

    disjuncts: tuple[Disjunct, ...]
    decides: bool = True

    @property
    def asks_deadlock(self) -> bool:
        return any(disjunct.deadlock is not DeadlockLiteral.ABSENT for disjunct in self.disjuncts)


@dataclass(frozen=True, slots=True)
class Measure:
    """The least or the largest value of something in the states of a goal, none of which asks for deadlock.

    Attributes:
        clock: its number; 0 for an integer.
        code: of the integer; NO_CODE for a clock.
    """

    where: Goal
    largest: bool
    clock: int = 0
    code: int = NO_CODE


@dataclass(frozen=True, slots=True)
class Computed:
    """A number: a constant, what code computes, or what a slot holds.

    Attributes:
        floating: it is a floating point number; of code the value is the number of a slot that holds it. Others are
            integers.
        slot: its number; -1 for none.
    """

    constant: float = 0.0
    code: int = NO_CODE
    floating: bool = False
    slot: int = -1


@dataclass(frozen=True, slots=True)
class FlowRate:
    """The rate of a hybrid clock in a location.

    Attributes:
        clock: its number among the hybrid ones.
        varies: the rate depends on hybrid clocks.
    """

    clock: int
    varies: bool
    rate: Computed


@dataclass(frozen=True, slots=True)
class HybridClocks:
    """Floating point variables that change while time passes.

    Attributes:
        slots: the first one of each.
        rates: of each location of each process; 1 where nothing is said.
        reads: the slots that rates depend on, and those of the clocks.
    """

    slots: tuple[int, ...] = ()
    rates: tuple[tuple[tuple[FlowRate, ...], ...], ...] = ()
    reads: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Chances:
    """The additions to a program for simulation.

    Attributes:
        rates: of the exponential distribution of each location of each process.
        choices: of each edge; edges with the same number are branches of one way into a branchpoint.
        weights: of each edge, among those of its choice.
        observed: what is recorded of each state.
        goals: the targets of searches.
        starts: code of updates that draw initial values.
    """

    rates: tuple[tuple[Computed, ...], ...]
    choices: tuple[int, ...]
    weights: tuple[Computed, ...]
    observed: tuple[Computed, ...]
    goals: tuple[Goal, ...] = ()
    hybrid: HybridClocks = HybridClocks()
    starts: tuple[int, ...] = ()
