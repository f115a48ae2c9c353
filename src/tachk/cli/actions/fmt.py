"""The action of `tachk fmt`."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.whole_files import write_whole
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import guarded, print_diagnostics
from tachk.syntax import ast
from tachk.syntax.parsing.parser import has_errors, parse_document
from tachk.syntax.printing.printer import print_document
from tachk.syntax.sentences.parser import parse_sentence
from tachk.syntax.source_files import read_source
from tachk.syntax.walk import nodes_of_kind


def run_fmt(files: tuple[Path, ...], check_only: bool, to_stdout: bool) -> ExitStatus:
    """Formats every file; a file with a mistake is reported and left alone."""
    return worst([guarded(partial(_format, path, check_only, to_stdout)) for path in files])


def _format(path: Path, check_only: bool, to_stdout: bool) -> ExitStatus:
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
    return parse_sentence(node.span)[1] if node.sentence else ()
