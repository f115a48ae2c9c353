"""Scenarios that are written by a command, and not by a person."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path


def scenario_name(file: Path) -> str:
    """A name for the scenario in a file."""
    name = re.sub(r"\W", "_", file.stem)
    return f"run_{name}" if name[:1].isdigit() else name


def scenario_text(name: str, clauses: Iterable[str]) -> str:
    """A scenario with these clauses, each without its semicolon."""
    return "".join([f"scenario {name} {{\n", *(f"    {clause};\n" for clause in clauses), "}\n"])
