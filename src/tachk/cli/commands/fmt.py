"""`tachk fmt`: rewrite models in canonical form."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.whole_files import write_whole
from tachk.cli import options
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import guarded, print_diagnostics
from tachk.syntax.source_files import read_source

if TYPE_CHECKING:
    from tachk.syntax import ast


@click.command(name="fmt")
@click.argument(
    "files", metavar="FILE...", nargs=-1, required=True, type=options.type_of_file, help="Model files in text form."
)
@click.option("check_only", "--check", is_flag=True, help="Change no file; fail if one is not in canonical form.")
@click.option("to_stdout", "--stdout", is_flag=True, help="Print the result instead of changing the file.")
@options.max_seconds()
def command(files: tuple[Path, ...], check_only: bool, to_stdout: bool, seconds: float | None) -> None:
    """Rewrite models in canonical form."""

    options.finish(lambda: run_fmt(files, check_only, to_stdout), seconds)


def run_fmt(files: tuple[Path, ...], check_only: bool, to_stdout: bool) -> ExitStatus:
    """Formats every file; a file with a mistake is reported and left alone."""
    return worst([guarded(partial(_format, path, check_only, to_stdout)) for path in files])


def _format(path: Path, check_only: bool, to_stdout: bool) -> ExitStatus:
    from tachk.syntax import ast
    from tachk.syntax.parsing.parser import has_errors, parse_document
    from tachk.syntax.printing.printer import print_document
    from tachk.syntax.walk import nodes_of_kind

    source = read_source(path)
    document, diagnostics = parse_document(source)
    if document is None or has_errors(diagnostics):
        raise InputError(diagnostics)
    broken = [found for text in nodes_of_kind(document, ast.TemporalFormula) for found in _in_sentence(text)]
    if has_errors(tuple(broken)):
        raise InputError(broken)
    print_diagnostics(diagnostics)
    after = print_document(document)
    if to_stdout:
        sys.stdout.write(after)
    if check_only:
        if source.text != after:
            print(f"{path} is not in canonical form")
            return ExitStatus.NOT_AS_EXPECTED
    elif not to_stdout and source.text != after:
        write_whole(path, after)
        print(f"{path} rewritten")
    return ExitStatus.AS_EXPECTED


def _in_sentence(node: ast.TemporalFormula) -> tuple[Diagnostic, ...]:
    """The mistakes in a property that is a sentence, which the parser of models does not look into."""
    from tachk.syntax.sentences.parser import parse_sentence

    return parse_sentence(node.span)[1] if node.sentence else ()
