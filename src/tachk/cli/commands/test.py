"""`tachk test`: test a running system by a model."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import limited
from tachk.base.records import dataclass
from tachk.base.seeds import DEFAULT_SEED
from tachk.cli import options
from tachk.cli import simulation_options as drawing
from tachk.cli.destination import destination
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.cli.reporting import Reporting
from tachk.engine.options import Limits
from tachk.simulation.testing.goals import TestGoal

if TYPE_CHECKING:
    from tachk.api.model import Model
    from tachk.frontend.loaded import LoadedModel
    from tachk.simulation.testing.property_goal import PropertyGoal
    from tachk.simulation.testing.tester import TestResult


@click.command(name="test")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model with a `recording { replaces ... }`.")
@options.definitions
@click.option(
    "--adapter",
    metavar="KIND:...",
    help="The system. process:COMMAND is a program that reads inputs and writes outputs as JSON lines, in real time; "
    "driven:COMMAND is one whose clock the test moves on; tcp:HOST:PORT and udp:HOST:PORT reach one that runs already; "
    "xrce:client:COMMAND is a client of DDS-XRCE, xrce:agent:COMMAND an Agent, xrce:relay:COMMAND -- COMMAND an Agent "
    "and a client.",
)
@click.option(
    "--simulate",
    metavar="MODEL",
    type=click.Path(),
    help="Test the processes of this model in place of a program, in simulated time: a changed copy of MODEL, or MODEL "
    "itself.",
)
@click.option(
    "duration",
    "--for",
    metavar="DURATION",
    help="How long to test, such as 10min. By default 10s, or 10000 units of a model without a unit of time.",
)
@drawing.seed("The random choice of inputs and moments.")
@click.option(
    "--goal",
    metavar="random|edges|PROPERTY",
    default=TestGoal.RANDOM.value,
    show_default=True,
    help="How inputs are chosen. edges: half of them on the way to an edge of the system that was not taken yet. "
    "PROPERTY: on the way to a state that decides this property of the model, along a run that `tachk verify` finds.",
)
@click.option(
    "--inputs",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Send the inputs of this recording, at its times, in place of chosen ones: a test as --record writes it, or a "
    "run of `tachk tests`. By default the test lasts a pause longer than the recording.",
)
@click.option(
    "--pause",
    metavar="DURATION",
    help="The longest time until the next input. By default the largest constant of the model's clocks.",
)
@click.option(
    "--tolerance",
    metavar="DURATION",
    help="How much earlier or later than seen an event may have happened, such as 5ms. By default as the model says.",
)
@options.lateness(
    "How much later than it happens an output may be seen, and how much later than it is sent an input may arrive. By "
    "default as the model says."
)
@click.option(
    "--record",
    metavar="FILE",
    type=options.written_file,
    help="Write the events of the test to this file (.jsonl), which `tachk conform` reads.",
)
@click.option(
    "--shorten",
    metavar="SECONDS",
    type=options.Seconds(min=0),
    help="If the test fails, look for so long for fewer inputs with which it fails, too: each try starts the system "
    "again. The report and --record are those of the shortest test.",
)
@click.option(
    "--chart",
    metavar="FILE",
    type=options.written_file,
    help="Draw the last events of the test as a sequence chart into this .svg or .png file; of a test that failed with "
    "what the model allowed at its end.",
)
@click.option("--junit", metavar="FILE", type=options.written_file, help="Also write the verdict as JUnit XML, for CI.")
@options.max_states()
@options.max_seconds()
@options.report("text", "json")
def command(seconds: float | None, **given: Any) -> None:
    """Test a running system by a model.

    The processes that the recording of the model replaces are the environment: the test does what they may do. All
    others are the system: the test checks what it answers, and when.

    Exit status: 0 the system did what the model allows, 10 it did not, 20 the test says nothing, 2 bad input.
    """

    arguments, reporting = distributed(given, TestArguments, Reporting)
    options.finish(lambda: run_test_command(arguments, reporting, seconds), seconds)


@dataclass(frozen=True, slots=True)
class TestArguments:
    """Arguments of `tachk test`."""

    __test__ = False

    model: str
    adapter: str | None = None
    simulate: str | None = None
    definitions: tuple[str, ...] = ()
    duration: str | None = None
    seed: int = DEFAULT_SEED
    pause: str | None = None
    tolerance: str | None = None
    late: tuple[str, ...] = ()
    record: Path | None = None
    chart: Path | None = None
    junit: Path | None = None
    shorten: float | None = None
    inputs: Path | None = None
    goal: str = TestGoal.RANDOM.value
    states: int | None = None


def run_test_command(arguments: TestArguments, reporting: Reporting, seconds: float | None) -> ExitStatus:
    """Tests a system, and reports."""
    from tachk.api import model as api
    from tachk.cli.arguments import parse_definitions, parse_lateness
    from tachk.cli.commands.chart import check_chart_file
    from tachk.recordings.conformance.conform_file import read_recording
    from tachk.recordings.conformance.question import Question
    from tachk.report.conformance.tested import test_to_json, test_to_text
    from tachk.simulation.testing.tested_model import TestRequest, run_test_of_model
    from tachk.simulation.testing.tester import TestVerdict

    if arguments.inputs is not None and arguments.goal != TestGoal.RANDOM.value:
        raise UsageError("the inputs of a recording have no other goal", "leave out --goal or --inputs")
    if arguments.chart is not None:
        check_chart_file(arguments.chart)
    model = api.load(arguments.model, **parse_definitions(arguments.definitions))
    print_diagnostics((*model.refusals, *model.warnings))
    system, limits = _system_under_test(arguments), Limits(states=arguments.states)
    with limited(seconds):
        request = TestRequest(
            system,
            arguments.duration,
            arguments.seed,
            arguments.tolerance,
            parse_lateness(arguments.late),
            arguments.pause,
            arguments.shorten,
            _goal(arguments.goal, model, limits),
            None if arguments.inputs is None else read_recording(arguments.inputs, Question(), model.loaded),
        )
        result, shortening = run_test_of_model(model.loaded, model.path, request, limits)
    _write_files(arguments, model, result)
    unit = model.network.time_unit
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None:
            match reporting.form:
                case "text":
                    out.write(test_to_text(result, shortening, arguments.model, unit))
                case "json":
                    json.dump(test_to_json(result, shortening, arguments.model, unit), out, indent=2)
                    out.write("\n")
                case _:
                    raise UsageError(f"unknown format {reporting.form}")
    return {
        TestVerdict.PASS: ExitStatus.AS_EXPECTED,
        TestVerdict.FAIL: ExitStatus.NOT_AS_EXPECTED,
        TestVerdict.INCONCLUSIVE: ExitStatus.UNKNOWN,
    }[result.verdict]


def _write_files(arguments: TestArguments, model: Model, result: TestResult) -> None:
    """The recording, the report for CI and the chart, as far as they are wanted."""
    from tachk.cli.commands.chart import write_chart
    from tachk.recordings.conformance.event_streams import input_names
    from tachk.recordings.conformance.event_tables import event_rows
    from tachk.report.conformance.test_chart import chart_of_test
    from tachk.report.conformance.tested import test_to_junit
    from tachk.report.drawing.sequence.layout import TimeAxis
    from tachk.simulation.testing.tested_model import nanoseconds_of, replacing_map

    unit = model.network.time_unit
    if arguments.record is not None:
        arguments.record.write_text("".join(event_rows(result.recording, nanoseconds_of(unit))), encoding="utf-8")
    if arguments.junit is not None:
        name = arguments.adapter or f"simulate:{arguments.simulate}"
        arguments.junit.write_text(test_to_junit(result, arguments.model, name, unit), encoding="utf-8")
    if arguments.chart is not None:
        names = input_names(model.network, replacing_map(model.loaded, model.path))
        write_chart(chart_of_test(result, names, arguments.model, unit), arguments.chart, TimeAxis.COMPRESSED)


def _goal(name: str, model: Model, limits: Limits) -> TestGoal | PropertyGoal:
    """Raises UsageError for what is no goal."""
    from tachk.verify.property_goal import property_goal

    if name in tuple(TestGoal):
        return TestGoal(name)
    return property_goal(model.loaded, model.path, name, limits)


def _system_under_test(arguments: TestArguments) -> str | LoadedModel:
    """What `--adapter` says, or the model of `--simulate`. Raises UsageError unless there is one of them."""
    from tachk.api import model as api
    from tachk.cli.arguments import parse_definitions

    if (arguments.adapter is None) == (arguments.simulate is None):
        raise UsageError(
            "name one system to test", "--adapter process:./program for a program, --simulate MODEL for a model"
        )
    if arguments.simulate is None:
        assert arguments.adapter is not None
        return arguments.adapter
    return api.load(arguments.simulate, **parse_definitions(arguments.definitions)).loaded
