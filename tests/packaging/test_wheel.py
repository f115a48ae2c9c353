"""What an installed tachk consists of; skipped where the tests run against the checkout itself."""

from __future__ import annotations

from importlib import metadata, util
from pathlib import Path

import pytest

import tachk
from tachk.base import resources

CHECKOUT = Path(__file__).parents[2]
DATA_FOLDERS = ("grammar", "templates", "models", "queries", "docs/schema", "docs/skills")
DATA_SUFFIXES = {".lark", ".j2", ".css", ".js", ".ta", ".xta", ".xml", ".q", ".stl", ".md", ".json"}
LIBRARIES = (".so", ".dylib", ".pyd")
PACKAGE = Path(tachk.__file__).parent

installed_only = pytest.mark.skipif(PACKAGE.is_relative_to(CHECKOUT / "src"), reason="tachk is not installed")


def files_below(folder: Path) -> set[str]:
    return {
        str(path.relative_to(folder))
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


@installed_only
def test_package_holds_the_sources_the_libraries_and_nothing_else() -> None:
    installed = {name for name in files_below(PACKAGE) if not name.startswith("_data/")}
    built = {name for name in installed if name.endswith(LIBRARIES)}
    assert sorted(name.split(".")[0] for name in built) == ["_core", "libtachk_unit"]
    in_checkout = {name for name in files_below(CHECKOUT / "src/tachk") if not name.endswith(LIBRARIES)}
    assert installed - built == in_checkout


@installed_only
def test_data_files_are_complete() -> None:
    root = resources.data_root()
    assert root == PACKAGE / "_data"
    expected = {
        f"{folder}/{name}"
        for folder in DATA_FOLDERS
        for name in files_below(CHECKOUT / folder)
        if Path(name).suffix in DATA_SUFFIXES
    }
    assert files_below(root) == expected


@installed_only
def test_distribution_adds_only_the_package() -> None:
    files = metadata.files("tachk")
    assert files is not None
    tops = {path.parts[0] for path in files if path.parts[0] != ".."}
    assert tops == {"tachk", f"tachk-{tachk.__version__}.dist-info"}


@installed_only
def test_version_is_the_one_of_the_distribution() -> None:
    assert metadata.version("tachk") == tachk.__version__


@installed_only
def test_pytest_finds_the_plugin() -> None:
    (entry,) = metadata.distribution("tachk").entry_points.select(group="pytest11")
    assert entry.name == "tachk"
    assert hasattr(entry.load(), "pytest_collect_file")


def test_every_data_file_of_the_checkout_would_be_installed() -> None:
    odd = {
        f"{folder}/{name}"
        for folder in DATA_FOLDERS
        for name in files_below(CHECKOUT / folder)
        if Path(name).suffix not in DATA_SUFFIXES
    }
    assert odd == set()


def test_type_information_is_shipped() -> None:
    assert (PACKAGE / "py.typed").is_file()
    assert (PACKAGE / "_core.pyi").is_file()
    assert util.find_spec("tachk._core") is not None
