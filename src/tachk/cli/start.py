"""The console script `tachk`: a plain `tachk verify` is carried out at once, everything else by the whole program.

Or a server carries it out.

What is imported at the top of this module is what a call by way of a server costs.
"""

from __future__ import annotations

import os
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn


def run() -> NoReturn:
    """The console script."""
    server = os.environ.get("TACHK_SERVER", "off")
    if server not in ("", "off"):
        _use_server(server)
    run_here()


def _use_server(setting: str) -> None:
    """Returns where the program is to do the work itself: Windows has neither such sockets nor copies of processes."""
    if os.name == "posix":
        from tachk.cli.server.client import use_server

        use_server(setting)
    elif setting != "auto":
        print(f"error: TACHK_SERVER={setting}: there are no servers on this system", file=sys.stderr)
        sys.exit(2)


def run_here() -> NoReturn:
    """Carries out the command line in this process."""
    from tachk.base.cycles import collect_rarely
    from tachk.cli.console_script import COMPLETION_VARIABLE, end_program

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
