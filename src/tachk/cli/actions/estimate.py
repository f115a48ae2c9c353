"""The action of `tachk estimate`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError, UsageError
from tachk.base.job import StoppedError, unhurried
from tachk.base.records import dataclass
from tachk.base.seeds import DEFAULT_SEED
from tachk.base.span import Source as Text
from tachk.cli.arguments import parse_definitions, split_models_and_queries
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import print_diagnostics
from tachk.cli.reporting import Reporting
from tachk.cli.simulated_model import simulated_model
from tachk.engine.outcome import INTERRUPTED
from tachk.frontend.queries.queries import is_statistical
from tachk.frontend.queries.statistical import StatisticalReader
from tachk.model.query import Expectation
from tachk.model.statistical import StatisticalQuery
from tachk.report.json_text import json_text
from tachk.report.statistics.json import estimates_document
from tachk.report.statistics.text import answer_lines
from tachk.simulation.fault_injection import read_plan, with_faults
from tachk.simulation.statistics.answers import NoEstimate, as_expected
from tachk.simulation.statistics.deciding import Errors
from tachk.simulation.statistics.estimate import Estimate, Settings, estimate
from tachk.simulation.statistics.rare import Splitting
from tachk.simulation.statistics.sampling import RunSource
from tachk.syntax.source_files import read_source
from tachk.verify.questions import Questions

_READING = 1.0


@dataclass(frozen=True, slots=True)
class EstimateArguments:
    """Arguments of `tachk estimate`."""

    arguments: tuple[str, ...]
    query_files: tuple[Path, ...] = ()
    definitions: tuple[str, ...] = ()
    faults: tuple[str, ...] = ()
    properties: tuple[str, ...] = ()
    confidence: float = 0.95
    half_width: float = 0.05
    runs: int | None = None
    alpha: float = 0.05
    beta: float = 0.05
    delta: float = 0.01
    seed: int = DEFAULT_SEED
    threads: int = 1
    most_steps: int | None = None
    most_runs: int = 1_000_000
    splitting: bool = False
    relative: float = 0.1
    effort: int = 1000
    picture: Path | None = None


def run_estimate(request: EstimateArguments, reporting: Reporting) -> ExitStatus:
    """Answers the queries in their order, and reports."""
    models, typed = split_models_and_queries(request.arguments)
    if len(models) > 1:
        raise UsageError("tachk estimate takes one model", f"and queries: tachk estimate {models[0]} 'Pr[<=100](<> p)'")
    model = simulated_model(models[0], **parse_definitions(request.definitions))
    print_diagnostics((*model.refusals, *model.warnings))
    plan = read_plan(request.faults)
    network = with_faults(model.network, plan).network
    settings = Settings(
        RunSource(request.seed, 0, request.threads, request.most_steps),
        request.confidence,
        request.half_width,
        request.runs,
        Errors(request.alpha, request.beta, request.delta),
        request.most_runs,
        Splitting(request.relative, request.effort) if request.splitting else None,
    )
    statuses: list[ExitStatus] = []
    found: list[Estimate | NoEstimate] = []
    reason = ""
    for query, expectation in _queries(model, request, typed, statuses):
        if not reason:
            try:
                seen = network if query.network is None else with_faults(query.network, plan).network
                answer = estimate(seen, query, settings)
            except StoppedError as error:
                reason = error.reason
            except KeyboardInterrupt:
                reason = INTERRUPTED
            else:
                found.append(answer)
                statuses.append(_status(answer, expectation))
                continue
        found.append(NoEstimate(query, reason))
        statuses.append(ExitStatus.INTERRUPTED if reason == INTERRUPTED else ExitStatus.UNKNOWN)
    answered = [each for each in found if not isinstance(each, NoEstimate)]
    if request.picture is not None and (answered or not reason):
        from tachk.report.statistics.picture import plot_estimates

        plot_estimates(answered, network.time_unit, request.picture)
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None and reporting.form == "json":
            out.write(json_text(estimates_document(models[0], found, settings)))
        elif out is not None:
            out.writelines(f"{line}\n" for each in found for line in answer_lines(each, settings))
    return worst(statuses)


def _queries(
    model: api.Model, request: EstimateArguments, typed: tuple[str, ...], statuses: list[ExitStatus]
) -> Iterator[tuple[StatisticalQuery, Expectation | None]]:
    """The queries to answer. A mistake in a query of a file or a model is reported; the other queries are still
    answered."""
    loaded = model.loaded
    named = [query for query in loaded.formulas if query.name in request.properties]
    missing = set(request.properties) - {query.name for query in named}
    if missing:
        raise UsageError(f"{model.path} has no property {min(missing)!r}")
    files = tuple(read_source(path) for path in request.query_files)
    given = Questions(model.path, (), files, tuple(Text("<query>", text) for text in typed))
    formulas = [*named, *(given.about(loaded) if typed or files or not named else ())]
    if not any(map(is_statistical, formulas)):
        raise UsageError(
            f"{model.path}: there is no statistical query",
            "give one behind the model, such as 'Pr[<=100](<> P.location)'; `tachk verify` checks all others",
        )
    reader = StatisticalReader(loaded)
    for query in formulas:
        if not is_statistical(query):
            continue
        try:
            with unhurried(_READING):  # the report needs the query also where there was no time to answer it
                read_query = reader.read(query)
            yield read_query, query.expectation
        except InputError as error:
            if typed:
                raise
            print_diagnostics(error.diagnostics)
            statuses.append(ExitStatus.BAD_INPUT)
        except UnsupportedError as error:
            if typed:
                raise
            print_diagnostics([error.diagnostic])
            statuses.append(ExitStatus.UNSUPPORTED)


def _status(found: Estimate, expectation: Expectation | None) -> ExitStatus:
    met = as_expected(found, expectation)
    if met is None:
        return ExitStatus.UNKNOWN
    return ExitStatus.AS_EXPECTED if met else ExitStatus.NOT_AS_EXPECTED
