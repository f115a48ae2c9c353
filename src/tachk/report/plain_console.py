"""A console for text that a program keeps: no colours, no markup of notebooks, whatever surrounds the program."""

from __future__ import annotations

from typing import TextIO

from rich.console import Console


class ReportConsole(Console):
    """Leaves the handling of a closed pipe to the program: rich would end it with status 1."""

    def on_broken_pipe(self) -> None:
        raise BrokenPipeError


def plain_console(out: TextIO, width: int = 1000) -> Console:
    """A console that prints on `out` and nowhere else.

    Inside a kernel of Jupyter rich displays what it is given instead of writing it, and with ``FORCE_COLOR`` it takes
    any stream for a terminal.

    Args:
        width: in columns; the default is wide enough for no line to be broken.
    """
    return ReportConsole(
        file=out,
        width=width,
        highlight=False,
        emoji=False,
        color_system=None,
        force_terminal=False,
        force_jupyter=False,
    )
