"""`python -m tachk` is the command line."""

from __future__ import annotations

from tachk.cli.main import run

run()
