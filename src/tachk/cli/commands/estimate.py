"""`tachk estimate`: estimate probabilities by random runs (statistical queries)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from tachk.cli import options
from tachk.cli import simulation_options as drawing
from tachk.cli.reporting import Reporting


def _share(name: str, letter: str, default: float, help: str) -> Callable[[options.Decorated], options.Decorated]:
    """An option of a sequential test: a probability of at most 0.5."""
    share = click.FloatRange(0, 0.5, min_open=True)
    return click.option(f"--{name}", metavar=letter, type=share, default=default, show_default=True, help=help)


@click.command(name="estimate")
@click.argument("arguments", metavar="MODEL [QUERY]...", nargs=-1, required=True, help="A model file, and queries.")
@options.query_files("Answer the statistical queries in this file.")
@options.definitions
@click.option("properties", "--property", metavar="NAME", multiple=True, help="Answer this property of the model.")
@options.faults
@drawing.confidence(0.8, "How probable it is, at least, that an interval contains what it is for.")
@drawing.half_width("Draw runs until the interval of a probability is at most 2 E wide.")
@drawing.runs("Draw N runs, whatever comes of them.")
@_share("alpha", "A", 0.05, "Of Pr >= p: say `fails` with at most this probability where Pr is at least p + D.")
@_share("beta", "B", 0.05, "Of Pr >= p: say `holds` with at most this probability where Pr is at most p - D.")
@_share("delta", "D", 0.01, "Half the region in which both answers are right.")
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
    type=options.type_of_file,
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
    from tachk.cli.actions.estimate import EstimateArguments, run_estimate

    request, reporting = options.distributed(given, EstimateArguments, Reporting)
    options.finish(lambda: run_estimate(request, reporting), seconds)
