"""`tachk models`: list the models that come with tachk, or copy one."""

from __future__ import annotations

from pathlib import Path

import click

from tachk.cli import options


@click.group(name="models", invoke_without_command=True)
@click.pass_context
def command(ctx: click.Context) -> None:
    """List the models that come with tachk, or copy one.

    Without a subcommand: list them.
    """
    if ctx.invoked_subcommand is None:
        _list()


@command.command(name="list")
def list_command() -> None:
    """List the models and what each is about."""
    _list()


def _list() -> None:
    from tachk.cli.actions.models import run_list

    options.finish(run_list)


@command.command(name="copy")
@click.argument(
    "name", metavar="NAME", help="A name from the list; its last part is enough if no other name ends with it."
)
@click.argument(
    "folder",
    metavar="DIR",
    type=options.type_of_file,
    default=Path(),
    help="The folder to copy to; by default the current one.",
)
@click.option("--force", is_flag=True, help="Overwrite files with other contents.")
def copy_command(name: str, folder: Path, force: bool) -> None:
    """Copy a model with every file that it imports."""
    from tachk.cli.actions.models import run_copy

    options.finish(lambda: run_copy(name, folder, force))
