"""What the engine has to know of interchangeable processes: which slots and clocks belong to which of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from tachk.compiler.program import Interchangeable as Table
from tachk.compiler.program import Program
from tachk.model.cell_layout import CellLayout, cell_layout
from tachk.model.expressions import Expression
from tachk.model.network import Network
from tachk.model.types import ChannelType, ClockType
from tachk.reduction.symmetry.automorphism import Reading, Renaming, cell_images
from tachk.reduction.symmetry.detection import Interchangeable, find_symmetry
from tachk.reduction.symmetry.terms import cell_nodes


def with_symmetry(program: Program, network: Network, predicates: Sequence[Expression]) -> Program:
    """The program of a network with what is interchangeable in it, where its goals are those of the predicates."""
    if not repeats(network):
        return program
    symmetry = find_symmetry(network, predicates)
    layout = cell_layout(network)
    tables: list[Table] = []
    clocks: set[int] = set()
    for group in symmetry.groups:
        table = _table(symmetry.reading, layout, group)
        if table is None or not clocks.isdisjoint(clock for own in table.clocks for clock in own):
            continue
        clocks.update(clock for own in table.clocks for clock in own)
        tables.append(table)
    return replace(program, interchangeable=tuple(tables))


def in_equal_parts(network: Network, targets: Sequence[Expression]) -> list[list[int]]:
    """The numbers of targets in sets that leave the same processes interchangeable: those that name processes would
    make a search for the others larger. One set where nothing is interchangeable at all."""
    numbers = list(range(len(targets)))
    if len(targets) < 2 or not repeats(network) or not find_symmetry(network, []).groups:
        return [numbers]
    parts: dict[frozenset[tuple[tuple[int, ...], ...]], list[int]] = {}
    for number in numbers:
        groups = find_symmetry(network, [targets[number]]).groups
        parts.setdefault(frozenset(group.members for group in groups), []).append(number)
    return list(parts.values())


def repeats(network: Network) -> bool:
    """Whether two processes may have the same text: a quick look."""
    shapes = [(len(p.locations), len(p.edges), len(p.variables), p.initial) for p in network.processes if p.edges]
    return len(set(shapes)) < len(shapes)


def _table(reading: Reading, layout: CellLayout, group: Interchangeable) -> Table | None:
    """None where something belongs to two members at a time, and where there is nothing to exchange."""
    if all(len(reading.network.processes[member].locations) == 1 for member in group.members[0]) and not any(
        exchange.variables or exchange.values for exchange in group.exchanges
    ):
        return None
    moves = [_cell_moves(reading, layout, exchange) for exchange in group.exchanges]
    own = _own_cells(layout, moves)
    belongs = [own, *([move[cell] for cell in own] for move in moves)]
    flat = [cell for cells in belongs for cell in cells]
    if len(set(flat)) != len(flat):
        return None
    for move, cells in zip(moves, belongs[1:], strict=True):
        if set(move) != {*own, *cells}:
            return None
    names, tables = _names(reading, layout, group)
    before = len(reading.network.processes)

    def is_number(cell: int) -> bool:
        return not isinstance(layout.types[cell], ClockType | ChannelType)

    return Table(
        slots=tuple(
            (*team, *(before + cell for cell in cells if is_number(cell)))
            for team, cells in zip(group.members, belongs, strict=True)
        ),
        clocks=tuple(
            tuple(layout.initial[cell] for cell in cells if isinstance(layout.types[cell], ClockType))
            for cells in belongs
        ),
        names=tuple((before + cell, table) for cell, table in names),
        tables=tables,
    )


def _cell_moves(reading: Reading, layout: CellLayout, exchange: Renaming) -> dict[int, int]:
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
    reading: Reading, layout: CellLayout, group: Interchangeable
) -> tuple[list[tuple[int, int]], tuple[tuple[int, ...], ...]]:
    """The cells that may name members, each with the number of its table; and the tables."""
    numbers = {
        root: [next(iter(moved)) for moved in [group.exchanges[0].values[root]]] for root in group.exchanges[0].values
    }
    for root in numbers:
        first = _first_number(group, root)
        numbers[root] = [first, *(exchange.values[root][first] for exchange in group.exchanges)]
    tables: dict[tuple[int, int], int] = {}
    names = []
    for variable, start in layout.first.items():
        tree = reading.reader.tree_of(variable)
        for cell, node in enumerate(cell_nodes(tree, variable.type)):
            kind = reading.kinds.find(node)
            if kind[0] in numbers and not isinstance(layout.types[start + cell], ClockType | ChannelType):
                names.append((start + cell, tables.setdefault(kind, len(tables))))
    return names, tuple(tuple(number + shift for number in numbers[root]) for root, shift in tables)


def _first_number(group: Interchangeable, root: int) -> int:
    """The number of a kind that stands for the first member: the one that each exchange moves."""
    moved = [set(exchange.values[root]) for exchange in group.exchanges]
    return min(moved[0].intersection(*moved[1:]))
