"""The limit on the combinations of values that the select labels of one edge have."""

from __future__ import annotations

from math import prod

from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.model.network import Network
from tachk.model.types import bounds

MAXIMAL_SELECTIONS = 10_000_000
"""Combinations of the values of one edge's select labels; each is tried against the guard."""


def check_selections(network: Network) -> None:
    """Raises UnsupportedError where the select labels of an edge have too many combinations of values to try."""
    for process in network.processes:
        for edge in process.edges:
            sizes = [high - low + 1 for low, high in (bounds(variable.type) for variable in edge.selects)]  # type: ignore[arg-type]
            if prod(sizes) > MAXIMAL_SELECTIONS:
                raise UnsupportedError(
                    Diagnostic(
                        "E0708",
                        f"the select labels of this edge have {prod(sizes)} combinations of values",
                        edge.spans[0],
                        "select from smaller ranges, or replace a select by a variable that is set step by step",
                    )
                )
