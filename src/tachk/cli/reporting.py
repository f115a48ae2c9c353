"""The forms and destinations of reports, as options of commands. Imports nothing heavy."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

from tachk.base.records import dataclass

if TYPE_CHECKING:
    from pathlib import Path


class EvidenceChoice(StrEnum):
    """The runs that can be the evidence for an answer."""

    SOME = "some"
    SHORTEST = "shortest"
    FASTEST = "fastest"
    SLOWEST = "slowest"
    NONE = "none"


class WantedAnswer(StrEnum):
    """The answers whose region can be searched."""

    HOLDS = "holds"
    FAILS = "fails"


@dataclass(frozen=True, slots=True)
class Reporting:
    """The form and the destination of a report.

    Attributes:
        form: one of those that the command offers.
        output: the file of the report; None: standard output.
        quiet: nothing is reported; only the exit status gives the answer.
    """

    form: str = "text"
    output: Path | None = None
    quiet: bool = False

    @property
    def on_screen(self) -> bool:
        """True if people read the report where the command prints its messages, too."""
        return self.form == "text" and self.output is None and not self.quiet


@dataclass(frozen=True, slots=True)
class ViolationReporting:
    """Reports of `tachk monitor` beside the verdicts.

    Attributes:
        all_violations: each, not only the first of each formula.
        signals: a file for the values of formulas over time.
    """

    all_violations: bool = False
    signals: Path | None = None


@dataclass(frozen=True, slots=True)
class RunReporting(Reporting):
    """Options for the report of answers.

    Attributes:
        trace: the runs that are given as evidence; None: some, of unexpected answers only.
        every_trace: those of expected answers too.
        junit, sarif: files for the same answers in these formats, beside the report.
    """

    trace: EvidenceChoice | None = None
    every_trace: bool = False
    junit: Path | None = None
    sarif: Path | None = None

    @property
    def beside(self) -> dict[str, Path]:
        """The files beside the report, by format."""
        return {form: path for form, path in (("junit", self.junit), ("sarif", self.sarif)) if path is not None}

    @property
    def evidence(self) -> EvidenceChoice:
        return self.trace or EvidenceChoice.SOME

    @property
    def shows_every_run(self) -> bool:
        return self.every_trace or self.trace is not None
