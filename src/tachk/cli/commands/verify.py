"""`tachk verify`: check the properties of models, or the given queries."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options
from tachk.cli.plain_options import PROPERTIES
from tachk.cli.reporting import EvidenceChoice
from tachk.cli.verification import EVERY_CORE, verify_as_given
from tachk.engine.options import (
    LARGEST_SEED,
    MOST_PROCESSES,
    Engine,
    Extrapolation,
    LocalTimes,
    Options,
    SearchOrder,
)
from tachk.report.run_formats import RUN_FORMATS

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
@options.plain(PROPERTIES, "Check this property of the model.")
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
    default=EVERY_CORE,
    show_default="the cores of this machine, up to 8",
    help="How many searches for different properties run at the same time, each in a process of its own, once a second "
    "has passed. Cores that are left take the attempts beside each. --max-memory and --max-states hold for each. On "
    "Windows one.",
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

    options.finish(lambda: verify_as_given(given))
