"""Names that commands had in version 0.2, and the command lines that mean the same now. Imports nothing heavy."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple


class FormerName(NamedTuple):
    """Attributes:
    name: the command of today, with the option that it needs.
    arguments: the new command line behind `tachk`, from the arguments behind the old name.
    """

    name: str
    arguments: Callable[[Sequence[str]], list[str]]


def _in_folder(folder: str, name: str) -> FormerName:
    return FormerName(f"{folder} {name}", lambda arguments: [folder, name, *arguments])


def _export(arguments: Sequence[str]) -> list[str]:
    """`export` overwrote files, printed the text of UPPAAL where it was given no file, and replaced names."""
    says_what = any(argument.startswith(("-o", "--output", "--format")) for argument in arguments)
    is_unit = any(argument.endswith(("fmu", ".FMU")) for argument in arguments)
    form = [] if says_what else ["--format", "xta"]
    return ["convert", "--force", *([] if is_unit else ["--fix"]), *form, *arguments]


def _mine(arguments: Sequence[str]) -> list[str]:
    """`mine --over NAME=LOW..HIGH` looked for a value; each of its traces was judged alone."""
    return [
        "monitor",
        *(
            f"--find{argument.removeprefix('--over')}" if argument.split("=")[0] == "--over" else argument
            for argument in arguments
        ),
    ]


FORMER_NAMES = {
    **{name: _in_folder("xrce", name) for name in ("decode", "measure", "proxy", "bridge")},
    "export": FormerName("convert", _export),
    "mine": FormerName("monitor --find", _mine),
    "sentences": FormerName("explain --sentences", lambda arguments: ["explain", "--sentences", *arguments]),
}
"""The commands of version 0.2 that have other names now."""
