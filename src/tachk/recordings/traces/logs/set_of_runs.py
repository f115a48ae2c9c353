"""A file of several runs, as a set of recordings."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.trace import Trace, TraceSource


@dataclass(frozen=True, slots=True, eq=False)
class SeveralRuns:
    """Attributes:
    runs: by their numbers.
    """

    name: str
    runs: Mapping[str, TraceSource] = field(repr=False)

    @property
    def unit(self) -> str:
        return self._any().unit

    @property
    def columns(self) -> tuple[str, ...]:
        return self._any().columns

    def read(self, columns: Collection[str] | None = None) -> Trace:
        numbers = list(self.runs)
        known = f"{', '.join(numbers[:10])}{', ...' if len(numbers) > 10 else ''}"
        raise UsageError(f"{self.name} holds several runs: {known}", f"choose one: --run {numbers[0]}")

    def _any(self) -> TraceSource:
        return next(iter(self.runs.values()))
