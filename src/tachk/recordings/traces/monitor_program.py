"""A formula made ready for monitoring: a graph of operators over the columns of a trace, all times in ticks.

What the C++ core reads. Cells of time, which make open and closed bounds exact, are described in docs/logic.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum


class ValueOperator(IntEnum):
    """Instructions of an arithmetic program in postfix order, over doubles."""

    CONSTANT = 0
    COLUMN = 1
    ADD = 2
    SUBTRACT = 3
    MULTIPLY = 4
    DIVIDE = 5
    MODULO = 6
    NEGATE = 7
    ABSOLUTE = 8
    MINIMUM = 9
    MAXIMUM = 10


@dataclass(frozen=True, slots=True)
class ValueInstruction:
    """Attributes:
    operand: the number of CONSTANT, the column number of COLUMN, else 0.
    """

    operator: ValueOperator
    operand: float = 0.0


class AtomRelation(IntEnum):
    """The relation of an atom's left to its right value. TRUTH: the left value is not zero; there is no right one."""

    TRUTH = 0
    LESS = 1
    LESS_EQUAL = 2
    GREATER = 3
    GREATER_EQUAL = 4
    EQUAL = 5
    NOT_EQUAL = 6


class NodeKind(IntEnum):
    """EVENTUALLY and ALWAYS look ahead, ONCE and HISTORICALLY back; UNTIL and SINCE are half-open."""

    FALSE = 0
    TRUE = 1
    ATOM = 2
    NOT = 3
    AND = 4
    OR = 5
    RISE = 6
    FALL = 7
    CHANGE = 8
    EVENTUALLY = 9
    ALWAYS = 10
    ONCE = 11
    HISTORICALLY = 12
    UNTIL = 13
    SINCE = 14


UNBOUNDED = -1
"""The upper bound of an interval without end."""


@dataclass(frozen=True, slots=True)
class MonitorAtom:
    """Attributes:
    left, right: values; ``right`` is empty for TRUTH.
    text: as printed.
    """

    relation: AtomRelation
    left: tuple[ValueInstruction, ...]
    right: tuple[ValueInstruction, ...]
    text: str


@dataclass(frozen=True, slots=True)
class MonitorNode:
    """Attributes:
    operands: numbers of earlier nodes; AND and OR have two or more.
    atom: the atom's number for ATOM and CHANGE (which watches the atom's left value), else -1.
    lower, upper: ticks; ``upper`` may be `UNBOUNDED`.
    text: the subformula as printed, for diagnosis.
    """

    kind: NodeKind
    operands: tuple[int, ...] = ()
    atom: int = -1
    lower: int = 0
    upper: int = UNBOUNDED
    lower_closed: bool = True
    upper_closed: bool = True
    text: str = ""


@dataclass(frozen=True, slots=True)
class MonitorProgram:
    """Attributes:
    columns: the names of the columns it reads; the numbers in COLUMN index this tuple.
    nodes: operands before operators, shared subformulas once; the last is the formula.
    ticks_per_unit: how many ticks make one time unit of the trace.
    """

    columns: tuple[str, ...]
    atoms: tuple[MonitorAtom, ...]
    nodes: tuple[MonitorNode, ...]
    ticks_per_unit: int


def part_of(program: MonitorProgram, nodes: Sequence[int]) -> tuple[MonitorProgram, list[int]]:
    """The program of some nodes alone, and their numbers in it. A program may have thousands of others."""
    inside: set[int] = set()
    pending = list(nodes)
    while pending:
        node = pending.pop()
        if node not in inside:
            inside.add(node)
            pending += program.nodes[node].operands
    if len(inside) == len(program.nodes):
        return program, list(nodes)
    part_nodes = [program.nodes[node] for node in sorted(inside)]
    numbers = {node: number for number, node in enumerate(sorted(inside))}
    read = {node.atom for node in part_nodes if node.atom >= 0}
    columns: dict[int, int] = {}
    atoms = {atom: _of_columns(program.atoms[atom], columns) for atom in sorted(read)}
    places = {-1: -1, **{atom: number for number, atom in enumerate(atoms)}}
    parts = tuple(
        replace(node, operands=tuple(numbers[operand] for operand in node.operands), atom=places[node.atom])
        for node in part_nodes
    )
    names = tuple(program.columns[column] for column in columns)
    return replace(program, columns=names, atoms=tuple(atoms.values()), nodes=parts), [numbers[node] for node in nodes]


def _of_columns(atom: MonitorAtom, numbers: dict[int, int]) -> MonitorAtom:
    """The atom with other numbers of columns, which are given in the order in which they are read."""

    def changed(code: tuple[ValueInstruction, ...]) -> tuple[ValueInstruction, ...]:
        return tuple(
            replace(each, operand=float(numbers.setdefault(int(each.operand), len(numbers))))
            if each.operator is ValueOperator.COLUMN
            else each
            for each in code
        )

    return replace(atom, left=changed(atom.left), right=changed(atom.right))
