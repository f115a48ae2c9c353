"""`tachk convert`: write a model in another form."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tachk.base.diagnostics.diagnostic import InputError, TachkError, UsageError
from tachk.base.span import Span
from tachk.cli import options
from tachk.cli.commands.export import files_of, write_files
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import print_diagnostics
from tachk.formats.catalogue import SUFFIXES, export_model, format_of
from tachk.formats.exported import Writing
from tachk.syntax.source_files import read_source

if TYPE_CHECKING:
    from tachk.formats.plain.plain_model import PlainRewriting
    from tachk.syntax import ast


_ENDINGS = (".ta", *SUFFIXES)
_HELP = f"""Write a model in another format: {", ".join(_ENDINGS[:-1])} or {_ENDINGS[-1]}.

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
    options.finish(lambda: run_convert(source, output, query_files, fix, force), seconds)


def run_convert(source: str, output: Path, query_files: tuple[Path, ...], fix: bool, force: bool = False) -> ExitStatus:
    """Writes a file in another form.

    To tachk's own language nothing but the text is read, so an incomplete model can be converted too; ``-`` as output
    prints canonical text, for `git diff` and the like. Files that say something else already are overwritten only by
    ``force``: they may have been edited.
    """
    from tachk.api import model as api

    target = output.suffix.lower()
    to_text = str(output) == "-" or target == ".ta"
    if source.endswith(".q"):
        files = _convert_queries(Path(source), output)
    elif to_text:
        files = _convert_to_text(Path(source), output, query_files, fix)
    else:
        if query_files:
            raise UsageError("-q goes with a .ta file as output", "convert to .ta first, then to the other format")
        model = api.load(source)
        print_diagnostics(model.warnings)
        exported = export_model(model.loaded, format_of(output, (".ta",)), Writing(repair_names=fix))
        _report([step for step in exported.steps if step.kind == "name"])
        files = files_of(exported, output)
    if str(output) == "-":
        sys.stdout.write(files[output])
    else:
        _keep_edited(files, force)
        write_files(files)
    return ExitStatus.AS_EXPECTED


def _keep_edited(files: Mapping[Path, str], force: bool) -> None:
    """Raises UsageError if a file exists that does not hold what is to be written."""
    for path, text in files.items():
        if not force and path.is_file() and path.read_text(encoding="utf-8", errors="replace") != text:
            raise UsageError(f"{path} exists with other contents; a user may have edited it", "--force overwrites it")


def _convert_to_text(source: Path, output: Path, query_files: tuple[Path, ...], fix: bool) -> dict[Path, str]:
    from tachk.formats.layout_json import layout_path, layout_to_json
    from tachk.formats.loading.model_files import read_model
    from tachk.formats.plain.expansion import document_repairs
    from tachk.formats.uppaal.query_reader import comment_of, without_properties
    from tachk.syntax import ast
    from tachk.syntax.printing.printer import print_document

    read = read_model(read_source(source))
    print_diagnostics(read.warnings)
    document, layout = read.document, read.layout
    aside = [*read.headings, *(_aside(query.span, query.text, query.comment) for query in read.broken)]
    wrong = set() if layout is None else _wrong_queries(source)
    if layout is not None and wrong:
        comments = {query.name: query.comment for query in layout.queries}
        layout = without_properties(layout, document, wrong)
        items: list[ast.Item] = []
        for item in document.items:
            if isinstance(item, ast.PropertyDeclaration) and item.name.name in wrong:
                said = comments.get(item.name.name)
                aside.append(_aside(item.span, item.formula.span.text, comment_of(item) if said is None else said))
            else:
                items.append(item)
        document = replace(document, items=tuple(items))
    properties = [item for path in query_files for item in _properties(path, document.span)]
    if properties:
        document = replace(document, items=(*document.items, *properties))
    if fix:
        document, steps = document_repairs(document)
        _report(steps)
    document = replace(document, comments=tuple(sorted((*document.comments, *aside), key=lambda c: c.span.start)))
    return {output: print_document(document)} | (
        {} if layout is None else {layout_path(output): layout_to_json(layout)}
    )


def _aside(place: Span, formula: str, comment: str) -> ast.Comment:
    from tachk.formats.uppaal.query_asides import wrong_query
    from tachk.syntax import ast

    return ast.Comment(place, wrong_query(formula, comment), True)


def _wrong_queries(source: Path) -> set[str]:
    """The names of the readable queries of an XML file that are wrong, as far as its model can be loaded."""
    from tachk.formats.loading.load import load_model
    from tachk.syntax import ast

    try:
        loaded = load_model(source)
    except TachkError:
        return set()
    named = {item.name.name for item in loaded.items if isinstance(item, ast.PropertyDeclaration)}
    return {query.name for query in loaded.unchecked if query.is_wrong and query.name in named}


def _report(steps: list[PlainRewriting]) -> None:
    for step in steps:
        print(step, file=sys.stderr)


def _properties(path: Path, at: Span) -> list[ast.PropertyDeclaration]:
    """The queries of a file as properties named after it."""
    from tachk.syntax import ast
    from tachk.syntax.parsing.parser import has_errors
    from tachk.syntax.query_files import parse_queries

    source = read_source(path)
    entries, diagnostics = parse_queries(source)
    if has_errors(diagnostics):
        raise InputError(diagnostics)
    return [
        ast.PropertyDeclaration(
            entry.span,
            ast.Identifier(at, f"q{number}"),
            " ".join(entry.comment.replace('"', "'").split()),
            entry.formula,
            entry.expectation,
        )
        for number, entry in enumerate(entries, 1)
    ]


def _convert_queries(source: Path, output: Path) -> dict[Path, str]:
    from tachk.formats.plain.plain_model import PlainQuery
    from tachk.formats.uppaal.query_file import print_queries
    from tachk.syntax.parsing.parser import has_errors
    from tachk.syntax.query_files import parse_queries

    if output.suffix.lower() != ".q" and str(output) != "-":
        raise UsageError(
            f"{source} is a file of queries", "give it with -q beside a model, or convert it to another .q"
        )
    entries, diagnostics = parse_queries(read_source(source))
    if has_errors(diagnostics):
        raise InputError(diagnostics)
    return {output: print_queries([PlainQuery("", e.formula, e.comment, e.expectation) for e in entries])}
