"""`tachk tests`: make a test suite of a model."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass
from tachk.cli import options
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.engine.options import Limits

if TYPE_CHECKING:
    from tachk.api.model import Model
    from tachk.model.network import Network
    from tachk.model.run import TimedTrace
    from tachk.verify.covering.suite import CoveringSuite

_STATES = 200_000
"""So many states the check of the events of a run stores at most, unless `--max-states` says otherwise."""

COVERAGES = ("edges", "locations", "pairs", "mutants")


@click.command(name="tests")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@options.definitions
@click.option(
    "cover",
    "--cover",
    type=click.Choice(COVERAGES),
    default=COVERAGES[0],
    show_default=True,
    help="What the runs cover together, in each process. edges: each edge is taken; locations: each is visited; "
    "pairs: each edge is taken right after each edge before it; mutants: systems with one change of the model "
    "do something else, which a test sees.",
)
@click.option(
    "folder",
    "-o",
    "--output",
    metavar="FOLDER",
    type=options.written_file,
    help="Write the runs into this folder, and test_cover.py, with which pytest replays them. Without: only report.",
)
@options.max_states()
@options.max_seconds("Stop after this time; what was not found by then is unknown, with exit status 20.")
@click.option(
    "form",
    "--format",
    type=click.Choice(("text", "json")),
    default="text",
    show_default=True,
    help="Form of the report.",
)
@click.option("quiet", "-q", "--quiet", is_flag=True, help="Print no report; only set the exit status.")
def command(**given: Any) -> None:
    """Make a test suite of a model: a few runs that together take all its edges, or visit all its locations.

    What no run covers is named, with the reason. Exit status: 0 all that can be covered is covered, 20 of something
    that is unknown, 2 bad input.
    """

    (arguments,) = distributed(given, SuiteArguments)
    options.finish(lambda: run_tests_command(arguments))


@dataclass(frozen=True, slots=True)
class SuiteArguments:
    """Arguments of `tachk tests`."""

    model: str
    cover: str = COVERAGES[0]
    folder: Path | None = None
    definitions: tuple[str, ...] = ()
    states: int | None = None
    seconds: float | None = None
    form: str = "text"
    quiet: bool = False


def run_tests_command(arguments: SuiteArguments) -> ExitStatus:
    """Finds the runs, writes them, and reports."""
    from tachk.api import model as api
    from tachk.cli.arguments import parse_definitions
    from tachk.engine.outcome import INTERRUPTED
    from tachk.report.covering.json import suite_to_json
    from tachk.report.covering.text import suite_to_text
    from tachk.simulation.stepping.files import check_determined
    from tachk.verify.covering.coverage import Coverage
    from tachk.verify.covering.suite import covering_suite

    model = api.load(arguments.model, **parse_definitions(arguments.definitions))
    print_diagnostics((*model.refusals, *model.warnings))
    check_determined(model.network)
    if arguments.cover == "mutants":
        return _run_mutant_tests(model, arguments)
    limits = Limits(states=arguments.states, seconds=arguments.seconds)
    suite = covering_suite(model.network, Coverage(arguments.cover), limits=limits)
    files = [] if arguments.folder is None else _write(arguments, arguments.folder, model, suite)
    if not arguments.quiet:
        if arguments.form == "json":
            json.dump(suite_to_json(model.network, suite, arguments.model, files), sys.stdout, indent=2)
            sys.stdout.write("\n")
        else:
            names = [each[0] for each in files]
            sys.stdout.write(suite_to_text(model.network, suite, arguments.model, names))
    reasons = {reason for _, reason in suite.unknown}
    if INTERRUPTED in reasons:
        return ExitStatus.INTERRUPTED
    return ExitStatus.UNKNOWN if reasons else ExitStatus.AS_EXPECTED


def _run_mutant_tests(model: Model, arguments: SuiteArguments) -> ExitStatus:
    from tachk.cli.mutant_tests import run_mutant_tests

    if arguments.folder is not None:
        _make(arguments.folder)
    status, report = run_mutant_tests(
        model, arguments.definitions, arguments.folder, arguments.states, arguments.seconds, arguments.form
    )
    if not arguments.quiet:
        sys.stdout.write(report)
    return status


def _make(folder: Path) -> None:
    """Raises UsageError where there is no such folder to be made."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"{folder} cannot be made: {error.strerror or error}", "name another folder") from None


def _write(arguments: SuiteArguments, folder: Path, model: Model, suite: CoveringSuite) -> list[list[str]]:
    """Writes the runs, their events where the model says what is seen of it, and the file that replays them.

    Returns the names of the files of each run. Raises UsageError where there is no such folder to be made.
    """
    from tachk.base.whole_files import write_whole
    from tachk.cli.arguments import parse_definitions
    from tachk.meaning.run_view import RunNames
    from tachk.recordings.conformance.conform_file import constants_of
    from tachk.recordings.conformance.event_streams import input_names
    from tachk.recordings.conformance.event_tables import event_rows
    from tachk.report.covering.replaying_file import pytest_file
    from tachk.simulation.stepping.run_file import SUFFIX, run_text
    from tachk.simulation.testing.run_events import recording_of_run
    from tachk.simulation.testing.tested_model import nanoseconds_of

    _make(folder)
    given = parse_definitions(arguments.definitions)
    constants = {name: value for name, value in model.constants.items() if name in given}
    names, stem, mapping = RunNames(model.network), Path(arguments.model).stem, model.loaded.recording
    length = nanoseconds_of(model.network.time_unit)
    inputs = () if mapping is None else input_names(model.network, mapping)
    files: list[list[str]] = []
    scripts: list[str] = []
    for number, each in enumerate(suite.runs, start=1):
        run = f"{stem}-{number}{SUFFIX}"
        heading = [f"a run of {Path(arguments.model).name}, {number} of {len(suite.runs)}"]
        write_whole(folder / run, run_text(names, each.run, heading, constants))
        files.append([run])
        if "LINKS" in model.constants:
            _write_proxy_script(folder, model.network, each.run, f"{stem}-{number}.rules", run)
        if mapping is not None and mapping.visible:
            recording = f"{stem}-{number}.jsonl"
            limits = Limits(states=arguments.states or _STATES, seconds=arguments.seconds)
            constant = constants_of(model.loaded)
            events = recording_of_run(model.network, mapping, constant, each.run, recording, limits)
            if events is None:
                print(f"{folder / recording}: not written, as a limit stopped the check of the events", file=sys.stderr)
                continue
            write_whole(folder / recording, "".join(event_rows(events, length)))
            files[-1].append(recording)
            if mapping.replaced and any(each.name in inputs for each in events.events):
                scripts.append(recording)
    text = pytest_file(
        os.path.relpath(arguments.model, folder).replace(os.sep, "/"),
        arguments.definitions,
        [each[0] for each in files],
        [name for each in files for name in each[1:]],
        scripts,
        _write_proofs(arguments, folder, model, suite),
    )
    write_whole(folder / "test_cover.py", text)
    return files


def _write_proxy_script(folder: Path, network: Network, run: TimedTrace, script: str, name: str) -> None:
    """Writes what the links of the model do in a run, unless its messages are no packets of DDS-XRCE."""
    from tachk.base.whole_files import write_whole
    from tachk.cli.proxy_scripts import proxy_script

    try:
        write_whole(folder / script, proxy_script(network, run, name))
    except UsageError as error:
        print(f"{folder / script}: not written: {error}", file=sys.stderr)


_NOTING = "cannot_be_covered.ta"
_PROOFS = "cannot_be_covered.cert"


def _write_proofs(
    arguments: SuiteArguments, folder: Path, model: Model, suite: CoveringSuite
) -> tuple[str, str] | None:
    """Writes a model that notes what no run covers, and the certificate that it is never noted; None if there is
    nothing of that kind, or a limit kept the certificate from being made."""
    from tachk.api import model as api
    from tachk.base.whole_files import write_whole
    from tachk.cli.arguments import parse_definitions
    from tachk.cli.certificate_file import written_certificates
    from tachk.report.covering.untaken_model import untaken_model

    noting = untaken_model(model.loaded, suite)
    for name in (_NOTING, _PROOFS):
        (folder / name).unlink(missing_ok=True)
    if noting is None:
        return None
    write_whole(folder / _NOTING, noting)
    limits = Limits(states=arguments.states, seconds=arguments.seconds)
    searched = api.load(folder / _NOTING, **parse_definitions(arguments.definitions))
    record = searched.verify(limits=limits, trace=False).record
    names, _ = written_certificates(folder / _PROOFS, searched.network, record.verdicts, record.options, limits)
    return (_NOTING, _PROOFS) if names else None
