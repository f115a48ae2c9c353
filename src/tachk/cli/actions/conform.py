"""The action of `tachk conform`."""

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
from tachk.cli.reporting import Reporting
from tachk.engine.options import Limits
from tachk.formats.loading.recorded_models import recorded_model
from tachk.recordings.conformance.coverage import coverage
from tachk.recordings.conformance.question import ExplanationDetail
from tachk.report.conformance.json import conformance_to_json
from tachk.report.conformance.text import conformance_to_text, coverage_to_text


@dataclass(frozen=True, slots=True)
class ConformArguments:
    """Arguments of `tachk conform`."""

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


def run_conform(arguments: ConformArguments, reporting: Reporting, seconds: float | None) -> ExitStatus:
    """Holds recordings against a model, and reports."""
    model = api.load(arguments.model, **parse_definitions(arguments.definitions))
    print_diagnostics((*model.refusals, *model.warnings))
    model = api.Model(recorded_model(model.loaded, model.path, model.definitions), model.path, model.definitions)
    limits = Limits(states=arguments.states, seconds=seconds)
    with limited(seconds):
        found = [
            api.conform(
                model,
                each,
                arguments.tolerance,
                arguments.late,
                arguments.unit,
                arguments.ports,
                limits,
                arguments.applications,
                arguments.explanation,
            )
            for each in arguments.recordings
        ]
    covered = coverage(model.network, (each for each in found if each.accepted)) if arguments.coverage else ()
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None:
            match reporting.form:
                case "text":
                    out.writelines(conformance_to_text(each, arguments.model) for each in found)
                    out.write(coverage_to_text(covered) if covered else "")
                case "json":
                    json.dump(conformance_to_json(found, arguments.model, covered), out, indent=2)
                    out.write("\n")
                case _:
                    raise UsageError(f"unknown format {reporting.form}")
    answers = {each.accepted for each in found}
    if False in answers:
        return ExitStatus.NOT_AS_EXPECTED
    return ExitStatus.UNKNOWN if None in answers else ExitStatus.AS_EXPECTED
