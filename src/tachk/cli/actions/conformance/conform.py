"""`tachk conform`."""

from __future__ import annotations

import json

from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import limited
from tachk.base.records import dataclass
from tachk.cli.arguments import parse_definitions
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.cli.reporting import ReportForm, Reporting
from tachk.engine.options import Limits
from tachk.formats.loading.recorded_models import recorded_model
from tachk.recordings.conformance.coverage import coverage
from tachk.recordings.conformance.question import ExplanationDetail
from tachk.report.conformance.json import conformance_to_json
from tachk.report.conformance.text import conformance_to_text, coverage_to_text


@dataclass(frozen=True, slots=True)
class Conforming:
    """What is asked, as it was typed."""

    model: str
    recordings: tuple[str, ...]
    definitions: tuple[str, ...] = ()
    tolerance: str | None = None
    late: str | None = None
    unit: str | None = None
    ports: tuple[int, ...] = ()
    states: int | None = None
    applications: tuple[str, ...] = ()
    coverage: bool = False
    explanation: ExplanationDetail = ExplanationDetail.SHORT


def run_conform(asked: Conforming, reporting: Reporting, seconds: float | None) -> ExitStatus:
    """Holds recordings against a model, and reports."""
    model = api.load(asked.model, **parse_definitions(asked.definitions))
    print_diagnostics((*model.refusals, *model.warnings))
    model = api.Model(recorded_model(model.loaded, model.path, model.definitions), model.path, model.definitions)
    limits = Limits(states=asked.states, seconds=seconds)
    with limited(seconds):
        found = [
            api.conform(
                model,
                each,
                asked.tolerance,
                asked.late,
                asked.unit,
                asked.ports,
                limits,
                asked.applications,
                asked.explanation,
            )
            for each in asked.recordings
        ]
    covered = coverage(model.network, (each for each in found if each.accepted)) if asked.coverage else ()
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None:
            match reporting.form:
                case ReportForm.TEXT:
                    out.writelines(conformance_to_text(each, asked.model) for each in found)
                    out.write(coverage_to_text(covered) if covered else "")
                case ReportForm.JSON:
                    json.dump(conformance_to_json(found, asked.model, covered), out, indent=2)
                    out.write("\n")
                case _:
                    raise UsageError(f"unknown format {reporting.form}")
    answers = {each.accepted for each in found}
    if False in answers:
        return ExitStatus.NOT_AS_EXPECTED
    return ExitStatus.UNKNOWN if None in answers else ExitStatus.AS_EXPECTED
