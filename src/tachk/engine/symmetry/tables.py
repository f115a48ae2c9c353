"""What the engine has to know of interchangeable processes: which slots and clocks belong to which of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

from tachk.engine.compiler.program import Interchangeable as Table
from tachk.engine.compiler.program import Program
from tachk.engine.symmetry.automorphism import NetworkTerms, Renaming, cell_images
from tachk.engine.symmetry.detection import InterchangeableTeams, Symmetry, find_symmetry, ring_of
from tachk.engine.symmetry.kinds import AsymmetryReason
from tachk.engine.symmetry.rings import Ring, Team, orbits
from tachk.engine.symmetry.sketch import sketch_of
from tachk.engine.symmetry.terms import cell_nodes
from tachk.model.cell_layout import CellLayout, cell_layout
from tachk.model.expressions import Expression
from tachk.model.network import Network
from tachk.model.types import ChannelType, ClockType


def with_symmetry(program: Program, network: Network, predicates: Sequence[Expression]) -> Program:
    """The program of a network with what is interchangeable in it, where its goals are those of the predicates."""
    if not sketch_of(network).repeats:
        return program
    tables = [table for _, table in tables_of(network, find_symmetry(network, predicates))]
    return replace(program, interchangeable=tuple(table for table in tables if isinstance(table, Table)))


def tables_of(
    network: Network, symmetry: Symmetry
) -> list[tuple[InterchangeableTeams | Ring, Table | AsymmetryReason]]:
    """For each ring and each group what the engine has to know of it, or why it cannot exchange its members."""
    layout, reading = cell_layout(network), symmetry.reading
    found: list[tuple[InterchangeableTeams | Ring, Table | AsymmetryReason]] = []
    clocks: set[int] = set()
    pending: list[InterchangeableTeams | Ring] = [*symmetry.rings, *symmetry.groups]
    for each in pending:
        table = _ring_table(reading, layout, each) if isinstance(each, Ring) else _table(reading, layout, each)
        if isinstance(table, AsymmetryReason) and isinstance(each, InterchangeableTeams):
            ring = ring_of(reading, each.members)
            pending += [ring] if ring is not None and (ring.rotation.variables or ring.rotation.values) else []
        if isinstance(table, Table):
            moved = {clock for own in table.clocks for clock in own}
            if not clocks.isdisjoint(moved):
                table = AsymmetryReason("clocks of theirs belong to other interchangeable processes, too")
            clocks |= moved
        found.append((each, table))
    return found


def in_equal_parts(network: Network, targets: Sequence[Expression]) -> list[list[int]]:
    """The numbers of targets in sets that leave the same processes interchangeable: those that name processes would
    make a search for the others larger. One set where nothing is interchangeable at all."""
    numbers = list(range(len(targets)))
    if len(targets) < 2 or not sketch_of(network).repeats or not interchanged(network, []):
        return [numbers]
    parts: dict[frozenset[tuple[Team, ...]], list[int]] = {}
    for number in numbers:
        parts.setdefault(interchanged(network, [targets[number]]), []).append(number)
    return list(parts.values())


def interchanged(network: Network, predicates: Sequence[Expression]) -> frozenset[tuple[Team, ...]]:
    """The members of each group and ring."""
    symmetry = find_symmetry(network, predicates)
    return frozenset([*(group.members for group in symmetry.groups), *(ring.members for ring in symmetry.rings)])


def _table(reading: NetworkTerms, layout: CellLayout, group: InterchangeableTeams) -> Table | AsymmetryReason:
    """Refused where something belongs to two members at a time, and where there is nothing to exchange."""
    if all(len(reading.network.processes[member].locations) == 1 for member in group.members[0]) and not any(
        exchange.variables or exchange.values for exchange in group.exchanges
    ):
        return AsymmetryReason("they have nothing of their own to be exchanged")
    moves = [_cell_moves(reading, layout, exchange) for exchange in group.exchanges]
    own = _own_cells(layout, moves)
    belongs = [own, *([move[cell] for cell in own] for move in moves)]
    flat = Counter(cell for cells in belongs for cell in cells)
    shared = {cell for cell, count in flat.items() if count > 1}
    for move, cells in zip(moves, belongs[1:], strict=True):
        shared |= set(move) ^ {*own, *cells}
    if shared:
        variable = max((v for v in layout.first if layout.first[v] <= min(shared)), key=layout.first.__getitem__)
        reason = f"`{variable.name}` holds what belongs to two of them at a time: tachk cannot exchange that"
        return AsymmetryReason(reason, variable.span)
    names, tables = _names(reading, layout, group)
    before = len(reading.network.processes)

    def is_number(cell: int) -> bool:
        return not isinstance(layout.types[cell], ClockType | ChannelType)

    def numbers(type_: type) -> tuple[tuple[int, ...], ...]:
        return tuple(
            tuple(layout.initial[cell] for cell in cells if isinstance(layout.types[cell], type_)) for cells in belongs
        )

    return Table(
        slots=tuple(
            (*team, *(before + cell for cell in cells if is_number(cell)))
            for team, cells in zip(group.members, belongs, strict=True)
        ),
        clocks=numbers(ClockType),
        channels=numbers(ChannelType),
        names=tuple((before + cell, table) for cell, table in names),
        tables=tables,
    )


def _ring_table(reading: NetworkTerms, layout: CellLayout, ring: Ring) -> Table:
    """Whatever a rotation moves goes round in a circle of its own, which may begin anywhere."""
    before = len(reading.network.processes)
    slots: list[list[int]] = list(orbits(ring.rotation.processes))
    clocks: list[list[int]] = []
    channels: list[list[int]] = []
    for orbit in orbits(_cell_moves(reading, layout, ring.rotation)):
        if isinstance(layout.types[orbit[0]], ClockType):
            clocks.append([layout.initial[cell] for cell in orbit])
        elif isinstance(layout.types[orbit[0]], ChannelType):
            channels.append([layout.initial[cell] for cell in orbit])
        else:
            slots.append([before + cell for cell in orbit])
    numbers = {root: list(orbits(moved)) for root, moved in ring.rotation.values.items()}
    names, tables = _named_cells(reading, layout, numbers)
    return Table(
        slots=tuple(zip(*slots, strict=True)),
        clocks=tuple(zip(*clocks, strict=True)) or ((),) * len(ring.members),
        channels=tuple(zip(*channels, strict=True)) or ((),) * len(ring.members),
        names=tuple((before + cell, table) for cell, table in names),
        tables=tables,
        cyclic=True,
    )


def _cell_moves(reading: NetworkTerms, layout: CellLayout, exchange: Renaming) -> dict[int, int]:
    """The cells that an exchange moves, with where it moves them to."""
    moves: dict[int, int] = {}
    kinds = reading.kinds
    for variable, first in layout.first.items():
        target = layout.first[exchange.variables.get(variable, variable)]
        images = cell_images(kinds, reading.reader.tree_of(variable), variable.type, exchange)
        for cell, image in enumerate(images):
            if first + cell != target + image:
                moves[first + cell] = target + image
    return moves


def _own_cells(layout: CellLayout, moves: Sequence[dict[int, int]]) -> list[int]:
    """The cells of the first member: those that each exchange moves. Of two members only: the lower of each pair."""
    if len(moves) == 1:
        return sorted(cell for cell, image in moves[0].items() if cell < image)
    return sorted(set(moves[0]).intersection(*moves[1:]))


def _names(
    reading: NetworkTerms, layout: CellLayout, group: InterchangeableTeams
) -> tuple[list[tuple[int, int]], tuple[tuple[int, ...], ...]]:
    """The cells that may name members, each with the number of its table; and the tables."""
    numbers = {}
    for root in group.exchanges[0].values:
        first = _first_number(group, root)
        numbers[root] = [[first, *(exchange.values[root][first] for exchange in group.exchanges)]]
    return _named_cells(reading, layout, numbers)


def _named_cells(
    reading: NetworkTerms, layout: CellLayout, numbers: Mapping[int, Sequence[Sequence[int]]]
) -> tuple[list[tuple[int, int]], tuple[tuple[int, ...], ...]]:
    """As `_names`, where `numbers` holds the names of the members for each kind: of each member as many as lists."""
    tables: dict[tuple[int, int, int], int] = {}
    names = []
    for variable, start in layout.first.items():
        tree = reading.reader.tree_of(variable)
        for cell, node in enumerate(cell_nodes(tree, variable.type)):
            root, shift = reading.kinds.find(node)
            if isinstance(layout.types[start + cell], ClockType | ChannelType):
                continue
            kinds = [(root, shift, number) for number in range(len(numbers.get(root, ())))]
            names += [(start + cell, tables.setdefault(kind, len(tables))) for kind in kinds]
    return names, tuple(tuple(each + shift for each in numbers[root][number]) for root, shift, number in tables)


def _first_number(group: InterchangeableTeams, root: int) -> int:
    """The number of a kind that stands for the first member: the one that each exchange moves."""
    moved = [set(exchange.values[root]) for exchange in group.exchanges]
    return min(moved[0].intersection(*moved[1:]))
