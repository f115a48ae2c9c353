"""`tachk verify`."""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TextIO

from tachk import api
from tachk.cli.arguments import parse_definitions, parse_size, split_models_and_queries
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import OUT_OF_TIME, guarded, print_diagnostics
from tachk.cli.progress import ProgressLine
from tachk.cli.terminal import can_rewrite_lines, console
from tachk.diagnostics.diagnostic import InputError, Severity, UnsupportedError, UsageError
from tachk.engines.options import Extrapolation, Limits, Options, SearchOrder
from tachk.engines.outcome import INTERRUPTED
from tachk.properties.verdict import Answer
from tachk.report.record import NotRead, RunRecord
from tachk.time_limit import OutOfTimeError, time_limit


@dataclass(frozen=True, slots=True)
class VerifyRequest:
    """The options of the command as they were given."""

    arguments: tuple[str, ...]
    query_files: tuple[Path, ...] = ()
    definitions: tuple[str, ...] = ()
    properties: tuple[str, ...] = ()
    search: str = "bfs"
    seed: int = 1
    trace: str = "some"
    format: str = "text"
    output: Path | None = None
    max_states: int | None = None
    max_seconds: float | None = None
    max_seconds_each: float | None = None
    max_memory: str | None = None
    max_depth: int | None = None
    extrapolation: str = "lu"
    every_trace: bool = False
    clocks: bool = False
    every_step: bool = False
    quiet: bool = False


def run_verify(request: VerifyRequest) -> ExitStatus:
    """Checks every model; a model that cannot be checked does not keep the others from being checked.

    Reports for programs are written in any case, and list what could not be read.
    """
    records: list[RunRecord | NotRead] = []
    if request.output is not None and re.fullmatch("[0-6]", str(request.output)):
        raise UsageError(
            f"-o {request.output} is a search order of UPPAAL, here --search; -o names the file for the report",
            f"`tachk verifyta` takes UPPAAL's options; a file of that name is ./{request.output}",
        )
    with destination(request.output, request.quiet) as out:

        def check_all() -> ExitStatus:
            models, queries = split_models_and_queries(request.arguments)
            constants = parse_definitions(request.definitions)
            options, limits = _options(request), _limits(request)

            def check(path: str) -> ExitStatus:
                with _listed(path, records):
                    record = _check_model(path, queries, constants, options, limits, request)
                if request.format == "text" and out is not None:
                    _print_text(record, out, request, first=not any(isinstance(r, RunRecord) for r in records))
                elif request.format == "verifyta" and out is not None:
                    _print_as_verifyta(record, out, request)
                records.append(record)
                return worst(_statuses(record))

            statuses: list[ExitStatus] = []
            for path in models:
                statuses.append(guarded(partial(check, path), path if len(models) > 1 else ""))
                if statuses[-1] is ExitStatus.INTERRUPTED:
                    break
            return worst(statuses)

        def command() -> ExitStatus:
            with _listed("", records):
                return check_all()

        status = guarded(command)
        if out is not None:
            if request.format == "json":
                from tachk.report.json_report import runs_to_json
                from tachk.report.json_text import json_text

                out.write(json_text(runs_to_json(records, request.every_step)))
            elif request.format == "junit":
                from tachk.report.junit_report import runs_to_junit

                out.write(runs_to_junit(records))
    return status


@contextmanager
def _listed(path: str, records: list[RunRecord | NotRead]) -> Iterator[None]:
    """An error about a model goes into the reports, too."""
    try:
        yield
    except InputError as error:
        errors = [found for found in error.diagnostics if found.severity is Severity.ERROR]
        records.append(NotRead(path, errors[0].message, None, error.diagnostics))
        raise
    except UnsupportedError as error:
        records.append(NotRead(path, error.diagnostic.message, None, (error.diagnostic,)))
        raise
    except UsageError as error:
        records.append(NotRead(path, error.message, error.help))
        raise
    except OutOfTimeError:
        records.append(NotRead(path, OUT_OF_TIME))
        raise
    except Exception as error:
        records.append(NotRead(path, f"{type(error).__name__}: {error}"))
        raise


def _print_text(record: RunRecord, out: TextIO, request: VerifyRequest, first: bool) -> None:
    if not first:
        out.write("\n")
    from tachk.report.text_report import print_run

    print_run(record, console(out), request.every_trace, request.clocks, request.every_step)


def _print_as_verifyta(record: RunRecord, out: TextIO, request: VerifyRequest) -> None:
    """The report, and on standard error the traces that were asked for: where verifyta writes them."""
    from tachk.report.run.verifyta_trace import concrete_trace
    from tachk.report.verifyta_report import run_to_verifyta

    wanted = request.every_trace and request.trace != "none"
    out.write(run_to_verifyta(record, request.trace if wanted else "no"))
    for verdict in record.verdicts:
        if wanted and verdict.trace is not None:
            print(concrete_trace(record.network, verdict.trace), file=sys.stderr)


def _limits(request: VerifyRequest) -> Limits:
    return Limits(
        request.max_states,
        request.max_seconds,
        None if request.max_memory is None else parse_size(request.max_memory),
        request.max_depth,
        request.max_seconds_each,
    )


def _options(request: VerifyRequest) -> Options:
    order = SearchOrder(request.search)
    if request.trace == "shortest" and order is not SearchOrder.BFS:
        raise UsageError(
            f"--trace shortest needs --search bfs, not {order.value}",
            "breadth-first search is what makes the first run that is found a shortest one",
        )
    shortest = request.trace == "shortest"
    return Options(order, request.seed, Extrapolation(request.extrapolation), shortest=shortest)


def _check_model(
    path: str,
    queries: tuple[str, ...],
    constants: dict[str, str],
    options: Options,
    limits: Limits,
    request: VerifyRequest,
) -> RunRecord:
    started = time.monotonic()
    with time_limit(limits.seconds):
        model = api.load(path, **constants)
    print_diagnostics((*model.refusals, *model.warnings))
    progress = ProgressLine() if can_rewrite_lines(sys.stderr) and not request.quiet else None
    try:
        report = model.verify(
            *queries,
            property=request.properties,
            query_files=request.query_files,
            options=options,
            limits=limits.after(time.monotonic() - started),
            trace=request.trace != "none",
            progress=progress,
        )
    finally:
        if progress is not None:
            progress.clear()
    return report.record


def _statuses(record: RunRecord) -> Iterable[ExitStatus]:
    """Everything that the outcome of a run amounts to; the gravest of them is the status."""
    if any(verdict.reason == INTERRUPTED for verdict in record.verdicts):
        yield ExitStatus.INTERRUPTED
    if any(query.is_wrong for query in record.not_checked):
        yield ExitStatus.BAD_INPUT
    if any(verdict.met is False for verdict in record.verdicts):
        yield ExitStatus.NOT_AS_EXPECTED
    refused = any(query.diagnostics for query in record.not_checked)
    unsupported = any(verdict.unsupported is not None for verdict in record.verdicts)
    if record.refusals or record.nothing_checked or refused or unsupported:
        yield ExitStatus.UNSUPPORTED
    if any(verdict.answer is Answer.UNKNOWN for verdict in record.verdicts):
        yield ExitStatus.UNKNOWN
