"""`python -m tachk` is the command line."""

from __future__ import annotations

from tachk.cli.start import run

if __name__ == "__main__":  # processes that the program starts may import this module
    run()
