"""The one place that finds the data files: grammar/, templates/, models/, queries/, docs/schema/, docs/skills/.

In a checkout they lie beside ``src/``; in an installed wheel in ``tachk/_data``.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path


@cache
def data_root() -> Path:
    """The folder that holds grammar/ and its siblings."""
    checkout = Path(__file__).resolve().parents[3]
    if (checkout / "pyproject.toml").is_file() and (checkout / "grammar").is_dir():
        return checkout
    return Path(__file__).resolve().parents[1] / "_data"


def grammar_text(name: str) -> str:
    """The text of ``grammar/NAME.lark``."""
    return (data_root() / "grammar" / f"{name}.lark").read_text(encoding="utf-8")


def template_text(name: str) -> str:
    """The text of ``templates/NAME``."""
    return (data_root() / "templates" / name).read_text(encoding="utf-8")


def schema_text(report: str) -> str:
    """The text of ``docs/schema/REPORT.schema.json``."""
    return (data_root() / "docs" / "schema" / f"{report}.schema.json").read_text(encoding="utf-8")
