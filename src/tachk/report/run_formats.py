"""The formats of the report of `tachk verify`, one row each, listed here only.

The module of a format is imported when a report is written in it: the command line names all of them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, TextIO

from tachk.base.plugins import load_object
from tachk.base.records import dataclass
from tachk.report.run.display import RunDisplay

if TYPE_CHECKING:
    from rich.console import Console

    from tachk.report.record import NotRead, RunRecord

RUN_FORMATS = {
    "text": "tachk.report.text_report:TextReport",
    "json": "tachk.report.json_report:JsonReport",
    "junit": "tachk.report.junit_report:JunitReport",
    "sarif": "tachk.report.annotated_answers:SarifReport",
    "github": "tachk.report.annotated_answers:GithubReport",
    "verifyta": "tachk.report.verifyta_report:VerifytaReport",
}
"""The subclass of `ReportWriter` that writes each format."""


@dataclass(frozen=True, slots=True)
class Presentation:
    """Options of a report for choices that its format leaves open.

    Attributes:
        console: makes the console for a stream that people read.
        every_trace: the runs behind expected answers are shown too.
        evidence: the runs that were searched, ``none`` or such as ``shortest``.
        display: display options of runs.
    """

    console: Callable[[TextIO], Console]
    every_trace: bool
    evidence: str
    display: RunDisplay


class ReportWriter:
    """Writes a report: about each model when it has been checked, or about all models at the end."""

    def __init__(self, out: TextIO, presentation: Presentation) -> None:
        self.out = out
        self.presentation = presentation

    def add(self, record: RunRecord) -> None:
        """A model has been checked."""

    def finish(self, records: Sequence[RunRecord | NotRead]) -> None:
        """All models have been checked, but for those that could not be read."""


def report_writer(form: str, out: TextIO, presentation: Presentation) -> ReportWriter:
    """Args:
    form: one of `RUN_FORMATS`.
    """
    writer: ReportWriter = load_object(RUN_FORMATS[form])(out, presentation)
    return writer
