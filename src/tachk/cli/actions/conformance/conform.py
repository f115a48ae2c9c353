"""`tachk conform`."""

from __future__ import annotations

import json

from tachk import api
from tachk.cli.arguments import parse_definitions
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.cli.reporting import ReportForm, Reporting
from tachk.conformance.coverage import coverage
from tachk.diagnostics.diagnostic import UsageError
from tachk.engines.options import Limits
from tachk.records import dataclass
from tachk.report.conformance.json import conformance_to_json
from tachk.report.conformance.text import conformance_to_text, coverage_to_text


@dataclass(frozen=True, slots=True)
class Conforming:
    """What is asked, as it was typed."""

    model: str
    recording: str
    definitions: tuple[str, ...] = ()
    tolerance: str | None = None
    late: str | None = None
    unit: str | None = None
    ports: tuple[int, ...] = ()
    states: int | None = None
    coverage: bool = False


def run_conform(asked: Conforming, reporting: Reporting, seconds: float | None) -> ExitStatus:
    """Holds a recording against a model, and reports."""
    model = api.load(asked.model, **parse_definitions(asked.definitions))
    print_diagnostics((*model.refusals, *model.warnings))
    limits = Limits(states=asked.states, seconds=seconds)
    found = api.conform(model, asked.recording, asked.tolerance, asked.late, asked.unit, asked.ports, limits)
    covered = coverage(model.network, [found] if found.accepted else []) if asked.coverage else ()
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None:
            match reporting.form:
                case ReportForm.TEXT:
                    out.write(conformance_to_text(found, asked.model))
                    out.write(coverage_to_text(covered) if covered else "")
                case ReportForm.JSON:
                    json.dump(conformance_to_json(found, asked.model, covered), out, indent=2)
                    out.write("\n")
                case _:
                    raise UsageError(f"unknown format {reporting.form}")
    if found.accepted is None:
        return ExitStatus.UNKNOWN
    return ExitStatus.AS_EXPECTED if found.accepted else ExitStatus.NOT_AS_EXPECTED
