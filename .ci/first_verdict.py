"""From a wheel to a first verdict in an empty environment, with no compiler to be found: CPU time and size.

    python .ci/first_verdict.py dist/tachk-*.whl
    python .ci/first_verdict.py dist/tachk-*.whl --installer pip --most-seconds 60

Packages are fetched first, so that the figures are those of installing and checking. The exit status is 1 where the
environment is larger than --most-megabytes, the CPU time of all steps more than --most-seconds, or the verdict is not
the expected one.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

COMPILERS = ("cc", "gcc", "c++", "g++", "clang", "clang++", "cmake", "ninja", "make")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("wheel", type=Path)
    parser.add_argument("--installer", choices=("uv", "pip"), default="uv")
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("--most-megabytes", type=float, default=200)
    parser.add_argument("--most-seconds", type=float, help="of CPU; without it they are printed only")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        steps, size, answer = _tried(Path(folder), options.wheel.resolve(), options.installer, options.python)
    seconds = sum(steps.values())
    for name, used in steps.items():
        print(f"{name:24}{used:7.2f} s of CPU")
    print(f"{'from wheel to verdict':24}{seconds:7.2f} s of CPU with {options.installer}")
    print(f"{'environment':24}{size / 1e6:7.1f} MB")
    print(f"{'verdict':24}{answer:>7}")
    late = options.most_seconds is not None and seconds > options.most_seconds
    sys.exit(int(answer != "fails" or size > options.most_megabytes * 1e6 or late))


def _tried(folder: Path, wheel: Path, installer: str, python: str) -> tuple[dict[str, float], int, str]:
    """The CPU seconds of the steps, the bytes of the environment, the answer about Fischer's protocol."""
    environment = folder / "environment"
    tools = _without_compilers(folder)
    if installer == "uv":
        uv = [sys.executable, "-m", "uv", "--quiet"]
        make = [*uv, "venv", "--python", python, str(environment)]
        install = [*uv, "pip", "install", "--python", str(environment), str(wheel)]
    else:
        make = [python, "-m", "venv", str(environment)]
        install = [str(environment / "bin/pip"), "install", "--quiet", str(wheel)]
    steps = {}
    for _ in range(2):  # the first time fills the cache
        shutil.rmtree(environment, ignore_errors=True)
        steps = {"environment made": _cpu_of(make, folder, tools), "installed": _cpu_of(install, folder, tools)}
    size = sum(path.lstat().st_size for path in environment.rglob("*") if path.is_file() and not path.is_symlink())
    tachk = str(environment / "bin/tachk")
    steps["tachk models copy"] = _cpu_of([tachk, "models", "copy", "fischer"], folder, tools)
    verify = [tachk, "verify", "fischer.ta", "-D", "WAIT=9", "--format", "json", "-o", "verify.json"]
    steps["tachk verify"] = _cpu_of(verify, folder, tools)
    document = json.loads((folder / "verify.json").read_text(encoding="utf-8"))
    (found,) = [row for row in document["runs"][0]["results"] if row["name"] == "mutual_exclusion"]
    return steps, size, found["answer"]


def _without_compilers(folder: Path) -> dict[str, str]:
    """The environment variables of a user without a compiler."""
    empty = folder / "bin"
    empty.mkdir()
    found = {name: path for name in COMPILERS if (path := shutil.which(name, path=str(empty)))}
    assert not found
    kept = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV", "CC", "CXX")}
    return {**kept, "PATH": str(empty)}


def _cpu_of(command: Sequence[str], folder: Path, variables: dict[str, str]) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, cwd=folder, env=variables, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


if __name__ == "__main__":
    main()
