"""Renamings: permutations of the processes, the variables and the numbers of some index types of a network."""

from __future__ import annotations

from collections.abc import Hashable, Mapping

from tachk.base.records import dataclass, field
from tachk.engine.symmetry.index_types import AsymmetryReason, IndexTypes
from tachk.engine.symmetry.terms import ProcessNumber
from tachk.engine.symmetry.unit_texts import Atom
from tachk.model.expressions import Variable

Block = tuple[int, ...]
"""The numbers of processes that are only moved together, such as a cell and its arbiter; often a single one."""


@dataclass(frozen=True, slots=True)
class Renaming:
    """Attributes:
    processes, variables: those that are moved.
    values: for each index type, by its representative node, the numbers that are moved.
    """

    processes: Mapping[int, int] = field(default_factory=dict)
    variables: Mapping[Variable, Variable] = field(default_factory=dict)
    values: Mapping[int, Mapping[int, int]] = field(default_factory=dict)

    def value(self, index_types: IndexTypes, node: int, value: int) -> int:
        """The image of a number at a node."""
        root, shift = index_types.find(node)
        moved = self.values.get(root)
        return value if moved is None else moved.get(value - shift, value - shift) + shift

    def conjugate(self, by: Renaming) -> Renaming:
        """What this one does among the images under another renaming, which is its own inverse."""
        return Renaming(
            {by.processes.get(a, a): by.processes.get(b, b) for a, b in self.processes.items()},
            {by.variables.get(a, a): by.variables.get(b, b) for a, b in self.variables.items()},
            {
                root: {by.values.get(root, {}).get(a, a): by.values.get(root, {}).get(b, b) for a, b in moved.items()}
                for root, moved in self.values.items()
            },
        )

    def atoms(self) -> dict[Atom, Atom]:
        """The image of each atom that is moved."""
        moved = dict[Atom, Atom](self.variables.items())
        moved |= {ProcessNumber(one): ProcessNumber(other) for one, other in self.processes.items()}
        for root, values in self.values.items():
            moved |= {(root, one): (root, other) for one, other in values.items()}
        return moved


@dataclass(slots=True)
class KnownRenamings:
    """The renamings of a network that were tried.

    Attributes:
        transpositions: by two blocks: proved for the network without predicates, or the reason why there is none.
        rotations: the same by families of processes and a step.
        first_blocks: for each block that can be exchanged with others, the first of them.
        places: for each process of a block that can be exchanged with others: the number of the orbit, its place in
            the block, the number of the block.
        refuted: the reasons for the blocks that cannot be exchanged, by what the orbits leave of their numbers.
    """

    transpositions: dict[tuple[Block, Block], Renaming | AsymmetryReason] = field(default_factory=dict)
    rotations: dict[tuple[tuple[Block, ...], int], Renaming | AsymmetryReason] = field(default_factory=dict)
    first_blocks: dict[Block, Block] = field(default_factory=dict)
    places: dict[int, tuple[int, int, int]] = field(default_factory=dict)
    refuted: dict[Hashable, AsymmetryReason] = field(default_factory=dict)
