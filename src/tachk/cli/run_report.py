"""The report of `tachk verify`, in whatever form: of some models, among them such as could not be read."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TextIO

from tachk.base.diagnostics.diagnostic import InputError, Severity, UnsupportedError, UsageError
from tachk.base.job import StoppedError
from tachk.base.records import dataclass
from tachk.cli.guard import without_result
from tachk.cli.reporting import EvidenceChoice, ReportForm, Reporting
from tachk.cli.terminal import console
from tachk.report.record import NotRead, RunRecord
from tachk.report.run.display import RunDisplay


@dataclass(frozen=True, slots=True)
class RunReporting(Reporting):
    """How answers are reported.

    Attributes:
        trace: the runs that are given as evidence; None: some, of unexpected answers only.
        every_trace: those of expected answers too.
    """

    trace: EvidenceChoice | None = None
    every_trace: bool = False

    @property
    def evidence(self) -> EvidenceChoice:
        return self.trace or EvidenceChoice.SOME

    @property
    def tells_every_run(self) -> bool:
        return self.every_trace or self.trace is not None


class RunReport:
    """What people read is written about each model when it has been checked, what programs read at the end."""

    def __init__(self, out: TextIO | None, reporting: RunReporting, display: RunDisplay) -> None:
        self._out = out
        self._reporting = reporting
        self._telling = display
        self._records: list[RunRecord | NotRead] = []

    @contextmanager
    def listing(self, model: str = "") -> Iterator[None]:
        """An error about a model goes into the report, too. Without a name: an error about all of them."""
        try:
            yield
        except InputError as error:
            errors = [found for found in error.diagnostics if found.severity is Severity.ERROR]
            self._records.append(NotRead(model, errors[0].message, None, error.diagnostics))
            raise
        except UnsupportedError as error:
            self._records.append(NotRead(model, error.diagnostic.message, None, (error.diagnostic,)))
            raise
        except UsageError as error:
            self._records.append(NotRead(model, error.message, error.help))
            raise
        except StoppedError as error:
            self._records.append(NotRead(model, without_result(error)))
            raise
        except Exception as error:
            self._records.append(NotRead(model, f"{type(error).__name__}: {error}"))
            raise

    def add(self, record: RunRecord) -> None:
        """One model has been checked."""
        if self._out is not None and self._reporting.form is ReportForm.TEXT:
            if any(isinstance(before, RunRecord) for before in self._records):
                self._out.write("\n")
            from tachk.report.text_report import print_run

            print_run(record, console(self._out), self._reporting.tells_every_run, self._telling)
        elif self._out is not None and self._reporting.form is ReportForm.VERIFYTA:
            self._write_as_verifyta(record, self._out)
        self._records.append(record)

    def _write_as_verifyta(self, record: RunRecord, out: TextIO) -> None:
        """The report, and on standard error the traces that were asked for: where verifyta writes them."""
        from tachk.report.run.verifyta_trace import concrete_trace
        from tachk.report.verifyta_report import run_to_verifyta

        wanted = self._reporting.tells_every_run and self._reporting.evidence is not EvidenceChoice.NONE
        out.write(run_to_verifyta(record, self._reporting.evidence.value if wanted else "no"))
        for verdict in record.verdicts:
            if wanted and verdict.trace is not None:
                print(concrete_trace(record.network, verdict.trace), file=sys.stderr)

    def finish(self) -> None:
        """All models have been checked."""
        if self._out is None:
            return
        if self._reporting.form is ReportForm.JSON:
            from tachk.report.json_report import runs_to_json
            from tachk.report.json_text import json_text

            self._out.write(json_text(runs_to_json(self._records, self._telling.every_step)))
        elif self._reporting.form is ReportForm.JUNIT:
            from tachk.report.junit_report import runs_to_junit

            self._out.write(runs_to_junit(self._records))
