"""`tachk conform`: check if recordings are runs of a model."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import limited
from tachk.base.records import dataclass
from tachk.cli import options
from tachk.cli.destination import destination
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.cli.reporting import Reporting
from tachk.engine.options import Limits
from tachk.recordings.conformance.question import ExplanationDetail

if TYPE_CHECKING:
    from tachk.api.model import Model
    from tachk.recordings.conformance.conform import Conformance
    from tachk.recordings.conformance.coverage import Covered
    from tachk.report.conformance.repaired import RepairReport


@click.command(name="conform")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model with a `recording { ... }`.")
@click.argument(
    "recordings",
    metavar="FILE...",
    nargs=-1,
    required=True,
    type=click.Path(),
    help="Recorded events: CSV, JSON lines (.jsonl), both also compressed (.gz, .zst), or a capture (.pcap).",
)
@options.definitions
@click.option(
    "--tolerance",
    metavar="DURATION",
    help="How much earlier or later than recorded an event may have happened, such as 5ms; auto finds the least one. "
    "Without it: as the model says.",
)
@options.lateness(
    "How much later than it happens an output may be recorded, and how much later than it is recorded an input may "
    "happen. By default as the model says."
)
@click.option("--unit", metavar="UNIT", help="The unit of the recorded times, if the file does not say it: ms, s, ...")
@options.agent_ports(
    "Of a capture of packets: the port of an Agent, or of a proxy in front of it; without this option "
    "8888 and every port at which a session is created. Can be given several times."
)
@click.option(
    "applications",
    "--application",
    metavar="LOG",
    type=click.Path(),
    multiple=True,
    help="The log of an application, as events (CSV or JSON lines); beside a capture with times since 1970, such as "
    "`time [ns]`. Rows `told` say when it called the run function, rows `written` when it wrote. Can be given several "
    "times.",
)
@click.option(
    "explanation",
    "--explain",
    type=options.Choice(ExplanationDetail),
    default=ExplanationDetail.SHORT.value,
    show_default=True,
    help="How much to explain about a recording that does not conform. none: nothing; short: where it leaves the model,"
    " and an edit that would make it a run if one is found in a few seconds; full: try all edits near that place.",
)
@click.option("--coverage", is_flag=True, help="Also report the edge coverage: which edges of the model the runs take.")
@click.option(
    "scenario",
    "--scenario",
    metavar="FILE",
    type=options.written_file,
    help="Write the recording as a scenario of the model into this file (.ta).",
)
@click.option(
    "repair",
    "--repair",
    is_flag=True,
    help="Look for changes of the model that make all recordings runs of it: other values of constants, an edge that "
    "is missing, a guard that is too narrow. Report them, the most likely ones first, each with the properties whose "
    "answers change.",
)
@options.max_states()
@options.max_seconds()
@options.report("text", "json")
def command(seconds: float | None, **given: Any) -> None:
    """Check if recordings of the real system are runs of a model.

    Exit status: 0 all are, 10 one is not, 20 one is undecided because a limit was hit, 2 bad input.
    """

    arguments = distributed(given, ConformArguments, Reporting)
    options.finish(lambda: run_conform(arguments[0], arguments[1], seconds), seconds)


@dataclass(frozen=True, slots=True)
class ConformArguments:
    """Arguments of `tachk conform`."""

    model: str
    recordings: tuple[str, ...]
    definitions: tuple[str, ...] = ()
    tolerance: str | None = None
    late: tuple[str, ...] = ()
    unit: str | None = None
    ports: tuple[int, ...] = ()
    states: int | None = None
    applications: tuple[str, ...] = ()
    coverage: bool = False
    explanation: ExplanationDetail = ExplanationDetail.SHORT
    scenario: Path | None = None
    repair: bool = False


def run_conform(arguments: ConformArguments, reporting: Reporting, seconds: float | None) -> ExitStatus:
    """Holds recordings against a model, and reports."""
    from tachk.api import model as api
    from tachk.cli.arguments import parse_definitions, parse_lateness
    from tachk.formats.loading.recorded_models import recorded_model
    from tachk.report.conformance.json import conformance_to_json
    from tachk.report.conformance.text import conformance_to_text, coverage_to_text

    given = model = api.load(arguments.model, **parse_definitions(arguments.definitions))
    print_diagnostics((*model.refusals, *model.warnings))
    model = api.Model(recorded_model(model.loaded, model.path, model.definitions), model.path, model.definitions)
    limits = Limits(states=arguments.states, seconds=seconds)
    with limited(seconds):
        found = [
            api.conform(
                model,
                each,
                arguments.tolerance,
                parse_lateness(arguments.late),
                arguments.unit,
                arguments.ports,
                limits,
                arguments.applications,
                arguments.explanation,
            )
            for each in arguments.recordings
        ]
        repair = _repair(given, arguments, limits) if arguments.repair else None
    if arguments.scenario is not None:
        _write_scenario(found, arguments.scenario)
    covered: tuple[Covered, ...] = ()
    if arguments.coverage:
        from tachk.recordings.conformance.coverage import coverage

        covered = coverage(model.network, (each for each in found if each.accepted))
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None:
            match reporting.form:
                case "text":
                    out.writelines(conformance_to_text(each, arguments.model) for each in found)
                    out.write(coverage_to_text(covered) if covered else "")
                    out.write("" if repair is None else repair.to_text())
                case "json":
                    answers_of_all = conformance_to_json(found, arguments.model, covered)
                    answers_of_all |= {} if repair is None else {"repair": repair.to_dict()}
                    json.dump(answers_of_all, out, indent=2)
                    out.write("\n")
                case _:
                    raise UsageError(f"unknown format {reporting.form}")
    answers = {each.accepted for each in found}
    if False in answers:
        return ExitStatus.NOT_AS_EXPECTED
    return ExitStatus.UNKNOWN if None in answers else ExitStatus.AS_EXPECTED


def _repair(model: Model, arguments: ConformArguments, limits: Limits) -> RepairReport:
    from tachk.api.repairing import repair
    from tachk.cli.arguments import parse_lateness

    return repair(
        model,
        arguments.recordings,
        arguments.tolerance,
        parse_lateness(arguments.late),
        arguments.unit,
        arguments.ports,
        limits,
        arguments.applications,
    )


def _write_scenario(found: Sequence[Conformance], file: Path) -> None:
    """Raises UsageError for several recordings."""
    from tachk.base.whole_files import write_whole
    from tachk.recordings.conformance.recorded_scenario import scenario_of_recording
    from tachk.syntax.printing.scenario_text import scenario_name

    if len(found) > 1:
        raise UsageError("a scenario is made of one recording", "name one FILE with --scenario")
    write_whole(file, scenario_of_recording(found[0], scenario_name(file)))
