"""`tachk export --format munta`."""

from __future__ import annotations

from collections.abc import Sequence

from tachk.base.words import QueryKind
from tachk.formats.munta.writer import to_munta
from tachk.model.expressions import BOOL, Constant
from tachk.model.network import Network
from tachk.model.query import Query


def to_muntax(network: Network, queries: Sequence[Query]) -> str:
    """The content of a .muntax file, with the question of the first query that a reachable state decides.

    Munta's files have one formula. Without such a query it asks for what never is. Temporal formulas are left out:
    their observers have urgent channels.

    Raises UnsupportedError: E0803, with the place of what Munta cannot say.
    """
    asked = (query for query in queries if query.target is not None and query.observer is None)
    query = next(asked, Query("", QueryKind.POSSIBLY, Constant(0, BOOL)))
    return to_munta(network, query).network.text()
