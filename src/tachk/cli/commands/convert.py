"""`tachk convert`: write a model in another form."""

from __future__ import annotations

from pathlib import Path

import click

from tachk.cli import options
from tachk.formats.catalogue import SUFFIXES

_ENDINGS = (".ta", *SUFFIXES)


_HELP = f"""Write a model in another form: {", ".join(_ENDINGS[:-1])} or {_ENDINGS[-1]}.

A .ta file keeps imports. The other formats contain the imported files, and what tachk adds to UPPAAL's language is
written out in full. Without --force, a file with other contents is not overwritten.
"""


@click.command(name="convert", help=_HELP)
@click.argument("source", metavar="IN", type=click.Path(), help="A model, or a file of queries.")
@click.argument(
    "output",
    metavar="OUT",
    type=options.type_of_file,
    help="The file to write; its ending is the format. - prints the model in tachk's own format.",
)
@options.query_files("Add the queries of this file to a .ta file.")
@click.option("--fix", is_flag=True, help="Replace names that some version of UPPAAL refuses.")
@click.option("--force", is_flag=True, help="Overwrite files with other contents, also those that you have edited.")
@options.max_seconds()
def command(
    source: str, output: Path, query_files: tuple[Path, ...], fix: bool, force: bool, seconds: float | None
) -> None:
    from tachk.cli.actions.convert import run_convert

    options.finish(lambda: run_convert(source, output, query_files, fix, force), seconds)
