"""A copy of the sources in which mutants are tried, with builds of its own."""

from __future__ import annotations

import os
import py_compile
import re
import resource
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from importlib.util import cache_from_source
from pathlib import Path

CPU_SECONDS = 60
_QUICKLY_BUILT = (
    "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1",
    "-DTACHK_WERROR=OFF",  # what a mutant leaves unused is not a mistake
)
MEMORY_BYTES = 6 * 2**30
WALL_SECONDS = 1800


class OutOfTimeError(Exception):
    """A test did not come to its end."""


class WorkspaceError(Exception):
    """The sources cannot be built, tests do not see them, or a test does not exist."""


class Workspace:
    """The copy in ``folder``; the checkout in ``root`` is only read.

    Raises WorkspaceError where tests would not see the copy.
    """

    def __init__(self, root: Path, folder: Path) -> None:
        self.root, self.folder = root, folder
        self._stale = {"core", "dev"}
        self._synchronise()
        self._find_the_copy()

    @contextmanager
    def changed(self, file: str, text: str) -> Iterator[None]:
        """The copy with another text of one file."""
        path = self.folder / file
        original = path.read_bytes()
        if path.suffix == ".py":
            Path(cache_from_source(str(path))).unlink(missing_ok=True)  # it may have the same size and second
        path.write_text(text, encoding="utf-8")
        self._touch(file)
        try:
            yield
        finally:
            path.write_bytes(original)
            self._touch(file)
            if path.suffix == ".py":
                py_compile.compile(str(path))

    def programs(self, names: Sequence[str]) -> list[str]:
        """Runs C++ test programs up to the first that fails, whose name is returned.

        Raises:
            WorkspaceError: they cannot be built.
            OutOfTimeError: one of them takes too long.
        """
        self._build("core", names)
        for name in names:
            if self._call([str(self.folder / "build" / "core" / name)], {})[0] != 0:
                return [name]
        return []

    def pytest(self, paths: Sequence[str], ignored: Iterable[str] = (), *, to_the_end: bool = False) -> list[str]:
        """Runs Python tests up to the first failure, or to the end; the names of those that fail.

        Raises:
            WorkspaceError: the extension cannot be built, or a test does not exist.
            OutOfTimeError: they take too long.
        """
        self._build("dev")
        options = ["-q", "-p", "no:cacheprovider", "--tb=no", *(f"--deselect={name}" for name in ignored)]
        command = [sys.executable, "-m", "pytest", *options, *([] if to_the_end else ["-x"]), *paths]
        status, out = self._call(command, {"PYTHONPATH": str(self.folder / "src")})
        if status == 0:
            return []
        failures = re.findall(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", out, re.MULTILINE)
        if status == 5 or (status == 4 and not failures):
            raise WorkspaceError(f"pytest cannot run {' '.join(paths)}\n{out[-2000:]}")
        # " - " may be part of a parameter.
        names = [name if name.endswith("]") else name.split("[")[0] for name in failures]
        return names or [paths[0].split("::")[0]]

    def _synchronise(self) -> None:
        listed = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            cwd=self.root,
            check=True,
            capture_output=True,
        )
        wanted = {name for name in listed.stdout.decode().split("\0") if name and (self.root / name).is_file()}
        for name in wanted:
            source, copy = self.root / name, self.folder / name
            if not copy.is_file() or copy.read_bytes() != source.read_bytes():
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, copy)
        for top in ("src", "plugins", "tests", "models", "docs"):
            for path in [*(self.folder / top).rglob("*")]:
                name = path.relative_to(self.folder).as_posix()
                kept = name in wanted or path.suffix in (".pyc", ".so") or ".cache" in name
                if path.is_file() and not kept:
                    path.unlink()

    def _find_the_copy(self) -> None:
        """An editable installation comes before PYTHONPATH."""
        find = "from importlib.util import find_spec; print(find_spec('tachk').origin)"
        _, found = self._call([sys.executable, "-c", find], {"PYTHONPATH": str(self.folder / "src")})
        if not Path(found).is_relative_to(self.folder):
            raise WorkspaceError(
                f"Python finds tachk in {found.strip()}, not in {self.folder}. "
                "Use an environment in which tachk is not installed in editable form."
            )

    def _touch(self, file: str) -> None:
        if not file.endswith(".py"):
            self._stale = {"core", "dev"}

    def _build(self, preset: str, targets: Sequence[str] = ()) -> None:
        if preset not in self._stale and not targets:
            return
        build = self.folder / "build" / preset
        if not (build / "build.ninja").is_file():
            self._built(["cmake", "--preset", preset, *(_QUICKLY_BUILT if preset == "core" else ())])
        self._built(["cmake", "--build", str(build), *(["--target", *targets] if targets else [])])
        if not targets:
            self._stale.discard(preset)

    def _built(self, command: list[str]) -> None:
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
        if done.returncode != 0:
            raise WorkspaceError(f"{' '.join(command)}\n{done.stdout[-3000:]}{done.stderr[-2000:]}")

    def _call(self, command: list[str], environment: dict[str, str]) -> tuple[int, str]:
        given = {**os.environ, **environment, "PYTHONDONTWRITEBYTECODE": "1"}
        try:
            done = subprocess.run(
                command,
                cwd=self.folder,
                env=given,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                timeout=WALL_SECONDS,
                preexec_fn=_limit,
            )
        except subprocess.TimeoutExpired:
            raise OutOfTimeError from None
        if done.returncode in (-24, -9):  # SIGXCPU, SIGKILL
            raise OutOfTimeError
        return done.returncode, done.stdout.decode(errors="replace")


def _limit() -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS + 5))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
