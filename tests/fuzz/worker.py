"""Runs command lines of tachk, each in a child that is forked from a process which has imported everything."""

from __future__ import annotations

import ast
import contextlib
import faulthandler
import gc
import io
import os
import pickle
import re
import resource
import signal
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import NoReturn

from tachk.cli import commands, main
from tachk.report.verifyta_notes import peak_memory

CPU_SECONDS = 20
"""Of processor time, not of the clock: a busy machine makes no finding."""
WAITING_SECONDS = 120
"""Of the clock: for a command that waits for something and takes no processor time."""
MEMORY_BYTES = 4 * 2**30
FILE_BYTES = 256 * 2**20
STATUSES = frozenset({0, 1, 2, 3, 10, 20})
"""The statuses that a command may end with here: nobody interrupts it, and 70 is a defect."""

TOLERATED = 1.2
"""A command may take this many times what its limits allow."""
_WARNING = re.compile(r"^\S+:\d+: \w*Warning: .*|^Exception ignored in.*", re.MULTILINE)

_HEAVY = ("numpy", "pyarrow.parquet", "z3", "networkx", "matplotlib.figure", "lark", "vcd.reader")


@dataclass(frozen=True, slots=True)
class Case:
    """A command line, and the files that it finds in its folder.

    Attributes:
        seconds, memory: how much processor time and how many bytes it may take, by its options; None where that is not
            looked at.
    """

    arguments: tuple[str, ...]
    files: Mapping[str, bytes]
    standard_input: bytes = b""
    seconds: float | None = None
    memory: int | None = None


@dataclass(frozen=True, slots=True)
class Usage:
    """What a command took: seconds of processor time, and bytes at most beyond those that were there before it."""

    seconds: float = 0.0
    memory: int = 0


@dataclass(frozen=True, slots=True)
class Finding:
    """A command that did not end as it should. ``what`` is a line; ``said`` what it wrote to standard error."""

    case: Case
    what: str
    said: str


def prepare(warming: Iterable[Case] = ()) -> None:
    """Imports what commands import late, and runs some sound cases, so that no child has to do what comes first.

    The cases must start no thread, which no child would have.
    """
    for name in main.COMMANDS:
        main.load_command(name)
    for name in (
        *_HEAVY,
        *_imported_late(),
        "tachk.api.model",
        "tachk.cli.monitor_online",
        "tachk.recordings.monitors",
    ):
        try:
            import_module(name)
        except ImportError:
            continue
    for case in warming:
        with tempfile.TemporaryDirectory() as name, contextlib.chdir(name), contextlib.suppress(SystemExit):
            for file, content in case.files.items():
                Path(file).write_bytes(content)
            with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                sys.argv = ["tachk", *case.arguments]
                main.run()
    gc.collect()
    gc.freeze()


def _imported_late() -> set[str]:
    """The modules that functions of commands import."""
    sources = Path(commands.__path__[0]).glob("*.py")
    nodes = (node for source in sources for node in ast.walk(ast.parse(source.read_text())))
    return {node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module is not None}


def run(case: Case) -> Finding | None:
    """What is wrong with how a command ends, if anything is."""
    with tempfile.TemporaryDirectory(prefix="fuzz-") as name:
        folder = Path(name)
        child = os.fork()
        if child == 0:
            _child([case], folder)
        _, status = os.waitpid(child, 0)
        return _judged(case, folder / "0", status)


def run_all(cases: Sequence[Case]) -> list[Finding | None]:
    """The same for several cases, one after the other in one child; what seems wrong is tried again alone."""
    found: list[Finding | None] = []
    while len(found) < len(cases):
        rest = cases[len(found) :]
        with tempfile.TemporaryDirectory(prefix="fuzz-") as name:
            folder = Path(name)
            child = os.fork()
            if child == 0:
                _child(rest, folder)
            _, status = os.waitpid(child, 0)
            for number, case in enumerate(rest):
                is_over = (folder / str(number) / ".usage").exists()
                code = status if not is_over else int((folder / str(number) / ".status").read_text()) << 8
                found.append(run(case) if _judged(case, folder / str(number), code) is not None else None)
                if not is_over:
                    break
    return found


def results(
    written: Callable[[], Sequence[bytes]], commands: Sequence[tuple[str, ...]], beside: Mapping[str, bytes], file: str
) -> list[bytes]:
    """What a function returns, and what commands write into a file, in another process."""
    with tempfile.TemporaryDirectory(prefix="fuzz-") as name:
        folder = Path(name)
        child = os.fork()
        if child == 0:
            found = list(written())
            for number, command in enumerate(commands):
                here = folder / str(number)
                here.mkdir()
                _in_folder(Case(command, beside), here)
                found += [(here / file).read_bytes()] if (here / file).exists() else []
            (folder / "found").write_bytes(pickle.dumps(found))
            os._exit(0)
        os.waitpid(child, 0)
        return list(pickle.loads((folder / "found").read_bytes()))


def _judged(case: Case, folder: Path, status: int) -> Finding | None:
    said = (folder / ".stderr").read_bytes().decode(errors="replace") if (folder / ".stderr").exists() else ""
    usage = folder / ".usage"
    what = wrong(status, said)
    if what is None and usage.exists():
        seconds, memory = usage.read_text().split()
        what = beyond(case, Usage(float(seconds), int(memory)))
    return None if what is None else Finding(case, what, said)


def wrong(status: int, said: str) -> str | None:
    """What is wrong with a status as `os.wait` gives it, and what was written to standard error."""
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        if number in (signal.SIGXCPU, signal.SIGKILL):
            return f"no end after {CPU_SECONDS} s of processor time"
        if number == signal.SIGALRM:
            return f"no end after {WAITING_SECONDS} s"
        return f"died of {signal.Signals(number).name}"
    code = os.WEXITSTATUS(status)
    if code not in STATUSES:
        return f"status {code}: {_cause(said)}"
    if "Traceback (most recent call last)" in said:
        return f"a traceback: {_cause(said)}"
    warned = _WARNING.search(said)
    return None if warned is None else f"a warning of Python: {warned[0]}"


def beyond(case: Case, usage: Usage) -> str | None:
    """What a command took more of than it may, if there is anything. Processor time is never more than the time that
    has passed, which is what commands limit."""
    if case.seconds is not None and usage.seconds > TOLERATED * case.seconds:
        return f"{usage.seconds:.1f} s of processor time, allowed were {case.seconds:g} s"
    if case.memory is not None and usage.memory > TOLERATED * case.memory:
        return f"{usage.memory >> 20} MiB, allowed were {case.memory >> 20} MiB"
    return None


def _cause(said: str) -> str:
    """The last place and the error of a traceback, or what was said last."""
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    places = [n for n, line in enumerate(lines) if line.startswith("File ")]
    if not places:
        return lines[-1] if lines else "nothing was said"
    error = next((line for line in lines[places[-1] + 1 :] if "Error" in line or "Exception" in line), lines[-1])
    return f"{error[:200]} at {lines[places[-1]]}"


def _child(cases: Sequence[Case], folder: Path) -> NoReturn:
    """Runs commands in this process, one after the other, and ends the process with the status of the last."""
    code = 99
    try:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
        resource.setrlimit(resource.RLIMIT_FSIZE, (FILE_BYTES, FILE_BYTES))
        for number, case in enumerate(cases):
            limit = int(_seconds()) + CPU_SECONDS
            resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))
            signal.alarm(WAITING_SECONDS)
            here = folder / str(number)
            here.mkdir()
            before, at_first = _seconds(), _memory_from_here()
            code = _in_folder(case, here)
            (here / ".status").write_text(str(code))
            (here / ".usage").write_text(f"{_seconds() - before} {_peak() - at_first}")
    finally:
        os._exit(code & 255)


def _seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def _memory_from_here() -> int:
    """Lets `_peak` count from here on, where the system can do that, and tells how many bytes there are now."""
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    return _peak()


def _peak() -> int:
    """The bytes that this process had at most since `_memory_from_here`."""
    found = peak_memory()
    return 0 if found is None else found[1] << 10


def _in_folder(case: Case, folder: Path) -> int:
    for name, content in case.files.items():
        (folder / name).write_bytes(content)
    (folder / ".stdin").write_bytes(case.standard_input)
    os.chdir(folder)
    for number, name, flags in (
        (0, ".stdin", os.O_RDONLY),
        (1, ".stdout", os.O_WRONLY | os.O_CREAT),
        (2, ".stderr", os.O_WRONLY | os.O_CREAT),
    ):
        opened = os.open(name, flags, 0o600)
        os.dup2(opened, number)
        os.close(opened)
    sys.stdin = os.fdopen(0, encoding="utf-8", closefd=False)
    sys.stdout = os.fdopen(1, "w", encoding="utf-8", closefd=False)
    sys.stderr = os.fdopen(2, "w", encoding="utf-8", closefd=False)
    faulthandler.enable(sys.stderr)
    faulthandler.register(signal.SIGXCPU, sys.stderr, chain=True)
    sys.argv = ["tachk", *case.arguments]
    warnings.simplefilter("always")
    for kind in (DeprecationWarning, PendingDeprecationWarning, ImportWarning, ResourceWarning):
        warnings.simplefilter("ignore", kind)
    code = 0
    try:
        main.run()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        traceback.print_exc()
        code = 99
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    return code & 255
