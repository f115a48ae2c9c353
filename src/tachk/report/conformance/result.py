"""The answer of `tachk.conform`, in the forms in which people and programs read it."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

from tachk.base.frames import data_frame
from tachk.base.notebook import html_table, preformatted
from tachk.recordings.conformance.conform import Conformance
from tachk.report.conformance.json import conformance_to_json
from tachk.report.conformance.text import conformance_to_text

_WORDS = {True: "is a run of", False: "is no run of", None: "may or may not be a run of"}


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ConformanceReport(Conformance):
    """Whether a recording is a run of a model, and where it leaves it.

    Attributes:
        model: the path of the model.
    """

    model: str = field()

    @staticmethod
    def of(found: Conformance, model: str) -> ConformanceReport:
        """An answer with the path of its model."""
        return ConformanceReport(**{each.name: getattr(found, each.name) for each in fields(Conformance)}, model=model)

    def to_dict(self) -> dict[str, Any]:
        """As docs/schema/conform.schema.json describes it."""
        return conformance_to_json([self], self.model)

    def to_rows(self) -> list[dict[str, str | int | float | bool | None]]:
        """One row."""
        refusal = self.refusal
        left_at = None if refusal is None or refusal.event is None else self.recording.events[refusal.event].place
        return [
            {
                "model": self.model,
                "recording": self.recording.source,
                "accepted": self.accepted,
                "events": len(self.recording.events),
                "agreeing": len(self.recording.events) if refusal is None else refusal.happened,
                "leaves_at": left_at,
                "reason": self.reason,
                "states": self.statistics.states_stored,
                "seconds": self.statistics.seconds,
            }
        ]

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        return data_frame(self.to_rows())

    def to_text(self) -> str:
        """The output of `tachk conform`."""
        return conformance_to_text(self, self.model)

    def __str__(self) -> str:
        return self.to_text()

    def __repr__(self) -> str:
        return f"<Conformance: {self._summary}>"

    def _repr_html_(self) -> str:
        (row,) = self.to_rows()
        shown = {name: value for name, value in row.items() if name not in ("model", "recording") and value != ""}
        return f"{html_table(list(shown), [list(shown.values())], self._summary)}\n{preformatted(self.to_text())}"

    @property
    def _summary(self) -> str:
        return f"{self.recording.source} {_WORDS[self.accepted]} {self.model}"
