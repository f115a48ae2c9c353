"""The names of Python that pages of the documentation use are those that docs/stability.md promises."""

from __future__ import annotations

import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

import pytest

import tachk
from docs.site_build.python_names import promised_names

ROOT = Path(__file__).parents[2]
STABILITY = ROOT / "docs/stability.md"

if not STABILITY.is_file():
    pytest.skip("needs a checkout", allow_module_level=True)

PAGES = [
    page
    for page in sorted((ROOT / "docs").rglob("*.md"))
    if page.name != "history.md" and "decisions" not in page.parts and "paper" not in page.parts
]
IMPORT = re.compile(r"^(?:>>> )?from (tachk[\w.]*) import (.*)$", re.MULTILINE)
NO_NAMES = {"__all__", "toml", "command", "textconv"}
"""Behind the name of the package in files of other programs: pyproject.toml, settings of git."""
USE = re.compile(r"\btachk\.(\w+)\b(?![\w.]*\.(?:ta|svg|md|py))")


def promised() -> dict[str, tuple[str, ...]]:
    return promised_names(text(STABILITY))


def text(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def imported() -> Iterator[tuple[str, str, str]]:
    for page in PAGES:
        for module, names in IMPORT.findall(text(page)):
            yield from ((page.name, module, name.strip()) for name in names.split(","))


def test_the_promised_names_are_there() -> None:
    table = promised()
    assert len(table) >= 10
    missing = [
        f"{module}.{name}"
        for module, names in table.items()
        for name in names
        if not hasattr(import_module(module), name)
    ]
    assert missing == []
    assert all(hasattr(tachk, name) for name in tachk.__all__)


def test_pages_import_nothing_else() -> None:
    table = promised()
    found = list(imported())
    assert len(found) >= 4
    assert [each for each in found if each[2] not in table.get(each[1], ())] == []


def test_pages_use_no_other_name_of_the_package() -> None:
    modules = {path.name.removesuffix(".py") for path in (ROOT / "src/tachk").iterdir()}
    used = {name: page.name for page in PAGES for name in USE.findall(text(page))}
    assert len(used.keys() & set(tachk.__all__)) >= 20
    assert {name: page for name, page in used.items() if name not in {*tachk.__all__, *modules, *NO_NAMES}} == {}


def test_no_public_name_lacks_a_page() -> None:
    shown = {name for page in PAGES for name in re.findall(r"\w+", text(page))}
    assert set(tachk.__all__) - shown == set()
