"""Options that the commands that draw runs share."""

from __future__ import annotations

from collections.abc import Callable

import click

from tachk.base.seeds import DEFAULT_SEED
from tachk.cli import options
from tachk.engine.simulation.policy import Policy

_Adds = Callable[[options.Decorated], options.Decorated]


def seed(help: str) -> _Adds:
    return click.option(
        "--seed", metavar="S", type=options.Count(0, 2**63 - 1), default=DEFAULT_SEED, show_default=True, help=help
    )


def threads(of: str) -> _Adds:
    """``of``: the results, which do not depend on the number of threads."""
    help = f"Draw runs with this many threads; the {of} do not depend on it."
    return click.option("--threads", metavar="N", type=options.Count(1, 256), default=1, help=help)


def confidence(least: float, help: str) -> _Adds:
    return click.option(
        "--confidence",
        metavar="C",
        type=options.NumberInRange(least, 0.999999),
        default=0.95,
        show_default=True,
        help=help,
    )


def half_width(help: str) -> _Adds:
    """``--epsilon``."""
    return click.option(
        "half_width",
        "--epsilon",
        metavar="E",
        type=options.NumberInRange(0.0001, 0.25),
        default=0.05,
        show_default=True,
        help=help,
    )


def runs(help: str, default: int | None = None) -> _Adds:
    count = options.Count(1, 10**9)
    if default is None:
        return click.option("runs", "--runs", metavar="N", type=count, help=help)
    return click.option("runs", "--runs", metavar="N", type=count, default=default, show_default=True, help=help)


def most_steps(name: str, help: str) -> _Adds:
    """``--max-steps``."""
    return click.option(name, "--max-steps", metavar="N", type=options.Count(1, 2**62), help=help)


def splitting(function: options.Decorated) -> options.Decorated:
    """``--splitting``, ``--relative`` and ``--effort``."""
    for add in reversed(_SPLITTING):
        function = add(function)
    return function


_SPLITTING: tuple[_Adds, ...] = (
    click.option(
        "--splitting",
        is_flag=True,
        help="Importance splitting, for rare events: begin runs again where others came nearest.",
    ),
    click.option(
        "--relative",
        metavar="R",
        type=options.NumberInRange(0.001, 1),
        default=0.1,
        show_default=True,
        help="With --splitting: half the width of the interval, as a share of the probability.",
    ),
    click.option(
        "--effort",
        metavar="N",
        type=options.Count(10, 10**7),
        default=1000,
        show_default=True,
        help="With --splitting: runs for each level.",
    ),
)

policy = click.option(
    "--policy",
    type=click.Choice([policy.value for policy in Policy]),
    default=Policy.STOCHASTIC.value,
    show_default=True,
    help="How long a process waits before it acts.",
)

record = click.option(
    "record",
    "--record",
    metavar="NAME",
    multiple=True,
    help="Write only this signal, process, variable, or P.location. Can be given several times.",
)

property_of_report = click.option(
    "prop", "--property", metavar="NAME", help="Of a report with several runs: the one about this property."
)
