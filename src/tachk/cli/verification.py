"""What `tachk verify` does, apart from reading its options. Imports nothing heavy."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from functools import partial
from typing import TYPE_CHECKING, Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import current_job, is_interrupted, limited, under_way
from tachk.base.plugins import separate_plugin
from tachk.base.records import dataclass, replace
from tachk.cli.destination import destination
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import complain, guarded, print_diagnostics
from tachk.cli.reporting import EvidenceChoice, RunReporting
from tachk.cli.terminal import can_rewrite_lines
from tachk.engine.options import Limits, Options, Pace
from tachk.report.run.display import RunDisplay

if TYPE_CHECKING:
    from pathlib import Path

    from tachk.api import model as api
    from tachk.cli.run_report import RunReport
    from tachk.report.record import RunRecord


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


EVERY_CORE = 0
"""The number of processes of the command where none is given; in Python it is 1."""


def verify_as_given(given: Mapping[str, Any]) -> ExitStatus:
    """Checks what the arguments of the command say, by the names of parameters; what is left out has its default."""
    return run_verify(*requested(given))


def requested(given: Mapping[str, Any]) -> Sequence[Any]:
    """The arguments of `run_verify`."""
    kinds = (VerifyArguments, Options, Limits, RunReporting, RunDisplay)
    return distributed({"processes": EVERY_CORE, **given}, *kinds)


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
    if request.chart is not None:
        from tachk.cli.commands.chart import check_chart_file

        check_chart_file(request.chart)
        if len(models) > 1:
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
