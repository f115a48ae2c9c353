"""`tachk verify`: check the properties of models, or the given queries."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import current_job, is_interrupted, limited, under_way
from tachk.base.plugins import separate_plugin
from tachk.base.records import dataclass, replace
from tachk.cli import options
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import complain, guarded, print_diagnostics
from tachk.cli.reporting import EvidenceChoice, RunReporting
from tachk.cli.terminal import can_rewrite_lines
from tachk.engine.options import (
    LARGEST_SEED,
    MOST_PROCESSES,
    Engine,
    Extrapolation,
    Limits,
    LocalTimes,
    Options,
    Pace,
    SearchOrder,
)
from tachk.report.run.display import RunDisplay
from tachk.report.run_formats import RUN_FORMATS

if TYPE_CHECKING:
    from tachk.api import model as api
    from tachk.cli.run_report import RunReport
    from tachk.report.record import RunRecord


_DEFAULT = Options()

_SECTIONS = {
    "Meaning": ("non_zeno",),
    "Reports": ("quiet", "junit", "sarif", "every_trace", "clocks", "every_step", "chart"),
    "Proofs": ("certificate", "munta"),
    "Limits": ("states", "seconds_each", "max_memory", "depth"),
    "Search": ("engine", "order", "seed", "extrapolation", "without", "local_times", "partial_order", "processes"),
}
"""Options by the headings of the help; the others come first."""


@click.command(name="verify", cls=options.SectionedCommand, sections=_SECTIONS)
@click.argument(
    "arguments",
    metavar="MODEL|QUERY...",
    nargs=-1,
    required=True,
    type=click.Path(),
    help="Model files, and queries to check on each.",
)
@options.query_files("Check the queries in this file.")
@options.definitions
@click.option("properties", "--property", metavar="NAME", multiple=True, help="Check this property of the model.")
@click.option(
    "--non-zeno",
    is_flag=True,
    help="For A<>, E[], --> and formulas without deadline: ignore runs with infinitely many transitions in "
    "finite time.",
)
@click.option(
    "--engine",
    type=options.Choice(Engine),
    default=_DEFAULT.engine.value,
    show_default=True,
    help="The engine that answers. zone: searches sets of clock values; smt: z3, which shares nothing with zone; both: "
    "compare the answers of the two.",
)
@click.option(
    "order",
    "--search",
    type=options.Choice(SearchOrder),
    default=_DEFAULT.order.value,
    show_default=True,
    help="The order in which states are explored.",
)
@click.option(
    "--seed",
    metavar="N",
    type=options.Count(0, LARGEST_SEED),
    default=_DEFAULT.seed,
    show_default=True,
    help="Seed of the random order (--search rdfs), and of the runs that answer statistical queries.",
)
@click.option(
    "--trace",
    type=options.Choice(EvidenceChoice),
    help="The run to show as evidence; without this option only unexpected answers get one. shortest: one with the "
    "fewest transitions, which may take longer to find. fastest: one that takes the least time of all, which takes "
    "several searches. slowest: the run that was found, as late as it can be.",
)
@options.report(*RUN_FORMATS)
@click.option("--junit", metavar="FILE", type=options.written_file, help="Also write the answers as JUnit XML, for CI.")
@click.option(
    "--sarif", metavar="FILE", type=options.written_file, help="Also write unexpected answers as SARIF, for code hosts."
)
@click.option(
    "certificate",
    "--certificate",
    metavar="FILE",
    type=options.written_file,
    help="Write proofs to this file, one for each answer that no run can show. `tachk certify` checks them without a "
    "search.",
)
@click.option(
    "munta",
    "--munta",
    metavar="FOLDER",
    type=options.written_file,
    help="Write a model and a proof into this folder for each A[] that holds and each E<> that fails, for Munta, whose "
    "checker is verified. Needs the package tachk-munta.",
)
@click.option(
    "chart",
    "--chart",
    metavar="FILE",
    type=options.written_file,
    help="Draw a run as a sequence chart into this .svg or .png file: that of the first unexpected answer that has "
    "one, or else of the first answer.",
)
@options.max_states()
@options.max_seconds("Stop checking a model after this time, which its properties share fairly.")
@click.option(
    "seconds_each",
    "--max-seconds-each",
    metavar="SECONDS",
    type=options.Seconds(min=0),
    help="Stop each search after this time; properties that look at the same clocks share a search.",
)
@options.max_memory
@click.option(
    "depth",
    "--max-depth",
    metavar="N",
    type=options.Count(min=0),
    help="Do not explore beyond N transitions from the initial state.",
)
@click.option(
    "--extrapolation",
    type=options.Choice(Extrapolation),
    default=_DEFAULT.extrapolation.value,
    show_default=True,
    help="The abstraction of zones.",
)
@click.option(
    "without",
    "--without",
    metavar="NAME,...",
    multiple=True,
    callback=lambda context, parameter, values: frozenset(
        name for value in values for name in value.split(",") if name
    ),
    help="Switch off reductions and strategies; answers stay the same. symmetry: treat identical processes as "
    "interchangeable; cone: leave out processes that cannot influence the answer (cone of influence); and the "
    "strategies that reports name, such as unblocked. An unknown name lists all.",
)
@click.option(
    "--local-times",
    type=options.Choice(LocalTimes),
    default=_DEFAULT.local_times.value,
    show_default=True,
    help="Let each process have a time of its own, so that independent transitions need not be put in an order, where "
    "that is sound. auto: where it seems to save many states; --without local-times: nowhere. No effect with "
    "--trace shortest or --max-depth.",
)
@click.option(
    "--partial-order",
    is_flag=True,
    help="Where time cannot pass, explore one order of independent actions, not each of them. No effect with "
    "--trace shortest, --max-depth, deadlock, priorities, stopwatches, interchangeable processes "
    "(but for --without symmetry), or where the search is over local times.",
)
@click.option(
    "processes",
    "-j",
    "--processes",
    metavar="N",
    type=options.Count(0, MOST_PROCESSES),
    default=0,
    show_default="the cores of this machine, up to 8",
    help="How many searches for different properties run at the same time, each in a process of its own, once a second "
    "has passed. --max-memory and --max-states hold for each. On Windows one.",
)
@click.option(
    "every_trace",
    "--all-traces",
    is_flag=True,
    help="Also show the runs of expected answers, and show every run whole.",
)
@click.option("--clocks", is_flag=True, help="Print the clocks after each step of a run.")
@click.option(
    "--every-step",
    is_flag=True,
    help="Show every step of a run, also those of repeated rounds and those that the model hides.",
)
def command(**given: Any) -> None:
    """Check the properties of models, or the given queries. Statistical queries are answered by random runs.

    Without a query, a query file or --property, tachk checks every property in the model.
    """

    arguments = options.distributed(given, VerifyArguments, Options, Limits, RunReporting, RunDisplay)
    options.finish(lambda: run_verify(*arguments))


@dataclass(frozen=True, slots=True)
class VerifyArguments:
    """Arguments of `tachk verify`.

    Attributes:
        arguments: models, and queries to check on each of them.
        properties: the names of those to check.
        max_memory: such as ``2G``.
        certificate: where proofs of the answers are written.
        munta: the folder for proofs that Munta checks.
        chart: the picture of a run.
        non_zeno: a run with infinitely many transitions counts only if time diverges in it.
    """

    arguments: tuple[str, ...]
    query_files: tuple[Path, ...] = ()
    definitions: tuple[str, ...] = ()
    properties: tuple[str, ...] = ()
    max_memory: str | None = None
    certificate: Path | None = None
    munta: Path | None = None
    chart: Path | None = None
    non_zeno: bool = False


def run_verify(
    request: VerifyArguments,
    options: Options = Options(),
    limits: Limits = Limits(),
    reporting: RunReporting = RunReporting(),
    display: RunDisplay = RunDisplay(),
) -> ExitStatus:
    """Checks every model; a model that cannot be checked does not keep the others from being checked.

    Reports for programs are written in any case, and list what could not be read.
    """
    from tachk.cli.run_report import RunReport

    if reporting.output is not None and re.fullmatch("[0-6]", str(reporting.output)):
        raise UsageError(
            f"-o {reporting.output} is a search order of UPPAAL, here --search; -o names the file for the report",
            f"`tachk verifyta` takes UPPAAL's options; a file of that name is ./{reporting.output}",
        )
    with ExitStack() as stack:
        outputs = {form: stack.enter_context(destination(path)) for form, path in reporting.beside.items()}
        if reporting.form in outputs:
            raise UsageError(
                f"--{reporting.form} and --format {reporting.form} are the same report", "give one of them"
            )
        outputs[reporting.form] = stack.enter_context(destination(reporting.output, reporting.quiet))
        report = RunReport(outputs, reporting, display)

        def check_all() -> ExitStatus:
            with report.listing():
                return _check_all(request, options, limits, reporting, report)

        status = guarded(check_all)
        report.finish()
    return status


def _check_all(
    request: VerifyArguments, options: Options, limits: Limits, reporting: RunReporting, report: RunReport
) -> ExitStatus:
    from tachk.api import model as api
    from tachk.cli.arguments import parse_definitions, parse_size, split_models_and_queries
    from tachk.verify.strategy import DisagreementError

    models, queries = split_models_and_queries(request.arguments)
    if request.certificate is not None and len(models) > 1:
        raise UsageError("--certificate names one file, but there are several models")
    if request.certificate is not None and not request.certificate.parent.is_dir():
        raise UsageError(f"there is no folder {request.certificate.parent} for the certificate", "make it first")
    if request.chart is not None and len(models) > 1:
        raise UsageError("--chart names one file, but there are several models")
    if request.munta is not None and len(models) > 1:
        raise UsageError("--munta names the folder of one model, but there are several models")
    if request.munta is not None:
        separate_plugin("munta proofs")  # or it says what to install, before the search
    constants = parse_definitions(request.definitions)
    match reporting.evidence:
        case EvidenceChoice.SHORTEST:
            options = _shortest(options)
        case EvidenceChoice.FASTEST:
            options = replace(options, pace=Pace.FASTEST)
        case EvidenceChoice.SLOWEST:
            options = replace(options, pace=Pace.SLOWEST)
        case EvidenceChoice.SOME | EvidenceChoice.NONE:
            pass
    if request.max_memory is not None:
        limits = replace(limits, memory_bytes=parse_size(request.max_memory))

    def check(path: str) -> ExitStatus:
        with report.listing(path):
            with limited(memory=limits.memory_bytes):
                model = api.load(path, **constants)
            print_diagnostics(model.warnings)
            try:
                record = _verified(model, queries, request, options, limits, reporting)
            except DisagreementError as error:
                from tachk.cli.disagreement import write_disagreement

                complain(str(error), f"one of them is wrong; please report it with {write_disagreement(model, error)}")
                return ExitStatus.INTERNAL_ERROR
        shown = {verdict.unsupported for verdict in record.verdicts} if reporting.on_screen else set()
        print_diagnostics(found for found in record.blocking if found not in shown)
        report.add(record)
        statuses = [*_statuses(record), *_written(request, model, record, options, limits)]
        return worst(statuses)

    statuses: list[ExitStatus] = []
    for path in models:
        with under_way(current_job().narrowed(limits.seconds)):
            statuses.append(guarded(partial(check, path), path if len(models) > 1 else ""))
        if statuses[-1] is ExitStatus.INTERRUPTED:
            break
    return worst(statuses)


def _written(
    request: VerifyArguments, model: api.Model, record: RunRecord, options: Options, limits: Limits
) -> Iterable[ExitStatus]:
    """Writes the requested chart and proofs. After Ctrl-C no proof is looked for."""
    if request.chart is not None:
        from tachk.cli.run_chart import write_run_chart

        write_run_chart(request.chart, record)
    if is_interrupted():
        if request.certificate is not None or request.munta is not None:
            complain("no proofs: interrupted")
        return
    if request.certificate is not None:
        from tachk.cli.certificate_file import write_certificates

        try:
            yield write_certificates(request.certificate, model.network, record.verdicts, options, limits)
        except KeyboardInterrupt:  # the answers have been reported
            complain(f"{request.certificate}: not written: interrupted")
            yield ExitStatus.INTERRUPTED
            return
    if request.munta is not None:
        confirmed = separate_plugin("munta proofs")(request.munta, model.network, record.verdicts, options, limits)
        yield ExitStatus.AS_EXPECTED if confirmed else ExitStatus.UNKNOWN


def _shortest(options: Options) -> Options:
    if not options.order.finds_shortest:
        raise UsageError(
            f"--trace shortest needs --search bfs, not {options.order.value}",
            "breadth-first search is what makes the first run that is found a shortest one",
        )
    return replace(options, shortest=True)


def _verified(
    model: api.Model,
    queries: tuple[str, ...],
    request: VerifyArguments,
    options: Options,
    limits: Limits,
    reporting: RunReporting,
) -> RunRecord:
    from tachk.cli.progress import ProgressLine

    progress = ProgressLine() if can_rewrite_lines(sys.stderr) and not reporting.quiet else None
    try:
        report = model.verify(
            *queries,
            property=request.properties,
            query_files=request.query_files,
            non_zeno=request.non_zeno,
            options=options,
            limits=limits,
            trace=reporting.evidence is not EvidenceChoice.NONE,
            progress=progress,
        )
    finally:
        if progress is not None:
            progress.clear()
    return report.record


def _statuses(record: RunRecord) -> Iterable[ExitStatus]:
    """Everything that the outcome of a run amounts to; the gravest of them is the status."""
    from tachk.engine.outcome import INTERRUPTED

    met = [*(verdict.met for verdict in record.verdicts), *(answer.met for answer in record.estimates)]
    reasons = {*(verdict.reason for verdict in record.verdicts), *(answer.reason for answer in record.estimates)}
    if INTERRUPTED in reasons or is_interrupted():
        yield ExitStatus.INTERRUPTED
    if any(query.is_wrong for query in record.not_checked):
        yield ExitStatus.BAD_INPUT
    if False in met:
        yield ExitStatus.NOT_AS_EXPECTED
    wrong_queries = any(query.diagnostics for query in record.not_checked)
    unsupported = any(verdict.unsupported is not None for verdict in record.verdicts)
    if record.blocking or record.nothing_checked or wrong_queries or unsupported:
        yield ExitStatus.UNSUPPORTED
    if None in met:
        yield ExitStatus.UNKNOWN
