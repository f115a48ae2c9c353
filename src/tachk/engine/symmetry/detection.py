"""Which processes of a network are interchangeable.

Processes with the same text up to numbers and variables are candidates. What must be exchanged together with two of
them is read off where their texts differ; then `tachk.engine.symmetry.automorphism` proves that the exchange maps
the network, and what is asked of it, onto itself. Exchanges of one process with each of the others generate all
permutations. Processes that cannot be exchanged may still form a ring (`tachk.engine.symmetry.rings`).
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import chain, combinations
from math import factorial, prod

from tachk.analysis.failures import location_can_fail
from tachk.analysis.fold import known_values
from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.engine.symmetry.automorphism import NetworkTerms, Renaming, read
from tachk.engine.symmetry.broadcasts import order_matters
from tachk.engine.symmetry.colours import colours_of_processes
from tachk.engine.symmetry.correspondence import corresponding
from tachk.engine.symmetry.kinds import AsymmetryReason
from tachk.engine.symmetry.rings import Ring, Team, find_ring, subsets
from tachk.engine.symmetry.sketch import sketch_of
from tachk.engine.symmetry.terms import KindedNumber, Shift, Token
from tachk.model.expressions import Expression, Variable
from tachk.model.network import Network
from tachk.model.remembered import by_network

MOST_IN_VAIN = 30
"""So many exchanges in a row are tried without success; then none of the other processes of that shape is exchanged.
There may be as many as there are pairs."""


@dataclass(frozen=True, slots=True)
class InterchangeableTeams:
    """Teams any two of which can be exchanged. A team is what is only exchanged together, such as a cell and its
    arbiter: as a rule one process.

    Attributes:
        members: the numbers of their processes.
        exchanges: of the first one with each of the others, in order.
    """

    members: tuple[Team, ...]
    exchanges: tuple[Renaming, ...]


@dataclass(frozen=True, slots=True)
class Apart:
    """Two teams that cannot be exchanged.

    Attributes:
        refusal: why not; None if their colours tell, so that a reason is only looked for where somebody asks.
    """

    one: Team
    other: Team
    refusal: AsymmetryReason | None = None


@dataclass(frozen=True, slots=True)
class Difference:
    """Why two processes with the same text up to numbers and variables cannot be exchanged."""

    template: str
    one: str
    other: str
    refusal: AsymmetryReason


@dataclass(frozen=True, slots=True)
class Symmetry:
    """What has been found out about a network.

    Attributes:
        groups: of two processes at least.
        rings: of processes that are not in groups.
        apart: for each template with several instances that are not all interchangeable, nor in a ring, two of them
            that are not.
        reading: what the renamings of the groups and rings speak of.
    """

    groups: tuple[InterchangeableTeams, ...]
    rings: tuple[Ring, ...]
    apart: tuple[Apart, ...]
    reading: NetworkTerms

    @property
    def renamings(self) -> Iterable[Renaming]:
        """What maps the network onto itself."""
        yield from (exchange for group in self.groups for exchange in group.exchanges)
        yield from (ring.rotation for ring in self.rings)

    @property
    def differences(self) -> Iterable[Difference]:
        """Why the processes that are apart are."""
        processes = self.reading.network.processes
        for apart in self.apart:
            refusal = apart.refusal or _proved(self.reading, apart.one, apart.other)
            assert isinstance(refusal, AsymmetryReason)
            first, second = processes[apart.one[0]], processes[apart.other[0]]
            yield Difference(first.template, first.name, second.name, refusal)


def find_symmetry(network: Network, predicates: Sequence[Expression]) -> Symmetry:
    """The interchangeable processes of a network of which the predicates are asked.

    Exchanging them maps runs to runs, run-time errors included, and keeps the values of the predicates.
    """
    return _found(network, tuple(predicates))


@by_network
def _found(network: Network, predicates: tuple[Expression, ...]) -> Symmetry:
    if predicates:
        unasked = _found(network, ())
        reading = unasked.reading.asking(predicates)
        if reading is not None and not any(map(reading.objection_of_predicates, unasked.renamings)):
            return replace(unasked, reading=reading)
    return look_for_symmetry(network, predicates)


def look_for_symmetry(network: Network, predicates: Sequence[Expression]) -> Symmetry:
    """As `find_symmetry`, without anything that is known of the network."""
    known = known_values(network, predicates)
    reading = read(network, predicates, known, sketch_of(network).never)
    candidates = list(_candidates(reading))
    for members in candidates:
        for other in members[1:]:
            _align(reading, members[0], other)
    reading.settle()
    rings, found = _with_rings(reading, _attempts(reading, candidates))
    groups = tuple(group for attempt in found for group in attempt.groups)
    apart = tuple(attempt.apart for attempt in found if attempt.apart is not None)
    return Symmetry(groups, tuple(rings), apart, reading)


def _attempts(reading: NetworkTerms, candidates: Iterable[Sequence[int]]) -> list[_ExchangeAttempt]:
    """What has become of the candidates, each by itself or those of several sets together."""
    singles: list[list[Team]] = [[(member,) for member in members] for members in candidates]
    found = [_attempt(reading, teams, most_in_vain=1) for teams in singles]
    hopeless = [attempt for attempt in found if attempt.apart is not None and attempt.reach == 0]
    for partners in _partnerships(hopeless):
        joined = _joined(reading, partners, most_in_vain=1)
        if joined.apart is None:
            return [joined, *(_in_full(reading, attempt) for attempt in found if attempt not in partners)]
    found = [_in_full(reading, attempt) for attempt in found]
    open_ = [attempt for attempt in found if attempt.apart is not None]
    for partners in _partnerships(open_):
        joined = _joined(reading, partners)
        if joined.reach > max(each.reach for each in partners):
            return [joined, *(attempt for attempt in found if attempt not in partners)]
    return found


@dataclass(frozen=True, slots=True)
class _ExchangeAttempt:
    """What has become of teams that might be interchangeable.

    Attributes:
        apart: two that are not; None if all are.
    """

    teams: list[Team]
    groups: list[InterchangeableTeams]
    apart: Apart | None

    @property
    def reach(self) -> int:
        """How many of them are."""
        return sum(len(group.members) for group in self.groups)

    @property
    def arrangements(self) -> int:
        """In how many orders they can be put by exchanging them."""
        return prod(factorial(len(group.members)) for group in self.groups)


def _in_full(reading: NetworkTerms, attempt: _ExchangeAttempt) -> _ExchangeAttempt:
    """An attempt that was given up early, made again."""
    return attempt if attempt.apart is None else _attempt(reading, attempt.teams)


def _joined(
    reading: NetworkTerms, partners: Sequence[_ExchangeAttempt], most_in_vain: int = MOST_IN_VAIN
) -> _ExchangeAttempt:
    teams = list(zip(*(sum(each.teams, ()) for each in partners), strict=True))
    return _attempt(reading, teams, most_in_vain)


def _attempt(reading: NetworkTerms, teams: list[Team], most_in_vain: int = MOST_IN_VAIN) -> _ExchangeAttempt:
    refusal = _order_of_errors(reading, teams)
    if refusal is not None:
        return _ExchangeAttempt(teams, [], Apart(teams[0], teams[1], refusal))
    classes, apart = _classes(reading, teams, most_in_vain)
    groups = []
    for each in classes:
        if len(each.members) > 1:
            refused = order_matters(reading.network, reading.reader.known, each.members)
            if refused is None:
                groups.append(each)
            else:
                apart = apart or Apart(each.members[0], each.members[1], refused)
    return _ExchangeAttempt(teams, groups, apart)


def _partnerships(attempts: Sequence[_ExchangeAttempt]) -> Iterable[tuple[_ExchangeAttempt, ...]]:
    """Sets of equally many processes, which may be interchangeable together only."""
    sizes: dict[int, list[_ExchangeAttempt]] = {}
    for attempt in attempts:
        sizes.setdefault(len(attempt.teams), []).append(attempt)
    for equal in sizes.values():
        if len(equal) > 1:
            yield tuple(equal)
        if len(equal) > 2:
            yield from combinations(equal, 2)


def _with_rings(reading: NetworkTerms, attempts: list[_ExchangeAttempt]) -> tuple[list[Ring], list[_ExchangeAttempt]]:
    """The rings of teams that are not all interchangeable, where those leave fewer states, and the other attempts."""
    rings: list[Ring] = []
    gone: list[_ExchangeAttempt] = []
    sizes = {len(attempt.teams) for attempt in attempts if attempt.apart is not None}
    for size in sorted(sizes):
        equal = [attempt for attempt in attempts if attempt.apart is not None and len(attempt.teams) == size]
        for some in subsets(equal):
            if any(attempt in gone for attempt in some):
                continue
            ring = ring_of(
                reading, [sum(teams, ()) for teams in zip(*(attempt.teams for attempt in some), strict=True)]
            )
            if ring is not None and len(ring.members) > prod(attempt.arrangements for attempt in some):
                rings.append(ring)
                gone += some
    return rings, [attempt for attempt in attempts if attempt not in gone]


def ring_of(reading: NetworkTerms, teams: Sequence[Team]) -> Ring | None:
    """A ring in which teams stand in their order, if there is one."""
    families = list(zip(*teams, strict=True))
    if _order_of_errors(reading, teams):
        return None
    if any(len({colours[member] for member in family}) > 1 for colours in _colours(reading) for family in families):
        return None
    ring = find_ring(reading, families)
    if isinstance(ring, AsymmetryReason) or order_matters(reading.network, reading.reader.known, ring.members):
        return None
    return ring


def _candidates(reading: NetworkTerms) -> Iterable[list[int]]:
    """Sets of processes with the same text up to numbers and variables."""
    network = reading.network
    shapes: dict[Hashable, list[int]] = {}
    for number, process in enumerate(network.processes):
        if not process.edges:
            continue
        shape = (
            process.initial,
            len(process.variables),
            tuple(unit.outline for unit in reading.locations[number]),
            tuple(unit.outline for unit in reading.edges[number]),
        )
        shapes.setdefault(shape, []).append(number)
    return (members for members in shapes.values() if len(members) > 1)


def _pairs(reading: NetworkTerms, one: int, other: int) -> Iterable[tuple[Token, Token, Span]]:
    """What stands at the same places of two processes, and what they declare."""
    first, second = (reading.network.processes[number] for number in (one, other))
    for variable, another in zip(first.variables, second.variables, strict=True):
        yield variable, another, another.span
    for here, there in ((reading.locations[one], reading.locations[other]), (reading.edges[one], reading.edges[other])):
        for unit, image in zip(here, there, strict=True):
            for token, another_token in zip(unit.every_token, image.every_token, strict=True):
                yield token, another_token, image.span


def _align(reading: NetworkTerms, one: int, other: int) -> None:
    """Whatever stands at the same place of two processes is of one kind."""
    reader = reading.reader
    for token, another, span in _pairs(reading, one, other):
        if isinstance(token, KindedNumber) and isinstance(another, KindedNumber):
            reader.kinds.unite(token.node, another.node, 0, span)
        elif isinstance(token, Variable) and isinstance(another, Variable) and token is not another:
            reader.kinds.unite_trees(reader.tree_of(token), reader.tree_of(another), span)


def _order_of_errors(reading: NetworkTerms, teams: Sequence[Team]) -> AsymmetryReason | None:
    """Invariants are looked at process by process up to one that is false: where one of these processes, or of those
    that stand between them, may be a run-time error their order can be noticed."""
    members = {member for team in teams for member in team}
    between = set(range(min(members), max(members))) - members
    for number in (*teams[0], *sorted(between)):
        for location in reading.network.processes[number].locations:
            if location_can_fail(location, reading.reader.known):
                return AsymmetryReason("an invariant or a rate may be a run-time error", location.span)
    return None


def _classes(
    reading: NetworkTerms, teams: Sequence[Team], most_in_vain: int
) -> tuple[list[InterchangeableTeams], Apart | None]:
    """The teams in classes of those that can be exchanged, and two that are in different ones if there are several.

    Colours that take longer to find are looked for once an exchange has been tried in vain.
    """
    for colours in _colours(reading):
        classes, apart = _exchanged(reading, teams, colours, most_in_vain if colours is reading.colours else 1)
        if apart is None or apart.refusal is None:
            break
    return classes, apart


def _colours(reading: NetworkTerms) -> Iterator[Sequence[int]]:
    """What tells processes apart, as long as nothing better is known first what is found fast."""
    sketch = sketch_of(reading.network)
    if reading.colours is None and reading.reader.known is sketch.known:
        yield sketch.colours
    yield colours_of_processes(reading)


def _exchanged(
    reading: NetworkTerms, teams: Sequence[Team], colours: Sequence[int], most_in_vain: int
) -> tuple[list[InterchangeableTeams], Apart | None]:
    found: dict[Hashable, list[tuple[list[Team], list[Renaming]]]] = {}
    apart: Apart | None = None
    in_vain = 0
    for team in teams:
        alike = found.setdefault(tuple(colours[member] for member in team), [])
        for numbers, exchanges in alike if in_vain < most_in_vain else ():
            exchange = _proved(reading, numbers[0], team)
            if isinstance(exchange, Renaming):
                numbers.append(team)
                exchanges.append(exchange)
                in_vain = 0
                break
            apart = apart or Apart(numbers[0], team, exchange)
            in_vain += 1
        else:
            alike.append(([team], []))
    if len(found) > 1 and apart is None:
        (one, _), (other, _) = (alike[0] for alike in list(found.values())[:2])
        apart = Apart(one[0], other[0])
    classes = chain.from_iterable(found.values())
    return [InterchangeableTeams(tuple(numbers), tuple(exchanges)) for numbers, exchanges in classes], apart


def _proved(reading: NetworkTerms, one: Team, other: Team) -> Renaming | AsymmetryReason:
    """The exchange of two teams, if it maps the network onto itself."""
    exchange = exchange_of(reading, one, other)
    return exchange if isinstance(exchange, AsymmetryReason) else reading.objection(exchange) or exchange


def exchange_of(reading: NetworkTerms, one: Team, other: Team) -> Renaming | AsymmetryReason:
    """What has to be exchanged together with two teams, where the texts of their processes differ."""
    variables: dict[Variable, Variable] = {}
    values: dict[int, dict[int, int]] = {}
    processes = dict(zip((*one, *other), (*other, *one), strict=True))

    def hinders(number: KindedNumber, another: KindedNumber, span: Span) -> AsymmetryReason | None:
        if number.value == another.value:
            return None
        root, shift = reading.kinds.find(number.node)
        moved = values.setdefault(root, {})
        here, there = number.value - shift, another.value - shift
        if moved.setdefault(here, there) != there or moved.setdefault(there, here) != here:
            return AsymmetryReason("their numbers do not correspond one to one", span)
        return reading.no_name(root)

    for token, another, span in corresponding(reading, processes):
        if isinstance(token, KindedNumber) and isinstance(another, KindedNumber):
            refusal = hinders(token, another, span)
            if refusal is not None:
                return refusal
        elif isinstance(token, Variable) and isinstance(another, Variable) and token is not another:
            if variables.setdefault(token, another) is not another or variables.setdefault(another, token) is not token:
                return AsymmetryReason(f"`{token.name}` and `{another.name}` do not correspond one to one", span)
        elif isinstance(token, Shift) and token != another:
            return AsymmetryReason("they compute with their numbers", span)
    return Renaming(processes, variables, values)
