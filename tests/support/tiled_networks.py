"""Large random networks with known answers, made of small pieces whose answers are worked out path by path.

Pieces run side by side in phases: each goes through locations without circles, with a clock of its own that begins at
zero, until it is ready; when all are, a barrier lets all begin the next phase at once. Within a phase pieces know
nothing of each other, so that the moments at which each piece can be somewhere are those of its paths, and the moments
at which pieces can be at several places together are the common ones. The moments of barriers add up.

The moments of a path are those of a system of difference constraints (Cormen et al., "Introduction to Algorithms",
section 22.4); there are few paths, and nothing here uses zones, searches or expressions of tachk.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from random import Random

Bound = tuple[float, bool]
"""A least upper bound, and whether it is attained; bounds are compared as they constrain."""

UNBOUNDED: Bound = (float("inf"), False)


@dataclass(frozen=True)
class Interval:
    """Moments: integers as ends, each within or without; `high` may be infinite."""

    low: float
    low_within: bool
    high: float
    high_within: bool

    def __bool__(self) -> bool:
        return self.low < self.high or (self.low == self.high and self.low_within and self.high_within)

    def __and__(self, other: Interval) -> Interval:
        low, low_within = max((self.low, not self.low_within), (other.low, not other.low_within))
        high, high_within = min((self.high, self.high_within), (other.high, other.high_within))
        return Interval(low, not low_within, high, high_within)

    def __add__(self, other: Interval) -> Interval:
        return Interval(
            self.low + other.low,
            self.low_within and other.low_within,
            self.high + other.high,
            self.high_within and other.high_within,
        )


Moments = frozenset[Interval]
"""A union of intervals that are not empty."""


def common(some: Moments, others: Moments) -> Moments:
    return frozenset(both for one, other in product(some, others) if (both := one & other))


def total(some: Moments, others: Moments) -> Moments:
    return frozenset(one + other for one, other in product(some, others))


@dataclass(frozen=True)
class Guard:
    """Bounds of the clock of a piece, each an integer and whether it is within; None: no bound."""

    least: tuple[int, bool] | None = None
    most: tuple[int, bool] | None = None

    @property
    def text(self) -> str:
        parts = []
        if self.least is not None:
            parts.append(f"x {'>=' if self.least[1] else '>'} {self.least[0]}")
        if self.most is not None:
            parts.append(f"x {'<=' if self.most[1] else '<'} {self.most[0]}")
        return " && ".join(parts) or "true"


@dataclass(frozen=True)
class Step:
    """An edge of a piece: it leads to a location with a larger number."""

    source: int
    target: int
    guard: Guard
    resets: bool


@dataclass(frozen=True)
class Tile:
    """One phase of a piece.

    Attributes:
        invariants: of each location, the last of which is where the piece is ready.
        steps: the edges between them.
    """

    invariants: tuple[Guard, ...]
    steps: tuple[Step, ...]

    def moments(self, places: Iterable[int], clock: Guard = Guard()) -> Moments:
        """The moments of the phase at which the piece can be in one of some locations with the clock in bounds."""
        wanted = set(places)
        found = (self._of_path(path, clock) for path in self._paths() if (path[-1].target if path else 0) in wanted)
        return frozenset(interval for interval in found if interval)

    def _paths(self, source: int = 0) -> Iterator[tuple[Step, ...]]:
        yield ()
        for step in self.steps:
            if step.source == source:
                yield from ((step, *rest) for rest in self._paths(step.target))

    def _of_path(self, path: Sequence[Step], clock: Guard) -> Interval:
        """The moments at which the piece can be where a path ends."""
        events = len(path) + 2  # the begin of the phase, each step, and the moment asked for
        bounds = [[UNBOUNDED if one != other else (0.0, True) for other in range(events)] for one in range(events)]
        # bounds[i][j] is that of the moment i minus the moment j

        def constrain(one: int, other: int, bound: Bound) -> None:
            bounds[one][other] = min(bounds[one][other], bound)

        def within(guard: Guard, event: int, reset: int) -> None:
            if guard.least is not None:
                constrain(reset, event, (-guard.least[0], guard.least[1]))
            if guard.most is not None:
                constrain(event, reset, (guard.most[0], guard.most[1]))

        place, reset = 0, 0
        for number, step in enumerate(path, start=1):
            constrain(number - 1, number, (0.0, True))
            within(self.invariants[place], number, reset)
            within(step.guard, number, reset)
            place, reset = step.target, number if step.resets else reset
            within(self.invariants[place], number, reset)
        last = events - 1
        constrain(last - 1, last, (0.0, True))
        within(self.invariants[place], last, reset)
        within(clock, last, reset)
        for middle, one, other in product(range(events), repeat=3):
            left, right = bounds[one][middle], bounds[middle][other]
            constrain(one, other, (left[0] + right[0], left[1] and right[1]))
        if any(bounds[event][event] < (0.0, True) for event in range(events)):
            return Interval(1, False, 0, False)
        (low, low_within), (high, high_within) = bounds[0][last], bounds[last][0]
        return Interval(-low, low_within, high, high_within)


@dataclass(frozen=True)
class Goal:
    """Places of some pieces at once in a phase, and a bound of the time since the beginning.

    Attributes:
        places: a location of some pieces, by their numbers.
        clocks: the bounds of the clocks of those pieces.
        comparison, bound: of the time; "" where there is none.
    """

    phase: int
    places: dict[int, int]
    clocks: dict[int, Guard]
    comparison: str
    bound: int


@dataclass(frozen=True)
class TiledNetwork:
    """Pieces by the numbers of their templates, and the phases of the templates."""

    templates: tuple[tuple[Tile, ...], ...]
    pieces: tuple[int, ...]

    @property
    def phases(self) -> int:
        return len(self.templates[0])

    @cached_property
    def barriers(self) -> tuple[Moments, ...]:
        """The moments since the beginning at which each phase can begin."""
        found = [frozenset({Interval(0, True, 0, True)})]
        for phase in range(self.phases):
            ready = [self.templates[piece][phase] for piece in self.pieces]
            found.append(total(found[-1], self.together([t.moments([len(t.invariants) - 1]) for t in ready])))
        return tuple(found)

    @staticmethod
    def together(moments: Sequence[Moments]) -> Moments:
        together = frozenset({Interval(0, True, float("inf"), False)})
        for each in moments:
            together = common(together, each)
        return together

    def reached(self, goal: Goal) -> bool:
        """True if some run reaches the goal. Pieces that it does not name are somewhere."""
        tiles = [self.templates[piece][goal.phase] for piece in self.pieces]
        here = [
            tile.moments(
                [goal.places[number]] if number in goal.places else range(len(tile.invariants)),
                goal.clocks.get(number, Guard()),
            )
            for number, tile in enumerate(tiles)
        ]
        bound = {
            "": Interval(0, True, float("inf"), False),
            "<=": Interval(0, True, goal.bound, True),
            "<": Interval(0, True, goal.bound, False),
            ">=": Interval(goal.bound, True, float("inf"), False),
            ">": Interval(goal.bound, False, float("inf"), False),
            "==": Interval(goal.bound, True, goal.bound, True),
        }[goal.comparison]
        return bool(common(total(self.barriers[goal.phase], self.together(here)), frozenset({bound})))

    # ---- the text ---------------------------------------------------------------------------------------------------

    def query(self, goal: Goal) -> str:
        parts = [f"phase == {goal.phase}"]
        for number, place in goal.places.items():
            parts.append(f"P{number}.L{goal.phase}_{place}")
            clock = goal.clocks.get(number, Guard()).text
            if clock != "true":
                parts.append(clock.replace("x", f"P{number}.x"))
        if goal.comparison:
            parts.append(f"since {goal.comparison} {goal.bound}")
        return "E<> " + " && ".join(parts)

    @property
    def text(self) -> str:
        names = ", ".join(["B", *(f"P{number}" for number in range(len(self.pieces)))])
        instances = "".join(f"P{number} = T{template}();\n" for number, template in enumerate(self.pieces))
        return (
            f"clock since;\nint[0, {len(self.pieces)}] ready = 0;\nint[0, {self.phases}] phase = 0;\n"
            "broadcast chan next;\n"
            "process B() {\n  state wait;\n  init wait;\n"
            f"  trans wait -> wait {{ guard ready == {len(self.pieces)} && phase < {self.phases - 1}; sync next!; "
            "assign ready := 0, phase := phase + 1; };\n}\n"
            + "".join(_template(number, tiles) for number, tiles in enumerate(self.templates))
            + f"{instances}system {names};\n"
        )


def _template(number: int, tiles: Sequence[Tile]) -> str:
    states, steps = [], []
    for phase, tile in enumerate(tiles):
        last = len(tile.invariants) - 1
        for place, invariant in enumerate(tile.invariants):
            states.append(f"L{phase}_{place} {{ {invariant.text} }}")
        for step in tile.steps:
            updates = [*(["x := 0"] if step.resets else []), *(["ready := ready + 1"] if step.target == last else [])]
            assign = f" assign {', '.join(updates)};" if updates else ""
            steps.append(f"L{phase}_{step.source} -> L{phase}_{step.target} {{ guard {step.guard.text};{assign} }}")
        if phase + 1 < len(tiles):
            steps.append(f"L{phase}_{last} -> L{phase + 1}_0 {{ sync next?; assign x := 0; }}")
    return (
        f"process T{number}() {{\n  clock x;\n  state {', '.join(states)};\n  init L0_0;\n"
        f"  trans {', '.join(steps)};\n}}\n"
    )


# ---- random ones ----------------------------------------------------------------------------------------------------


def random_tiled_network(random: Random, pieces: int, phases: int, places: int, constant: int) -> TiledNetwork:
    """A network of so many pieces, some of one template, with at most so many locations in a phase. All phases but the
    last one can end."""
    numbers = [0]
    for _ in range(pieces - 1):
        numbers.append(max(numbers) + 1 if random.random() < 0.7 else random.choice(numbers))
    count = max(numbers) + 1
    chosen: list[list[Tile]] = []
    while len(chosen) < phases:
        tiles = [_random_tile(random, random.randint(2, places), constant) for _ in range(count)]
        ready = [tile.moments([len(tile.invariants) - 1]) for tile in tiles]
        if len(chosen) == phases - 1 or TiledNetwork.together(ready):
            chosen.append(tiles)
    return TiledNetwork(tuple(zip(*chosen, strict=True)), tuple(numbers))


def _random_tile(random: Random, places: int, constant: int) -> Tile:
    def bound(low: int, probability: float) -> tuple[int, bool] | None:
        return (random.randint(low, constant), random.random() < 0.7) if random.random() < probability else None

    steps = []
    for source in range(places - 1):
        targets = {source + 1, random.randint(source + 1, places - 1)}
        steps += [
            Step(source, target, Guard(bound(0, 0.6), bound(constant // 2, 0.3)), random.random() < 0.5)
            for target in sorted(targets)
        ]
    return Tile(tuple(Guard(None, bound(constant // 2, 0.3)) for _ in range(places)), tuple(steps))


def random_goal(random: Random, network: TiledNetwork) -> Goal:
    """Most goals name all pieces in the last phase, where most of the states are."""
    phase = network.phases - 1 if random.random() < 0.8 else random.randrange(network.phases)
    count = len(network.pieces) if random.random() < 0.7 else random.randint(1, len(network.pieces))
    named = sorted(random.sample(range(len(network.pieces)), count))
    tiles = {number: network.templates[network.pieces[number]][phase] for number in named}
    ready = random.random() < 0.7
    places = {
        number: len(tile.invariants) - 1 if ready else random.randrange(len(tile.invariants))
        for number, tile in tiles.items()
    }
    clocks = {number: Guard((random.randint(0, 4), random.random() < 0.5)) for number in named if random.random() < 0.2}
    comparison = random.choice(["", "<=", "<", ">=", ">", "=="])
    return Goal(phase, places, clocks, comparison, random.randint(0, 6 * (phase + 1)))
