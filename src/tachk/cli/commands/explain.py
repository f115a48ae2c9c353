"""`tachk explain`: explain a message, a formula or a sentence."""

from __future__ import annotations

import click

from tachk.cli import options


@click.command(name="explain")
@click.argument(
    "what",
    metavar="CODE|FORMULA|FILE",
    type=click.Path(),
    help="The code of a message, such as E0214; a formula or sentence; or a file with formulas or sentences.",
)
@options.max_seconds()
def command(what: str, seconds: float | None) -> None:
    """Explain a message of tachk, or a property that is written as a formula or a sentence.

    For a message: what it means, an example, how to mend it. For a property: its formula in canonical form, how far it
    looks ahead, and whether all its intervals begin at 0.
    """
    from tachk.cli.actions.explain import run_explain

    options.finish(lambda: run_explain(what), seconds)
