"""`tachk fmt`."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import guarded, print_diagnostics
from tachk.diagnostics.diagnostic import InputError
from tachk.syntax.parser import has_errors, parse_document
from tachk.syntax.printer import print_document
from tachk.syntax.source_files import read_source


def run_fmt(files: tuple[Path, ...], check_only: bool, to_stdout: bool) -> ExitStatus:
    """Formats every file; a file with a mistake is reported and left alone."""
    return worst([guarded(partial(_format, path, check_only, to_stdout)) for path in files])


def _format(path: Path, check_only: bool, to_stdout: bool) -> ExitStatus:
    source = read_source(path)
    document, diagnostics = parse_document(source)
    if document is None or has_errors(diagnostics):
        raise InputError(diagnostics)
    print_diagnostics(diagnostics)
    after = print_document(document)
    if to_stdout:
        sys.stdout.write(after)
    if check_only:
        if source.text != after:
            print(f"{path} is not in canonical form")
            return ExitStatus.NOT_AS_EXPECTED
    elif not to_stdout and source.text != after:
        path.write_text(after, encoding="utf-8")
        print(f"{path} rewritten")
    return ExitStatus.AS_EXPECTED
