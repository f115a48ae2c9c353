"""The one place that finds the data files: grammar/, templates/, models/, queries/, docs/schema/, docs/skills/.

In a checkout they lie beside ``src/``; in an installed wheel in ``tachk/_data``.
"""

from __future__ import annotations

import os
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


@cache
def data_root() -> Path:
    """The folder that holds grammar/ and its siblings."""
    from pathlib import Path  # takes longer than all that a start reads here

    return Path(_root())


@cache
def _root() -> str:
    package = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
    checkout = os.path.dirname(os.path.dirname(package))
    if os.path.isfile(os.path.join(checkout, "pyproject.toml")) and os.path.isdir(os.path.join(checkout, "grammar")):
        return checkout
    return os.path.join(package, "_data")


def grammar_text(name: str) -> str:
    """The text of ``grammar/NAME.lark``."""
    with open(os.path.join(_root(), "grammar", f"{name}.lark"), encoding="utf-8") as file:
        return file.read()


def template_text(name: str) -> str:
    """The text of ``templates/NAME``."""
    return (data_root() / "templates" / name).read_text(encoding="utf-8")


def schema_text(report: str) -> str:
    """The text of ``docs/schema/REPORT.schema.json``."""
    return (data_root() / "docs" / "schema" / f"{report}.schema.json").read_text(encoding="utf-8")
