"""The transpositions of two blocks of processes, and the proofs that they are automorphisms.

A transposition is proved for a network once, and then for the predicates of each query. If a conjugate of it by
automorphisms that are known already has failed, it fails, too: if no two of many interchangeable pairs of processes can
exchange their first processes alone, one attempt shows it.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Sequence

from tachk.base.span import Span
from tachk.engine.symmetry.automorphism import NetworkTerms
from tachk.engine.symmetry.index_types import AsymmetryReason
from tachk.engine.symmetry.matching import corresponding
from tachk.engine.symmetry.renaming import Block, Renaming
from tachk.engine.symmetry.terms import IndexValue, Shift
from tachk.model.expressions import Variable


def proved_transposition(terms: NetworkTerms, one: Block, other: Block) -> Renaming | AsymmetryReason:
    """The transposition of two blocks if it is an automorphism, or the reason why it is not."""
    objection = terms.objection_of_tests(dict(zip((*one, *other), (*other, *one), strict=True)))
    if objection is not None:
        return objection
    transposition = _of_network(terms, one, other)
    return (
        transposition
        if isinstance(transposition, AsymmetryReason)
        else terms.objection_of_predicates(transposition) or transposition
    )


def note_orbits(terms: NetworkTerms, orbits: Iterable[Sequence[Block]]) -> None:
    """Notes that the first block of each orbit can be exchanged with each other one, for proofs that follow."""
    shared = terms.shared
    for number, blocks in enumerate(orbits):
        for block_number, block in enumerate(blocks):
            shared.first_blocks[block] = blocks[0]
            shared.places |= {process: (number, place, block_number) for place, process in enumerate(block)}
    for (one, other), found in shared.transpositions.items():
        if isinstance(found, AsymmetryReason):
            shared.refuted[_up_to_orbits(terms, one, other)] = found


def _of_network(terms: NetworkTerms, one: Block, other: Block) -> Renaming | AsymmetryReason:
    """The transposition of two blocks if it maps the network without the predicates onto itself."""
    shared, network = terms.shared, terms.of_network
    known = shared.transpositions.get((one, other)) or _by_first_blocks(terms, one, other)
    if known is not None:
        return known
    conjugates = _up_to_orbits(terms, one, other)
    refuted = shared.refuted.get(conjugates)
    if refuted is not None:
        return refuted
    found = transposition_of(network, one, other)
    if not isinstance(found, AsymmetryReason):
        found = network.objection(found) or found
    shared.transpositions[one, other] = found
    if isinstance(found, AsymmetryReason):
        shared.refuted[conjugates] = found
    return found


def _by_first_blocks(terms: NetworkTerms, one: Block, other: Block) -> Renaming | None:
    """The transposition of two blocks of an orbit, made of those with the first block of it."""
    shared = terms.shared
    first = shared.first_blocks.get(one)
    if first is None or first == one or shared.first_blocks.get(other) != first:
        return None
    with_one, with_other = (shared.transpositions.get((first, each)) for each in (one, other))
    if not isinstance(with_one, Renaming) or not isinstance(with_other, Renaming):
        return None
    return with_other.conjugate(with_one)


def _up_to_orbits(terms: NetworkTerms, one: Block, other: Block) -> Hashable:
    """Equal for two pairs of blocks if known automorphisms map the processes of one pair to those of the other.

    These permute the blocks of each orbit in every way, and leave all other processes in their places.
    """
    places = terms.shared.places
    blocks: dict[tuple[int, int], int] = {}
    found: list[Hashable] = []
    for process in (*one, *other):
        if process in places:
            orbit, place, block = places[process]
            found.append((orbit, place, blocks.setdefault((orbit, block), len(blocks))))
        else:
            found.append(process)
    return tuple(found)


def transposition_of(terms: NetworkTerms, one: Block, other: Block) -> Renaming | AsymmetryReason:
    """The transposition of two blocks with the variables and numbers in which the texts of their processes differ."""
    variables: dict[Variable, Variable] = {}
    values: dict[int, dict[int, int]] = {}
    processes = dict(zip((*one, *other), (*other, *one), strict=True))

    def mapping_error(number: IndexValue, another: IndexValue, span: Span) -> AsymmetryReason | None:
        if number.value == another.value:
            return None
        root, shift = terms.index_types.find(number.node)
        moved = values.setdefault(root, {})
        here, there = number.value - shift, another.value - shift
        if moved.setdefault(here, there) != there or moved.setdefault(there, here) != here:
            return AsymmetryReason("their numbers do not correspond one to one", span)
        return terms.no_name(root)

    for token, another, span in corresponding(terms, processes):
        if isinstance(token, IndexValue) and isinstance(another, IndexValue):
            reason = mapping_error(token, another, span)
            if reason is not None:
                return reason
        elif isinstance(token, Variable) and isinstance(another, Variable) and token is not another:
            if variables.setdefault(token, another) is not another or variables.setdefault(another, token) is not token:
                return AsymmetryReason(f"`{token.name}` and `{another.name}` do not correspond one to one", span)
        elif isinstance(token, Shift) and token != another:
            return AsymmetryReason("they compute with their numbers", span)
    return Renaming(processes, variables, values)
