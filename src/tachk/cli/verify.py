"""`tachk verify`."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TextIO

from rich.console import Console

from tachk import api
from tachk.cli.arguments import parse_definitions, parse_size, split_models_and_queries
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import guarded, print_diagnostics
from tachk.cli.progress import ProgressLine
from tachk.diagnostics.diagnostic import UsageError
from tachk.engines.protocol import Extrapolation, Limits, Options, SearchOrder
from tachk.report.json_report import run_to_json
from tachk.report.junit_report import runs_to_junit
from tachk.report.record import RunRecord
from tachk.report.text_report import print_run
from tachk.report.verifyta_report import run_to_verifyta

_WIDTH = 1000
"""Columns of a report that does not go to a terminal: wide enough for no line to be broken."""


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
    max_memory: str | None = None
    max_depth: int | None = None
    extrapolation: str = "lu"
    every_trace: bool = False
    clocks: bool = False
    quiet: bool = False


def run_verify(request: VerifyRequest) -> ExitStatus:
    """Checks every model; a model that cannot be checked does not keep the others from being checked."""
    models, queries = split_models_and_queries(request.arguments)
    constants = parse_definitions(request.definitions)
    options = _options(request)
    limits = Limits(
        request.max_states,
        request.max_seconds,
        None if request.max_memory is None else parse_size(request.max_memory),
        request.max_depth,
    )
    records: list[RunRecord] = []
    with _destination(request) as out:

        def check(path: str) -> ExitStatus:
            record = _check_model(path, queries, constants, options, limits, request)
            if request.format == "text" and out is not None:
                _print_text(record, out, request, first=not records)
            elif request.format == "verifyta" and out is not None:
                out.write(run_to_verifyta(record))
            records.append(record)
            return _status(record)

        statuses = [guarded(partial(check, path), path if len(models) > 1 else "") for path in models]
        if records and out is not None:
            if request.format == "json":
                runs = [run_to_json(record) for record in records]
                json.dump(runs if len(models) > 1 else runs[0], out, indent=2)
                out.write("\n")
            elif request.format == "junit":
                out.write(runs_to_junit(records))
    return worst(statuses)


@contextmanager
def _destination(request: VerifyRequest) -> Iterator[TextIO | None]:
    """Where the report goes; None for nowhere."""
    if request.output is not None:
        with request.output.open("w", encoding="utf-8") as file:
            yield file
    else:
        yield None if request.quiet else sys.stdout


def _print_text(record: RunRecord, out: TextIO, request: VerifyRequest, first: bool) -> None:
    if not first:
        out.write("\n")
    console = Console(file=out, highlight=False, width=None if out.isatty() else _WIDTH)
    print_run(record, console, request.every_trace, request.clocks)


def _options(request: VerifyRequest) -> Options:
    order = SearchOrder(request.search)
    if request.trace == "shortest" and order is not SearchOrder.BFS:
        raise UsageError(
            f"--trace shortest needs --search bfs, not {order.value}",
            "breadth-first search is what makes the first run that is found a shortest one",
        )
    return Options(order, request.seed, Extrapolation(request.extrapolation))


def _check_model(
    path: str,
    queries: tuple[str, ...],
    constants: dict[str, str],
    options: Options,
    limits: Limits,
    request: VerifyRequest,
) -> RunRecord:
    model = api.load(path, **constants)
    print_diagnostics((*model.refusals, *model.warnings))
    progress = ProgressLine() if sys.stderr.isatty() and not request.quiet else None
    try:
        report = model.verify(
            *queries,
            property=request.properties,
            query_files=request.query_files,
            options=options,
            limits=limits,
            trace=request.trace != "none",
            progress=progress,
        )
    finally:
        if progress is not None:
            progress.clear()
    return report.record


def _status(record: RunRecord) -> ExitStatus:
    if any(not found.is_unsupported for query in record.not_checked for found in query.diagnostics):
        return ExitStatus.BAD_INPUT
    if record.refusals or any(query.diagnostics for query in record.not_checked):
        return ExitStatus.UNSUPPORTED
    if record.nothing_checked or any(verdict.unsupported is not None for verdict in record.verdicts):
        return ExitStatus.UNSUPPORTED
    match record.met:
        case True:
            return ExitStatus.AS_EXPECTED
        case False:
            return ExitStatus.NOT_AS_EXPECTED
        case None:
            return ExitStatus.UNKNOWN
