"""Runs command lines of tachk in one process where only some packages can be imported.

    python without_extras.py PACKAGE,PACKAGE ... <lines.json

Standard input is a list of lists of arguments; the output a list of [status, standard output and error], as JSON. A
package that is not named, not part of Python and not tachk is as if it were not installed.
"""

from __future__ import annotations

import contextlib
import importlib.abc
import importlib.machinery
import importlib.util
import io
import json
import sys
from collections.abc import Sequence
from types import ModuleType


class _OnlySome(importlib.abc.MetaPathFinder):
    def __init__(self, allowed: frozenset[str]) -> None:
        self.allowed = allowed | sys.stdlib_module_names | {"tachk", "__mp_main__"}

    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        if name.partition(".")[0] not in self.allowed:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return None


def _hide(allowed: frozenset[str]) -> None:
    only = _OnlySome(allowed)
    sys.meta_path.insert(0, only)
    found = importlib.util.find_spec

    def spec_or_none(name: str, package: str | None = None) -> importlib.machinery.ModuleSpec | None:
        return found(name, package) if name.partition(".")[0] in only.allowed else None

    importlib.util.find_spec = spec_or_none


def _outcome(arguments: list[str]) -> tuple[int, str]:
    import click

    from tachk.cli.main import app

    out = io.TextIOWrapper(io.BytesIO(), encoding="utf-8", write_through=True)
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        try:
            status = app.main(arguments, prog_name="tachk", standalone_mode=False)
        except click.ClickException as error:
            error.show()
            status = error.exit_code
        except SystemExit as error:
            status = error.code
    return int(status or 0), out.buffer.getvalue().decode()


if __name__ == "__main__":
    lines = json.load(sys.stdin)
    _hide(frozenset(sys.argv[1].split(",")))
    json.dump([_outcome(line) for line in lines], sys.stdout)
