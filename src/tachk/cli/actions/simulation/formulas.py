"""The formulas of ``--monitor``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from tachk.monitoring.formulas import NamedFormula, read_formulas


def formulas_for(given: str | None, definitions: Mapping[str, str]) -> tuple[NamedFormula, ...]:
    """A formula, a sentence, or those of a file; the constants count for files that may use them."""
    if given is None:
        return ()
    return read_formulas(given, dict(definitions) if Path(given).suffix in (".ta", ".xta", ".xml", ".stl") else {})
