"""`tachk estimate`: estimate probabilities by random runs (statistical queries)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError, UsageError
from tachk.base.job import StoppedError, unhurried
from tachk.base.optional_packages import require
from tachk.base.records import dataclass
from tachk.base.seeds import DEFAULT_SEED
from tachk.base.span import Source as Text
from tachk.cli import options
from tachk.cli import simulation_options as drawing
from tachk.cli.destination import destination
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import print_diagnostics
from tachk.cli.reporting import Reporting
from tachk.report.json_text import json_text
from tachk.simulation.statistics.deciding import Errors
from tachk.syntax.source_files import read_source

if TYPE_CHECKING:
    from tachk.api import model as api
    from tachk.model.query import Expectation
    from tachk.model.statistical import StatisticalQuery
    from tachk.simulation.statistics.answers import NoEstimate
    from tachk.simulation.statistics.estimate import Estimate


def _share(name: str, letter: str, default: float, help: str) -> Callable[[options.Decorated], options.Decorated]:
    """An option of a sequential test: a probability of at most 0.5."""
    share = options.NumberInRange(0, 0.5, min_open=True)
    return click.option(f"--{name}", metavar=letter, type=share, default=default, show_default=True, help=help)


@click.command(name="estimate")
@click.argument("arguments", metavar="MODEL [QUERY]...", nargs=-1, required=True, help="A model file, and queries.")
@options.query_files("Answer the statistical queries in this file.")
@options.definitions
@click.option("properties", "--property", metavar="NAME", multiple=True, help="Answer this property of the model.")
@options.faults
@drawing.confidence(0.8, "Confidence level: the least probability that an interval contains the true value.")
@drawing.half_width("Draw runs until the interval of a probability is at most 2 E wide.")
@drawing.runs("Draw exactly N runs, however wide the intervals are then.")
@_share("alpha", "A", 0.05, "Tests `Pr >= p`: the largest probability of a wrong `fails`.")
@_share("beta", "B", 0.05, "Tests `Pr >= p`: the largest probability of a wrong `holds`.")
@_share("delta", "D", 0.01, "Half-width of the indifference region around p, in which both answers are right.")
@drawing.seed("The same seed gives the same answers.")
@drawing.threads("answers")
@drawing.most_steps("most_steps", "Give up a run after N transitions; it counts as unknown.")
@click.option(
    "most_runs",
    "--max-runs",
    metavar="N",
    type=options.Count(1, 10**9),
    default=1_000_000,
    show_default=True,
    help="End a test that has no decision after N runs.",
)
@drawing.splitting
@click.option(
    "picture",
    "--plot",
    metavar="FILE",
    type=options.written_file,
    help="Draw when goals are reached, how means are spread, and trajectories into this .svg, .png or .pdf file.",
)
@options.report("text", "json")
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Answer statistical queries of a model by random runs: Pr, E and simulate.

    \b
    tachk estimate queue.ta 'Pr[<=100](<> waiting >= 5)'
    tachk estimate queue.ta 'Pr[<=100](<> waiting >= 5) >= 0.5' --delta 0.02
    tachk estimate queue.ta 'E[<=100; 5000](max: waiting)'

    Without a query tachk answers all statistical queries of the model.
    Exit status: 0 every test holds or is as expected, 10 one is not or a run ends with a run-time error, 20 one is
    not decided, 2 bad input, 3 something that is not simulated.
    """

    request, reporting = distributed(given, EstimateArguments, Reporting)
    options.finish(lambda: run_estimate(request, reporting), seconds)


_ELABORATION = 1.0


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
    from tachk.cli.arguments import parse_definitions, split_models_and_queries
    from tachk.cli.simulated_model import simulated_model
    from tachk.engine.outcome import INTERRUPTED
    from tachk.report.statistics.json import estimates_document
    from tachk.report.statistics.text import answer_lines
    from tachk.simulation.fault_injection import read_plan, with_faults
    from tachk.simulation.statistics.answers import NoEstimate
    from tachk.simulation.statistics.estimate import Settings, estimate
    from tachk.simulation.statistics.rare import Splitting
    from tachk.simulation.statistics.sampling import RunSource

    if request.picture is not None:
        require("matplotlib")
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
    from tachk.frontend.queries.queries import is_statistical
    from tachk.frontend.queries.statistical import StatisticalReader
    from tachk.verify.questions import Questions

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
            with unhurried(_ELABORATION):  # the report needs the query also where there was no time to answer it
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
    from tachk.simulation.statistics.answers import as_expected

    met = as_expected(found, expectation)
    if met is None:
        return ExitStatus.UNKNOWN
    return ExitStatus.AS_EXPECTED if met else ExitStatus.NOT_AS_EXPECTED
