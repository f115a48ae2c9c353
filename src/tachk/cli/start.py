"""The console script `tachk`: a plain `tachk verify` is carried out at once, everything else by the whole program."""

from __future__ import annotations

import os
import sys
from typing import NoReturn

from tachk.base.cycles import collect_rarely
from tachk.cli.console_script import COMPLETION_VARIABLE, end_program


def run() -> NoReturn:
    """The console script."""
    collect_rarely()  # also while modules are loaded
    name, *words = sys.argv[1:] or [""]
    # On Windows click replaces patterns by the files that fit.
    if name == "verify" and os.name == "posix" and COMPLETION_VARIABLE not in os.environ:
        from tachk.cli.plain_options import plain_values
        from tachk.report.run_formats import RUN_FORMATS

        given = plain_values(words, RUN_FORMATS)
        if given is not None:
            from tachk.cli.guard import run_command
            from tachk.cli.verification import verify_as_given

            end_program(lambda: run_command(lambda: verify_as_given(given)))
    from tachk.cli.main import run as run_any

    run_any()
