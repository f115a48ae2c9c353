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
from dataclasses import dataclass
from importlib.util import cache_from_source
from pathlib import Path

CPU_SECONDS = 60
_QUICKLY_BUILT = (
    "-DCMAKE_CXX_FLAGS_RELWITHDEBINFO=-O1",
    "-DTACHK_WERROR=OFF",  # what a mutant leaves unused is no mistake
)
MEMORY_BYTES = 6 * 2**30
WALL_SECONDS = 1800


@dataclass(frozen=True, slots=True)
class Run:
    """How some tests ended.

    Attributes:
        failed: what the first test that failed says; None if all passed.
        test: which one it is: a test program, or a name for pytest.
        timeout: it did not come to its end.
    """

    failed: str | None = None
    test: str = ""
    timeout: bool = False


class WorkspaceError(Exception):
    """The sources cannot be built, or a test does not exist."""


class Workspace:
    """The copy in ``folder``; the checkout in ``root`` is only read."""

    def __init__(self, root: Path, folder: Path) -> None:
        self.root, self.folder = root, folder
        self._stale = {"core", "dev"}
        self._synchronise()

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

    def programs(self, names: Sequence[str]) -> Run:
        """Runs C++ test programs.

        Raises:
            WorkspaceError: they cannot be built.
        """
        self._build("core", names)
        for name in names:
            status, out = self._call([str(self.folder / "build" / "core" / name)], {})
            if status != 0:
                lines = [line.strip() for line in out.splitlines() if line.strip()]
                said = lines[-1].replace(f"{self.folder}/", "") if lines else status
                return Run(f"{name}: {said}", name, _is_timeout(status))
        return Run()

    def pytest(self, paths: Sequence[str], ignored: Iterable[str] = ()) -> Run:
        """Runs Python tests up to the first failure.

        Raises:
            WorkspaceError: the extension cannot be built, or a test does not exist.
        """
        self._build("dev")
        deselected = [f"--deselect={name}" for name in ignored]
        command = [sys.executable, "-m", "pytest", "-qx", "-p", "no:cacheprovider", "--tb=no", *deselected, *paths]
        status, out = self._call(command, {"PYTHONPATH": str(self.folder / "src")})
        if status == 0:
            return Run()
        if _is_timeout(status):
            return Run("the limit of time", "", True)
        failure = re.search(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", out, re.MULTILINE)
        if status == 5 or (status == 4 and failure is None):
            raise WorkspaceError(f"pytest cannot run {' '.join(paths)}\n{out[-2000:]}")
        if failure is not None:
            name = failure[1]
            return Run(name, name if name.endswith("]") else name.split("[")[0])  # " - " may be part of a parameter
        return Run(f"pytest ended with status {status}", paths[0].split("::")[0])

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
        for top in ("src", "tests", "models", "docs"):
            for path in [*(self.folder / top).rglob("*")]:
                name = path.relative_to(self.folder).as_posix()
                kept = name in wanted or path.suffix in (".pyc", ".so") or ".cache" in name
                if path.is_file() and not kept:
                    path.unlink()

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
            return -24, ""
        return done.returncode, done.stdout.decode(errors="replace")


def _limit() -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS + 5))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))


def _is_timeout(status: int) -> bool:
    return status in (-24, -9)
