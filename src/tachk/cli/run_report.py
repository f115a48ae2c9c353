"""The report of `tachk verify`, in whatever form: of some models, among them such as could not be read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TextIO

from tachk.base.diagnostics.diagnostic import InputError, Severity, UnsupportedError, UsageError
from tachk.base.job import StoppedError
from tachk.cli.guard import without_result
from tachk.cli.reporting import RunReporting
from tachk.cli.terminal import console
from tachk.report.record import NotRead, RunRecord
from tachk.report.run.display import RunDisplay
from tachk.report.run_formats import Presentation, report_writer


class RunReport:
    """Gathers what was found about each model, also about those that cannot be read, for the writer of the format."""

    def __init__(self, outputs: Mapping[str, TextIO | None], reporting: RunReporting, display: RunDisplay) -> None:
        """Args:
        outputs: the destination of the report in each format; None: nowhere.
        """
        presentation = Presentation(console, reporting.shows_every_run, reporting.evidence.value, display)
        self._writers = [report_writer(form, out, presentation) for form, out in outputs.items() if out is not None]
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
        for writer in self._writers:
            writer.add(record)
        self._records.append(record)

    def finish(self) -> None:
        """All models have been checked."""
        for writer in self._writers:
            writer.finish(self._records)
