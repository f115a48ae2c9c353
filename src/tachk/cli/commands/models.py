"""`tachk models`: list the models that come with tachk, or copy one."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from itertools import takewhile
from pathlib import Path

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import closest
from tachk.base.resources import data_root
from tachk.cli import options
from tachk.cli.copying import copy_files
from tachk.cli.exit_status import ExitStatus
from tachk.syntax.source_files import read_source


@click.group(name="models", invoke_without_command=True)
@click.pass_context
def command(ctx: click.Context) -> None:
    """List the models that come with tachk, or copy one.

    Without a subcommand: list them.
    """
    if ctx.invoked_subcommand is None:
        options.finish(run_list)


@command.command(name="list")
def list_command() -> None:
    """List the models and what each is about."""

    options.finish(run_list)


@command.command(name="copy")
@click.argument(
    "name", metavar="NAME", help="A name from the list; its last part is enough if no other name ends with it."
)
@click.argument(
    "folder",
    metavar="[DIR]",
    type=options.type_of_file,
    default=Path(),
    help="The folder to copy to; by default the current one.",
)
@click.option("--force", is_flag=True, help="Overwrite files with other contents.")
def copy_command(name: str, folder: Path, force: bool) -> None:
    """Copy a model with every file that it imports."""

    options.finish(lambda: run_copy(name, folder, force))


_SYSTEM = re.compile(r"^system\b", re.MULTILINE)


def run_list() -> ExitStatus:
    """Prints the name and the first sentence of each model that is a system, not a part of one."""
    found = _models()
    width = max(map(len, found))
    for name, path in found.items():
        print(f"{name:<{width}}  {_first_sentence(path.read_text(encoding='utf-8'))}")
    return ExitStatus.AS_EXPECTED


def _first_sentence(text: str) -> str:
    """Of the comment at the beginning of a text."""
    comment = takewhile(lambda line: line.startswith("//"), text.splitlines())
    paragraph = takewhile(bool, (line.removeprefix("//").strip() for line in comment))
    return re.split(r"(?<=[.!?]) ", " ".join(paragraph), maxsplit=1)[0]


def run_copy(name: str, folder: Path, force: bool = False) -> ExitStatus:
    """Copies a model and its imports; the files keep their places relative to each other.

    Raises:
        UsageError: there is no such model, or a file that is different would be lost.
    """
    if not folder.exists() and _fitting(str(folder)):
        raise UsageError(f"{folder} is the name of a model, not of a folder", "copy one model at a time")
    files = [*dict.fromkeys(_with_imports(_named(name)))]
    common = Path(os.path.commonpath([path.parent for path in files]))
    targets = {path: folder / path.relative_to(common) for path in files}
    copy_files(targets, force, "name another folder, or add --force to overwrite it")
    return ExitStatus.AS_EXPECTED


def _models() -> dict[str, Path]:
    """The systems, by their path below ``models/`` without the ending."""
    root = data_root() / "models"
    paths = sorted(root.rglob("*.ta"))
    return {
        path.relative_to(root).with_suffix("").as_posix(): path
        for path in paths
        if _SYSTEM.search(path.read_text(encoding="utf-8"))
    }


def _fitting(name: str) -> list[str]:
    """The models that a name may mean."""
    wanted = name.removesuffix(".ta").removeprefix("models/")
    return [full for full in _models() if full == wanted or full.endswith(f"/{wanted}")]


def _named(name: str) -> Path:
    found, fitting = _models(), _fitting(name)
    if len(fitting) == 1:
        return found[fitting[0]]
    if fitting:
        raise UsageError(f"{name} may be several models", f"name one of {', '.join(fitting)}")
    wanted = name.removesuffix(".ta").removeprefix("models/")
    close = closest(wanted, [*found, *(full.rpartition("/")[2] for full in found)])
    raise UsageError(
        f"no model that comes with tachk is called {name}", f"did you mean {close}?" if close else "tachk models"
    )


def _with_imports(path: Path) -> Iterator[Path]:
    from tachk.syntax import ast
    from tachk.syntax.parsing.parser import parse_document

    yield path
    document, _ = parse_document(read_source(path))
    assert document is not None, path
    for item in document.items:
        if isinstance(item, ast.ImportDeclaration):
            yield from _with_imports((path.parent / item.path).resolve())
