"""The folders of src/core: small, built and tested as a whole, and each above those it uses."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CORE, TESTS = ROOT / "src" / "core", ROOT / "tests" / "core"

FLOORS = (
    "zones",
    "program",
    "machine",
    "certificates",
    "runs",
    "flow",
    "simulation",
    "fmi",
    "states",
    "symbolic",
    "stubborn",
    "order",
    "reachability",
    "estimation",
    "localtime",
    "liveness",
)
"""From the lowest up."""

OF_TRACES = {"csv": ("decimals",), "json_lines": ("csv", "decimals"), "monitoring": ("decimals",)}
"""What the folders that know no network use."""
OF_BOTH = {"monitored": ("flow", "simulation", "monitoring")}
"""What a folder uses that joins networks and traces."""

if not CORE.is_dir():
    pytest.skip("needs a checkout", allow_module_level=True)

SOURCES = sorted(path.relative_to(CORE).as_posix() for path in CORE.rglob("*.?pp"))


def included(source: str) -> list[str]:
    return re.findall(r'^#include "(.+)"', (CORE / source).read_text(encoding="utf-8"), re.MULTILINE)


def test_the_checker_of_certificates_shares_only_what_a_program_means_with_the_engine() -> None:
    used = {header for source in SOURCES if source.startswith("certificates/") for header in included(source)}
    shared = {header for header in used if not header.startswith("certificates/")}
    assert shared == {"machine/machine.hpp", "program/program.hpp", "zones/bound.hpp"}


def test_the_judge_of_runs_does_not_know_what_gives_them_their_times() -> None:
    used = {
        header
        for part in ("judge", "concrete_semantics")
        for end in "hc"
        for header in included(f"runs/{part}.{end}pp")
    }
    assert {header for header in used if not header.startswith("runs/")} == {
        "machine/machine.hpp",
        "program/program.hpp",
    }
    assert "runs/schedule.hpp" not in included("runs/judge.cpp")


def test_no_source_stands_outside_of_a_folder() -> None:
    assert Path(".") not in [Path(source).parent for source in SOURCES]


def test_every_source_is_built() -> None:
    borders = (CORE / "bind", CORE / "fmi" / "library")
    for folder in (CORE, *borders):
        listed = set(
            re.findall(r"^  (\S+\.cpp)\)?$", (folder / "CMakeLists.txt").read_text(encoding="utf-8"), re.MULTILINE)
        )
        there = {path for path in folder.rglob("*.cpp") if folder in borders or not {*path.parents} & {*borders}}
        assert listed == {path.relative_to(folder).as_posix() for path in there}


def test_every_test_is_run_and_stands_in_the_folder_that_it_tests() -> None:
    text = (TESTS / "CMakeLists.txt").read_text(encoding="utf-8")
    there = {path.relative_to(TESTS).as_posix() for path in TESTS.rglob("*.cpp")}
    assert set(re.findall(r"^tachk_test\((\S+)\)", text, re.MULTILINE)) == there
    assert {str(Path(test).parent) for test in there} <= {str(Path(source).parent) for source in SOURCES}


@pytest.mark.parametrize("source", [source for source in SOURCES if not source.startswith("bind/")])
def test_a_source_uses_only_its_own_folder_and_those_below(source: str) -> None:
    folder = source.split("/")[0]
    below = FLOORS[: FLOORS.index(folder)] if folder in FLOORS else (OF_TRACES | OF_BOTH).get(folder, ())
    assert {header.split("/")[0] for header in included(source)} <= {folder, *below}
    assert "Python.h" not in (CORE / source).read_text(encoding="utf-8")
