"""What a server loads before requests come: what plain commands need.

Nothing that starts threads, as a copy of a process with threads may hang.

Modules only: nothing that a command computes stays in the server.
"""

from __future__ import annotations

import gc
import os
import sys
import tempfile
from collections.abc import Iterable, Sequence
from contextlib import suppress
from importlib import import_module

from tachk.base.cycles import collect_rarely
from tachk.base.records import is_dataclass, make_methods
from tachk.cli.main import COMMANDS, load_command
from tachk.cli.start import run_here

_MODEL = """process P() { clock x; init location a { invariant x <= 2; to b { guard x >= 1; } } location b; }
system P;
property p : A[] P.x <= 2;
property q : A<> P.b;
property r : F P.b;
"""
_FILES = {"m.ta": _MODEL, "wrong.ta": "process P() { init location a {} } system Q;"}
_COMMAND_LINES = (
    ("verify", "m.ta"),
    ("verify", "m.ta", "--format", "json", "--trace", "shortest"),
    ("verify", "m.ta", "E<> P.b && P.x == 2", "A[] not P.b", "P.a --> P.b"),
    ("verify", "wrong.ta"),
    ("check", "m.ta", "--format", "json"),
    ("fmt", "--check", "m.ta"),
    ("--help",),
)
"""What copies of the server carry out for trial. They report the modules that this has loaded."""

_WITH_THREADS = frozenset({"numpy", "z3", "pandas", "pyarrow", "matplotlib", "h5py", "distributed"})
"""Libraries that start threads, or are needed by libraries that do."""


def preload() -> None:
    """Loads the modules, and prepares the process for being copied."""
    collect_rarely()
    with tempfile.TemporaryDirectory(prefix="tachk-") as folder:
        for name, text in _FILES.items():
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write(text)
        for words in _COMMAND_LINES:
            _load(_modules_after(words, folder))
    for command in COMMANDS:  # whose options are read by a library that takes longer to load than they
        load_command(command)
    from tachk.syntax.parsing import tables

    tables.make_rows()
    for module in [*sys.modules.values()]:
        for thing in [*vars(module).values()]:
            if isinstance(thing, type) and is_dataclass(thing):
                make_methods(thing)
    gc.collect()
    gc.freeze()


def _load(names: Iterable[str]) -> None:
    for name in names:
        with suppress(ImportError):
            import_module(name)


def _modules_after(words: Sequence[str], folder: str) -> list[str]:
    """The modules that a command line loads in a copy of this process; none where one of them starts threads."""
    ours, theirs = os.pipe()
    child = os.fork()
    if not child:
        try:
            _try(words, folder)
            names = "\n".join(name for name in sys.modules if name != "__main__")
            if _WITH_THREADS.isdisjoint(sys.modules):
                with os.fdopen(theirs, "w", encoding="utf-8") as pipe:
                    pipe.write(names)
        finally:
            os._exit(0)
    os.close(theirs)
    with os.fdopen(ours, encoding="utf-8") as pipe:
        names = pipe.read()
    os.waitpid(child, 0)
    return names.split()


def _try(words: Sequence[str], folder: str) -> None:
    os.chdir(folder)
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in range(3):
        os.dup2(nothing, number)
    sys.argv = ["tachk", *words]
    with suppress(SystemExit):
        run_here()
