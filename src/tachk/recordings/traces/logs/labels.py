"""Columns of texts: the texts of a trace are numbered, and monitors see the numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import replace
from tachk.recordings.traces.trace import Trace, Values


class Labels:
    """The texts of a trace, numbered in the order in which they are met."""

    def __init__(self) -> None:
        self._numbers: dict[str, int] = {}
        self._columns: list[str] = []

    def codes(self, words: Sequence[Any], column: str, name: str, begin: int = 0) -> NDArray[np.float64]:
        """The numbers of the texts of a column; a missing one means that the text stays.

        Args:
            begin: the number of the first row.

        Raises UsageError.
        """
        self._columns.append(column)
        last = -1
        codes = np.empty(len(words))
        for row, word in enumerate(words):
            if isinstance(word, str):
                last = self.number(word)
            elif not (word is None or word != word or type(word).__name__ == "NAType"):
                raise UsageError(
                    f"{name}: column {column!r} has texts, and {word!r} in row {begin + row}",
                    "a column has values of one kind",
                )
            elif last < 0:
                raise UsageError(
                    f"{name}: column {column!r} has no value in the first row",
                    "a missing value means that the value stays, so the first row has to give one",
                )
            codes[row] = last
        return codes

    def recoded(self, codes: Values, labels: Sequence[str], column: str) -> NDArray[np.float64]:
        """The numbers of a column that are those of other labels."""
        self._columns.append(column)
        table = np.array([self.number(word) for word in labels] or [0], dtype=np.float64)
        return table[codes.astype(np.int64)]

    def number(self, word: str) -> int:
        """The number of a text."""
        return self._numbers.setdefault(word, len(self._numbers))

    @property
    def known(self) -> tuple[str, ...]:
        """All texts that have a number, in order."""
        return tuple(self._numbers)

    def on(self, trace: Trace) -> Trace:
        """A trace that knows them."""
        return replace(trace, texts=frozenset(self._columns), labels=self.known) if self._columns else trace
