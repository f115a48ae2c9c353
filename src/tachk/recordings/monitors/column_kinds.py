"""The kinds of columns: formulas decide whether a column holds texts or numbers, in every format alike."""

from __future__ import annotations

from collections.abc import Collection

from tachk.recordings.monitors.compiler import changed_columns
from tachk.recordings.monitors.texts import text_columns
from tachk.recordings.traces.logs.cell_texts import number_columns, with_numbers
from tachk.recordings.traces.logs.joined import with_texts, worded
from tachk.recordings.traces.trace import Trace, TraceSource
from tachk.syntax.formula import Formula


def read_columns(recording: TraceSource, formulas: Collection[Formula], wanted: Collection[str]) -> Trace:
    """The columns of a recording that some formulas read, as texts or as numbers.

    The formulas decide: what they compare with a text are texts. Columns of which they say only that they change, or
    equal each other, hold texts if some of their texts is none of a number. All others hold numbers and truth values,
    whatever the format takes them for.
    """

    def compared(known: frozenset[str]) -> frozenset[str]:
        return frozenset(name for formula in formulas for name in text_columns(formula, known))

    changed = changed_columns(formulas)
    words = worded(recording)
    texts = compared(words) | (words & changed)
    read = with_texts(recording, texts & {*wanted}).read(wanted)
    numbers = number_columns(read, read.texts - texts)
    numbers -= compared(read.texts - numbers)
    return with_numbers(read, numbers) if numbers else read
