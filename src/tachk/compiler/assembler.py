"""One growing array of code words, with labels and the places in the text its instructions come from."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import field

from tachk.compiler.bytecode import Opcode
from tachk.diagnostics.span import Span
from tachk.records import dataclass


@dataclass(slots=True, eq=False)
class Label:
    """A position that jumps may name before it is known."""

    position: int = -1
    uses: list[int] = field(default_factory=list)


class Assembler:
    def __init__(self) -> None:
        self.code: list[int] = []
        self.sites: list[tuple[int, Span]] = []

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

    def emit_to(self, opcode: Opcode, label: Label) -> None:
        """Appends an instruction whose operand is the position of a label."""
        self.code.append(int(opcode))
        label.uses.append(len(self.code))
        self.code.append(label.position)

    def place(self, label: Label) -> None:
        """Puts a label here."""
        label.position = len(self.code)
        for use in label.uses:
            self.code[use] = label.position
