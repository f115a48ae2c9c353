"""Detection of the symmetries of a network: orbits of interchangeable processes.

Processes with the same text up to numbers and variables are candidates. A transposition of two of them also swaps the
numbers and variables in which their texts differ; `tachk.engine.symmetry.automorphism` proves that it maps the network
and its predicates onto themselves. The transpositions of one process with each of the others generate all permutations.
Processes without transpositions may still have a rotation (`tachk.engine.symmetry.cyclic_symmetry`).
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
from itertools import chain, combinations
from math import factorial, prod

from tachk.analysis.failures import location_can_fail
from tachk.analysis.fold import known_values
from tachk.base.records import dataclass, replace
from tachk.base.span import Span
from tachk.engine.symmetry.automorphism import NetworkTerms, read
from tachk.engine.symmetry.broadcasts import order_matters
from tachk.engine.symmetry.coarse_partition import coarse_partition
from tachk.engine.symmetry.cyclic_symmetry import CyclicOrbit, find_cyclic_orbit, subsets
from tachk.engine.symmetry.equitable_partition import equitable_partition
from tachk.engine.symmetry.index_types import AsymmetryReason
from tachk.engine.symmetry.renaming import Block, Renaming
from tachk.engine.symmetry.terms import IndexValue, Token
from tachk.engine.symmetry.transpositions import note_orbits, proved_transposition
from tachk.model.expressions import Expression, Variable
from tachk.model.network import Network
from tachk.model.remembered import by_network

MOST_FAILED_TRANSPOSITIONS = 30
"""After so many failed transpositions in a row the search leaves the other processes of that shape alone, as there may
be as many transpositions as pairs."""


@dataclass(frozen=True, slots=True)
class SymmetricOrbit:
    """An orbit of blocks on which the full symmetric group acts: any two of them can be exchanged.

    Attributes:
        members: the blocks.
        transpositions: those of the first block with each of the others, in order.
    """

    members: tuple[Block, ...]
    transpositions: tuple[Renaming, ...]


@dataclass(frozen=True, slots=True)
class Asymmetry:
    """Two blocks that cannot be exchanged.

    Attributes:
        reason: why not; None if their colours differ, so that the reason is computed on demand.
    """

    one: Block
    other: Block
    reason: AsymmetryReason | None = None


@dataclass(frozen=True, slots=True)
class Difference:
    """The reason why two processes with the same text up to numbers and variables are not interchangeable."""

    template: str
    one: str
    other: str
    reason: AsymmetryReason


@dataclass(frozen=True, slots=True)
class Symmetry:
    """The symmetries of a network.

    Attributes:
        groups: orbits of at least two blocks of interchangeable processes.
        cycles: cyclic orbits of processes that are not in `groups`.
        asymmetries: a pair of instances that cannot be exchanged, for each template whose instances are neither all
            interchangeable nor in a cyclic orbit.
        terms: the network as terms, to which the renamings refer.
    """

    groups: tuple[SymmetricOrbit, ...]
    cycles: tuple[CyclicOrbit, ...]
    asymmetries: tuple[Asymmetry, ...]
    terms: NetworkTerms

    @property
    def renamings(self) -> Iterable[Renaming]:
        """Generators of the group of automorphisms."""
        yield from (transposition for group in self.groups for transposition in group.transpositions)
        yield from (cycle.rotation for cycle in self.cycles)

    @property
    def differences(self) -> Iterable[Difference]:
        """The reasons why instances of one template cannot be exchanged."""
        processes = self.terms.network.processes
        for asymmetry in self.asymmetries:
            reason = asymmetry.reason or proved_transposition(self.terms, asymmetry.one, asymmetry.other)
            assert isinstance(reason, AsymmetryReason)
            first, second = processes[asymmetry.one[0]], processes[asymmetry.other[0]]
            yield Difference(first.template, first.name, second.name, reason)


def find_symmetry(network: Network, predicates: Sequence[Expression]) -> Symmetry:
    """The symmetries of a network that keep the values of predicates.

    They map runs to runs, run-time errors included.
    """
    return _found(network, tuple(predicates))


@by_network
def _found(network: Network, predicates: tuple[Expression, ...]) -> Symmetry:
    if predicates:
        without_predicates = _found(network, ())
        terms = without_predicates.terms.with_predicates(predicates)
        if terms is not None:
            if not any(map(terms.objection_of_predicates, without_predicates.renamings)):
                return replace(without_predicates, terms=terms)
            if terms.index_types.keeps_names_of(without_predicates.terms.index_types):
                return _symmetry(terms, list(_candidates(terms)))
    return search_symmetry(network, predicates)


def search_symmetry(network: Network, predicates: Sequence[Expression]) -> Symmetry:
    """`find_symmetry` without the cache."""
    known = known_values(network, predicates)
    terms = read(network, predicates, known, coarse_partition(network).never)
    candidates = list(_candidates(terms))
    for members in candidates:
        for other in members[1:]:
            _align(terms, members[0], other)
    terms.settle()
    found = _symmetry(terms, candidates)
    if not predicates:
        note_orbits(terms, [group.members for group in found.groups])
    return found


def _symmetry(terms: NetworkTerms, candidates: Iterable[Sequence[int]]) -> Symmetry:
    cycles, found = _with_cyclic_orbits(terms, _searches(terms, candidates))
    groups = tuple(group for search in found for group in search.groups)
    asymmetries = tuple(search.asymmetry for search in found if search.asymmetry is not None)
    return Symmetry(groups, tuple(cycles), asymmetries, terms)


def _searches(terms: NetworkTerms, candidates: Iterable[Sequence[int]]) -> list[_OrbitSearch]:
    """The orbits of candidates, of each set by itself or of several sets together."""
    singles: list[list[Block]] = [[(member,) for member in members] for members in candidates]
    found = [_search(terms, blocks, most_failures=1) for blocks in singles]
    without_orbit = [search for search in found if search.asymmetry is not None and search.reach == 0]
    for partners in _partnerships(without_orbit):
        joined = _joined(terms, partners, most_failures=1)
        if joined.asymmetry is None:
            return [joined, *(_completed(terms, search) for search in found if search not in partners)]
    found = [_completed(terms, search) for search in found]
    open_ = [search for search in found if search.asymmetry is not None]
    for partners in _partnerships(open_):
        joined = _joined(terms, partners)
        if joined.reach > max(each.reach for each in partners):
            return [joined, *(search for search in found if search not in partners)]
    return found


@dataclass(frozen=True, slots=True)
class _OrbitSearch:
    """The result of a search for orbits among blocks.

    Attributes:
        asymmetry: two blocks that cannot be exchanged; None if all are interchangeable.
    """

    blocks: list[Block]
    groups: list[SymmetricOrbit]
    asymmetry: Asymmetry | None

    @property
    def reach(self) -> int:
        """The number of blocks that are in some orbit."""
        return sum(len(group.members) for group in self.groups)

    @property
    def arrangements(self) -> int:
        """The number of permutations that the transpositions generate."""
        return prod(factorial(len(group.members)) for group in self.groups)


def _completed(terms: NetworkTerms, search: _OrbitSearch) -> _OrbitSearch:
    """The same search without a limit, if it was given up early."""
    return search if search.asymmetry is None else _search(terms, search.blocks)


def _joined(
    terms: NetworkTerms, partners: Sequence[_OrbitSearch], most_failures: int = MOST_FAILED_TRANSPOSITIONS
) -> _OrbitSearch:
    blocks = list(zip(*(sum(each.blocks, ()) for each in partners), strict=True))
    return _search(terms, blocks, most_failures)


def _search(terms: NetworkTerms, blocks: list[Block], most_failures: int = MOST_FAILED_TRANSPOSITIONS) -> _OrbitSearch:
    reason = _order_of_errors(terms, blocks)
    if reason is not None:
        return _OrbitSearch(blocks, [], Asymmetry(blocks[0], blocks[1], reason))
    classes, asymmetry = _classes(terms, blocks, most_failures)
    groups = []
    for each in classes:
        if len(each.members) > 1:
            reason = order_matters(terms.network, terms.reader.known, each.members)
            if reason is None:
                groups.append(each)
            else:
                asymmetry = asymmetry or Asymmetry(each.members[0], each.members[1], reason)
    return _OrbitSearch(blocks, groups, asymmetry)


def _partnerships(searches: Sequence[_OrbitSearch]) -> Iterable[tuple[_OrbitSearch, ...]]:
    """Sets of equally many processes, which may be interchangeable only as blocks of one process of each set."""
    sizes: dict[int, list[_OrbitSearch]] = {}
    for search in searches:
        sizes.setdefault(len(search.blocks), []).append(search)
    for equal in sizes.values():
        if len(equal) > 1:
            yield tuple(equal)
        if len(equal) > 2:
            yield from combinations(equal, 2)


def _with_cyclic_orbits(
    terms: NetworkTerms, searches: list[_OrbitSearch]
) -> tuple[list[CyclicOrbit], list[_OrbitSearch]]:
    """The cyclic orbits of blocks that are not all interchangeable, where these leave fewer states; and the searches
    that they do not replace."""
    cycles: list[CyclicOrbit] = []
    gone: list[_OrbitSearch] = []
    sizes = {len(search.blocks) for search in searches if search.asymmetry is not None}
    for size in sorted(sizes):
        equal = [search for search in searches if search.asymmetry is not None and len(search.blocks) == size]
        for some in subsets(equal):
            if any(search in gone for search in some):
                continue
            cycle = cyclic_orbit_of(
                terms, [sum(blocks, ()) for blocks in zip(*(search.blocks for search in some), strict=True)]
            )
            if cycle is not None and len(cycle.members) > prod(search.arrangements for search in some):
                cycles.append(cycle)
                gone += some
    return cycles, [search for search in searches if search not in gone]


def cyclic_orbit_of(terms: NetworkTerms, blocks: Sequence[Block]) -> CyclicOrbit | None:
    """The cyclic orbit with the blocks in this order; None if there is none."""
    families = list(zip(*blocks, strict=True))
    if _order_of_errors(terms, blocks):
        return None
    if any(len({colours[member] for member in family}) > 1 for colours in _colours(terms) for family in families):
        return None
    cycle = find_cyclic_orbit(terms, families)
    if isinstance(cycle, AsymmetryReason) or order_matters(terms.network, terms.reader.known, cycle.members):
        return None
    return cycle


def _candidates(terms: NetworkTerms) -> Iterable[list[int]]:
    """Sets of processes with the same text up to numbers and variables."""
    network = terms.network
    shapes: dict[Hashable, list[int]] = {}
    for number, process in enumerate(network.processes):
        if not process.edges:
            continue
        shape = (
            process.initial,
            len(process.variables),
            tuple(unit.outline for unit in terms.locations[number]),
            tuple(unit.outline for unit in terms.edges[number]),
        )
        shapes.setdefault(shape, []).append(number)
    return (members for members in shapes.values() if len(members) > 1)


def _pairs(terms: NetworkTerms, one: int, other: int) -> Iterable[tuple[Token, Token, Span]]:
    """The pairs of tokens at the same places of two processes, and of their declared variables."""
    first, second = (terms.network.processes[number] for number in (one, other))
    for variable, another in zip(first.variables, second.variables, strict=True):
        yield variable, another, another.span
    for here, there in ((terms.locations[one], terms.locations[other]), (terms.edges[one], terms.edges[other])):
        for unit, image in zip(here, there, strict=True):
            for token, another_token in zip(unit.every_token, image.every_token, strict=True):
                yield token, another_token, image.span


def _align(terms: NetworkTerms, one: int, other: int) -> None:
    """Unifies the index types of the numbers at the same places of two processes."""
    reader = terms.reader
    for token, another, span in _pairs(terms, one, other):
        if isinstance(token, IndexValue) and isinstance(another, IndexValue):
            reader.index_types.unify(token.node, another.node, 0, span)
        elif isinstance(token, Variable) and isinstance(another, Variable) and token is not another:
            reader.index_types.unify_trees(reader.tree_of(token), reader.tree_of(another), span)


def _order_of_errors(terms: NetworkTerms, blocks: Sequence[Block]) -> AsymmetryReason | None:
    """The reason why the order of processes can be observed by their run-time errors; None if it cannot.

    Invariants are evaluated process by process up to one that is false. So the order matters where an invariant of one
    of these processes, or of a process between them, may be a run-time error.
    """
    members = {member for block in blocks for member in block}
    between = set(range(min(members), max(members))) - members
    for number in (*blocks[0], *sorted(between)):
        for location in terms.network.processes[number].locations:
            if location_can_fail(location, terms.reader.known):
                return AsymmetryReason("an invariant or a rate may be a run-time error", location.span)
    return None


def _classes(
    terms: NetworkTerms, blocks: Sequence[Block], most_failures: int
) -> tuple[list[SymmetricOrbit], Asymmetry | None]:
    """The orbits of the blocks, and two blocks of different orbits if there are several.

    The finer colours take longer to compute, so that they are used only after a transposition has failed.
    """
    for colours in _colours(terms):
        classes, asymmetry = _orbits(terms, blocks, colours, most_failures if colours is terms.colours else 1)
        if asymmetry is None or asymmetry.reason is None:
            break
    return classes, asymmetry


def _colours(terms: NetworkTerms) -> Iterator[Sequence[int]]:
    """Colours of processes, the coarse and cheap ones first; only the finest ones where these are known already."""
    partition = coarse_partition(terms.network)
    if terms.colours is None and terms.reader.known is partition.known:
        yield partition.colours
    yield equitable_partition(terms)


def _orbits(
    terms: NetworkTerms, blocks: Sequence[Block], colours: Sequence[int], most_failures: int
) -> tuple[list[SymmetricOrbit], Asymmetry | None]:
    found: dict[Hashable, list[tuple[list[Block], list[Renaming]]]] = {}
    asymmetry: Asymmetry | None = None
    failures = 0
    for block in blocks:
        similar = found.setdefault(tuple(colours[member] for member in block), [])
        for numbers, transpositions in similar if failures < most_failures else ():
            transposition = proved_transposition(terms, numbers[0], block)
            if isinstance(transposition, Renaming):
                numbers.append(block)
                transpositions.append(transposition)
                failures = 0
                break
            asymmetry = asymmetry or Asymmetry(numbers[0], block, transposition)
            failures += 1
        else:
            similar.append(([block], []))
    if len(found) > 1 and asymmetry is None:
        (one, _), (other, _) = (similar[0] for similar in list(found.values())[:2])
        asymmetry = Asymmetry(one[0], other[0])
    classes = chain.from_iterable(found.values())
    return [SymmetricOrbit(tuple(numbers), tuple(transpositions)) for numbers, transpositions in classes], asymmetry
