"""The answer of `tachk monitor --find` as text, and as docs/schema/mine.schema.json describes it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from tachk.base.frames import data_frame
from tachk.base.notebook import folded, html_table
from tachk.base.plain_data import Fields, PlainData
from tachk.model.quantity import decimal
from tachk.recordings.monitors.mined import Mined
from tachk.report.json_report import Json
from tachk.report.monitor.json import first_finding
from tachk.report.monitor.words import explain_verdict


@dataclass(frozen=True, slots=True, eq=False)
class MiningReport(Mined):
    """Mined values, in the forms in which people and programs read them."""

    def to_dict(self) -> dict[str, Json]:
        """As docs/schema/mine.schema.json describes it."""
        return _PLAIN.of(self)

    def to_text(self) -> str:
        """The output of `tachk monitor --find`."""
        return "".join(f"{line}\n" for line in self._lines())

    def to_rows(self) -> list[dict[str, str | float | bool | None]]:
        """A row for each trace: the tightest value with which it alone satisfies the formula, None where there is
        none, and whether that value itself does."""
        return [
            {
                "trace": each.trace,
                "parameter": self.parameter,
                "value": None if each.value is None else float(each.value),
                "attained": each.attained,
            }
            for each in self.traces
        ]

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        return data_frame(self.to_rows())

    __str__ = to_text

    def __repr__(self) -> str:
        return f"<MiningReport {self.name}: {self._summary}>"

    def _repr_html_(self) -> str:
        rows = [list(row.values()) for row in self.to_rows()]
        table = html_table(["trace", "parameter", "value", "attained"], rows, f"{self.formula}: {self._summary}")
        return f"{table}\n{folded('in words', self.to_text())}"

    @property
    def _summary(self) -> str:
        if self.tightest is not None and self.value is not None:
            beyond = ">" if self.tightest == "least" else "<"
            value = _text(self.value)
            found = f"{self.tightest} {self.parameter} = {value}"
            return found if self.attained else f"{self.parameter} {beyond} {value}"
        found = ", ".join(f"{_text(low)} to {_text(high)}" for low, high in self.ranges)
        return f"{self.parameter}: {found or 'no value'}"

    def _lines(self) -> Iterator[str]:
        yield f"{self.name}: {self.formula}"
        yield ""
        within = f"from {_text(self.low)} to {_text(self.high)}"
        if self.tightest is None:
            yield f"it is not known that a larger {self.parameter} makes the formula only easier or only harder,"
            yield f"so values {within} were tried one by one; those that satisfy it:"
            found = [_text(a) if a == b else f"{_text(a)} to {_text(b)}" for a, b in self.ranges]
            yield f"  {self.parameter} = {', '.join(each or '' for each in found)}" if found else "  none"
            return
        if self.value is None:
            yield f"no {self.parameter} {within} satisfies it"
        elif self.trace is None:
            yield f"every {self.parameter} {within} satisfies it"
        elif self.attained:
            tried = "" if self.exact else ", of the values that were tried,"
            yield f"{self.parameter} = {_text(self.value)} is{tried} the {self.tightest} that satisfies it"
        else:
            sign = ">" if self.tightest == "least" else "<"
            yield f"every {self.parameter} {sign} {_text(self.value)} satisfies it, but {_text(self.value)} does not"
        if self.undecided:
            yield f"open at the end, which counts as satisfied: {', '.join(self.undecided)}"
        if len(self.traces) > 1:
            yield ""
            width = max(len("trace"), *(len(each.trace) for each in self.traces))
            yield f"  {'trace':{width}}  {self.tightest} {self.parameter}"
            for each in self.traces:
                value = "none" if each.value is None else f"{'' if each.attained else 'beyond '}{_text(each.value)}"
                yield f"  {each.trace:{width}}  {value}"
        if self.record is not None:
            yield ""
            yield f"{self.trace} with {self.parameter} = {_text(self.violating)}:"
            yield from (f"  {line}" for line in explain_verdict(self.record, self.record.verdicts[0]))


def _text(value: Fraction | None) -> str | None:
    return None if value is None else decimal(value, 60)


_PLAIN = PlainData(
    {
        MiningReport: Fields(
            "name formula parameter low high monotone tightest value attained exact trace violating finding traces "
            "undecided ranges",
            monotone=lambda mined: mined.tightest is not None,
            finding=lambda mined: first_finding(mined.record),
        ),
        Fraction: _text,
    }
)
