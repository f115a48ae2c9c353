"""Symmetry tables of the engine: the slots and clocks of each interchangeable process."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from tachk.base.records import replace
from tachk.engine.compiler.program import Interchangeable as Table
from tachk.engine.compiler.program import Program
from tachk.engine.symmetry.automorphism import NetworkTerms, slot_images
from tachk.engine.symmetry.coarse_partition import coarse_partition
from tachk.engine.symmetry.cyclic_symmetry import CyclicOrbit, orbits
from tachk.engine.symmetry.detection import SymmetricOrbit, Symmetry, cyclic_orbit_of, find_symmetry
from tachk.engine.symmetry.index_types import AsymmetryReason
from tachk.engine.symmetry.renaming import Block, Renaming
from tachk.engine.symmetry.terms import slot_nodes
from tachk.model.expressions import Expression
from tachk.model.network import Network
from tachk.model.types import ChannelType, ClockType
from tachk.model.variable_layout import VariableLayout, variable_layout


def with_symmetry(program: Program, network: Network, predicates: Sequence[Expression]) -> Program:
    """The program with the symmetry tables of its network; its goals are the predicates.

    Where clocks are compared with each other a state may have several zones, and the core permutes nothing.
    """
    if program.diagonals or not coarse_partition(network).repeats:
        return program
    tables = [table for _, table in tables_of(network, find_symmetry(network, predicates))]
    return replace(program, interchangeable=tuple(table for table in tables if isinstance(table, Table)))


def tables_of(
    network: Network, symmetry: Symmetry
) -> list[tuple[SymmetricOrbit | CyclicOrbit, Table | AsymmetryReason]]:
    """The orbits of a network, each with its table, or with the reason why the engine cannot exchange its members."""
    layout, terms = variable_layout(network), symmetry.terms
    found: list[tuple[SymmetricOrbit | CyclicOrbit, Table | AsymmetryReason]] = []
    clocks: set[int] = set()
    pending: list[SymmetricOrbit | CyclicOrbit] = [*symmetry.cycles, *symmetry.groups]
    for each in pending:
        table = _cyclic_table(terms, layout, each) if isinstance(each, CyclicOrbit) else _table(terms, layout, each)
        if isinstance(table, AsymmetryReason) and isinstance(each, SymmetricOrbit):
            cycle = cyclic_orbit_of(terms, each.members)
            pending += [cycle] if cycle is not None and (cycle.rotation.variables or cycle.rotation.values) else []
        if isinstance(table, Table):
            moved = {clock for own in table.clocks for clock in own}
            if not clocks.isdisjoint(moved):
                table = AsymmetryReason("clocks of theirs belong to other interchangeable processes, too")
            clocks |= moved
        found.append((each, table))
    return found


def by_interchangeable_processes(network: Network, targets: Sequence[Expression]) -> list[list[int]]:
    """The numbers of targets, grouped by the symmetries that they keep: a target that names processes would make the
    search for the others larger. A single group if the network has no symmetry."""
    numbers = list(range(len(targets)))
    if len(targets) < 2 or not coarse_partition(network).repeats or not interchanged(network, []):
        return [numbers]
    parts: dict[frozenset[tuple[Block, ...]], list[int]] = {}
    for number in numbers:
        parts.setdefault(interchanged(network, [targets[number]]), []).append(number)
    return list(parts.values())


def interchanged(network: Network, predicates: Sequence[Expression]) -> frozenset[tuple[Block, ...]]:
    """The members of each orbit."""
    symmetry = find_symmetry(network, predicates)
    return frozenset([*(group.members for group in symmetry.groups), *(cycle.members for cycle in symmetry.cycles)])


def _table(terms: NetworkTerms, layout: VariableLayout, group: SymmetricOrbit) -> Table | AsymmetryReason:
    """The table of an orbit, or the reason why there is none: a slot belongs to two members, or nothing is moved."""
    if all(len(terms.network.processes[member].locations) == 1 for member in group.members[0]) and not any(
        transposition.variables or transposition.values for transposition in group.transpositions
    ):
        return AsymmetryReason("they have nothing of their own to be exchanged")
    moves = [_slot_moves(terms, layout, transposition) for transposition in group.transpositions]
    own = _own_slots(layout, moves)
    belongs = [own, *([move[slot] for slot in own] for move in moves)]
    flat = Counter(slot for slots in belongs for slot in slots)
    shared = {slot for slot, count in flat.items() if count > 1}
    for move, slots in zip(moves, belongs[1:], strict=True):
        shared |= set(move) ^ {*own, *slots}
    if shared:
        variable = max((v for v in layout.first if layout.first[v] <= min(shared)), key=layout.first.__getitem__)
        reason = f"`{variable.name}` holds what belongs to two of them at a time: tachk cannot exchange that"
        return AsymmetryReason(reason, variable.span)
    names, tables = _names(terms, layout, group)
    before = len(terms.network.processes)

    def is_number(slot: int) -> bool:
        return not isinstance(layout.types[slot], ClockType | ChannelType)

    def numbers(type_: type) -> tuple[tuple[int, ...], ...]:
        return tuple(
            tuple(layout.initial[slot] for slot in slots if isinstance(layout.types[slot], type_)) for slots in belongs
        )

    return Table(
        slots=tuple(
            (*block, *(before + slot for slot in slots if is_number(slot)))
            for block, slots in zip(group.members, belongs, strict=True)
        ),
        clocks=numbers(ClockType),
        channels=numbers(ChannelType),
        names=tuple((before + slot, table) for slot, table in names),
        tables=tables,
    )


def _cyclic_table(terms: NetworkTerms, layout: VariableLayout, cycle: CyclicOrbit) -> Table:
    """The table of a cyclic orbit: one column for each orbit of the rotation on slots, clocks and channels."""
    before = len(terms.network.processes)
    slots: list[list[int]] = list(orbits(cycle.rotation.processes))
    clocks: list[list[int]] = []
    channels: list[list[int]] = []
    for orbit in orbits(_slot_moves(terms, layout, cycle.rotation)):
        if isinstance(layout.types[orbit[0]], ClockType):
            clocks.append([layout.initial[slot] for slot in orbit])
        elif isinstance(layout.types[orbit[0]], ChannelType):
            channels.append([layout.initial[slot] for slot in orbit])
        else:
            slots.append([before + slot for slot in orbit])
    numbers = {root: list(orbits(moved)) for root, moved in cycle.rotation.values.items()}
    names, tables = _named_slots(terms, layout, numbers)
    return Table(
        slots=tuple(zip(*slots, strict=True)),
        clocks=tuple(zip(*clocks, strict=True)) or ((),) * len(cycle.members),
        channels=tuple(zip(*channels, strict=True)) or ((),) * len(cycle.members),
        names=tuple((before + slot, table) for slot, table in names),
        tables=tables,
        cyclic=True,
    )


def _slot_moves(terms: NetworkTerms, layout: VariableLayout, transposition: Renaming) -> dict[int, int]:
    """The slots that a renaming moves, each with its image."""
    moves: dict[int, int] = {}
    index_types = terms.index_types
    moved = (variable for variable in terms.moved_variables(transposition) if variable in layout.first)
    for variable in sorted(moved, key=layout.first.__getitem__):
        first, target = layout.first[variable], layout.first[transposition.variables.get(variable, variable)]
        images = slot_images(index_types, terms.reader.tree_of(variable), variable.type, transposition)
        for slot, image in enumerate(images):
            if first + slot != target + image:
                moves[first + slot] = target + image
    return moves


def _own_slots(layout: VariableLayout, moves: Sequence[dict[int, int]]) -> list[int]:
    """The slots of the first member: those that every transposition moves; of two members the lower of each pair."""
    if len(moves) == 1:
        return sorted(slot for slot, image in moves[0].items() if slot < image)
    return sorted(set(moves[0]).intersection(*moves[1:]))


def _names(
    terms: NetworkTerms, layout: VariableLayout, group: SymmetricOrbit
) -> tuple[list[tuple[int, int]], tuple[tuple[int, ...], ...]]:
    """The slots that may name members, each with the number of its table; and the tables."""
    numbers = {}
    for root in group.transpositions[0].values:
        first = _first_number(group, root)
        numbers[root] = [[first, *(transposition.values[root][first] for transposition in group.transpositions)]]
    return _named_slots(terms, layout, numbers)


def _named_slots(
    terms: NetworkTerms, layout: VariableLayout, numbers: Mapping[int, Sequence[Sequence[int]]]
) -> tuple[list[tuple[int, int]], tuple[tuple[int, ...], ...]]:
    """As `_names`, where `numbers` holds for each index type the lists of the names of the members."""
    tables: dict[tuple[int, int, int], int] = {}
    names = []
    for variable, start in layout.first.items():
        tree = terms.reader.tree_of(variable)
        for slot, node in enumerate(slot_nodes(tree, variable.type)):
            root, shift = terms.index_types.find(node)
            if isinstance(layout.types[start + slot], ClockType | ChannelType):
                continue
            index_types = [(root, shift, number) for number in range(len(numbers.get(root, ())))]
            names += [(start + slot, tables.setdefault(index_type, len(tables))) for index_type in index_types]
    return names, tuple(tuple(each + shift for each in numbers[root][number]) for root, shift, number in tables)


def _first_number(group: SymmetricOrbit, root: int) -> int:
    """The number of an index type that names the first member: the one that every transposition moves."""
    moved = [set(transposition.values[root]) for transposition in group.transpositions]
    return min(moved[0].intersection(*moved[1:]))
