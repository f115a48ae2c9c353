"""The labels of the edges of a network as UPPAAL's traces show them."""

from __future__ import annotations

from dataclasses import dataclass

from tachk.formats.network_text import expression_text
from tachk.model.expressions import Assign, Expression
from tachk.model.network import Edge, Network, Process

INTERNAL = "tau"
ALWAYS = "1"
"""The placeholders for a missing guard and missing updates."""


@dataclass(frozen=True, slots=True)
class EdgeText:
    """Attributes:
    synchronisation: ``c!``, ``c?`` or ``tau``.
    updates: separated by commas.
    """

    guard: str
    synchronisation: str
    updates: str


def edge_text(network: Network, process: Process, edge: Edge, becomes: str) -> EdgeText:
    """The labels of an edge, one line each. Variables of the process are written without its name.

    Args:
        becomes: the sign of assignments, ``:=`` in UPPAAL's traces as text and ``=`` in the other forms.
    """

    def text(expression: Expression) -> str:
        return " ".join(expression_text(expression, network, process.name).split())

    def update(expression: Expression) -> str:
        if isinstance(expression, Assign) and expression.operator is None:
            return f"{text(expression.target)} {becomes} {text(expression.value)}"
        return text(expression)

    synchronisation = INTERNAL
    if edge.synchronisation is not None:
        synchronisation = text(edge.synchronisation.channel) + edge.synchronisation.direction.value
    return EdgeText(
        ALWAYS if edge.guard is None else text(edge.guard),
        synchronisation,
        ", ".join(map(update, edge.updates)) or ALWAYS,
    )
