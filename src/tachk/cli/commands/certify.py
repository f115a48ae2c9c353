"""`tachk certify`: check certificates: proofs of verdicts, without a search."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options
from tachk.cli.reporting import Reporting


@click.command(name="certify")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.argument(
    "file", metavar="FILE", type=options.type_of_file, help="The certificates that `tachk verify --certificate` wrote."
)
@options.definitions
@click.option(
    "checker",
    "--checker",
    type=click.Choice(["python", "native"]),
    default="python",
    show_default=True,
    help="python: shares no code with the engine. native: C++, for large certificates; it shares the compiled "
    "expressions of the model.",
)
@options.report("text", "json")
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Check certificates: proofs of verdicts, without a search.

    The exit status is 0 if every certificate of the file is accepted, 10 if one is rejected, and 2 if the file is
    damaged.
    """
    from tachk.cli.actions.certify import CertifyArguments, run_certify

    arguments = options.distributed(given, CertifyArguments, Reporting)
    options.finish(lambda: run_certify(*arguments), seconds)
