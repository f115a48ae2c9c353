"""One growing array of code words, with labels and the places in the text its instructions come from."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from tachk.base.records import dataclass, field
from tachk.base.span import Span
from tachk.engine.compiler.bytecode import Opcode


@dataclass(slots=True, eq=False)
class JumpLabel:
    """A position that jumps may name before it is known."""

    position: int = -1
    uses: list[int] = field(default_factory=list)


class Assembler:
    """Attributes:
    sites: pairs (position, place in the text), from that position on.
    jumps: where the positions of labels stand.
    """

    def __init__(self) -> None:
        self.code: list[int] = []
        self.sites: list[tuple[int, Span]] = []
        self.jumps: list[int] = []

    def emit(self, opcode: Opcode, *operands: int, span: Span | None = None) -> None:
        """Appends an instruction; one that can fail says where it comes from."""
        if span is not None and (not self.sites or self.sites[-1][1] is not span):
            self.sites.append((len(self.code), span))
        self.code.append(int(opcode))
        self.code.extend(operands)

    def data(self, words: Iterable[int]) -> int:
        """Appends words that are no instructions; their position."""
        start = len(self.code)
        self.code.extend(words)
        return start

    def append(self, piece: Assembler, changed: Mapping[int, int]) -> None:
        """Appends code whose labels are all inside it, with other words at some of its positions."""
        start = len(self.code)
        for position, span in piece.sites:
            if not self.sites or self.sites[-1][1] is not span:
                self.sites.append((start + position, span))
        self.code.extend(piece.code)
        for position in piece.jumps:
            self.code[start + position] += start
            self.jumps.append(start + position)
        for position, word in changed.items():
            self.code[start + position] = word

    def emit_to(self, opcode: Opcode, label: JumpLabel) -> None:
        """Appends an instruction whose operand is the position of a label."""
        self.code.append(int(opcode))
        label.uses.append(len(self.code))
        self.jumps.append(len(self.code))
        self.code.append(label.position)

    def place(self, label: JumpLabel) -> None:
        """Puts a label here."""
        label.position = len(self.code)
        for use in label.uses:
            self.code[use] = label.position
