"""The parameters of a conformance check. Imports nothing heavy: command lines are made of it."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum

from tachk.base.records import dataclass


class ExplanationDetail(StrEnum):
    """The detail of the explanation for a recording that does not conform."""

    NONE = "none"
    """No explanation."""
    SHORT = "short"
    """The place where it leaves the model, and an edit that would make it a run if one is found in a few seconds."""
    FULL = "full"
    """The same, and all edits near that place are tried."""


@dataclass(frozen=True, slots=True)
class Question:
    """The arguments for reading a recording, as of `tachk.api.model.conform`."""

    tolerance: str | None = None
    late: str | Mapping[str, str] | None = None
    unit: str | None = None
    ports: tuple[int, ...] = ()
    applications: tuple[str, ...] = ()
    explanation: ExplanationDetail = ExplanationDetail.SHORT
