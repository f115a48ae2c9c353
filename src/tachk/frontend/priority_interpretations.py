"""Channel priorities without `default`.

UPPAAL's manual gives internal edges and all channels that are not listed the priority `default`, and does not say where
that is if the declaration does not. It may be below all groups, as high as one of them, between two of them, or above
all: each place is an interpretation of the model, and what all interpretations agree in holds whichever is meant.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.base.records import dataclass, replace
from tachk.base.span import Span
from tachk.syntax import ast

FIRST = "below all others"
"""The interpretation that is taken where only one can be: what is not listed comes last."""


@dataclass(frozen=True, slots=True)
class PriorityInterpretation:
    """Attributes:
    place: where it has `default`, in words.
    items: of the model, with `default` in that place.
    """

    place: str
    items: tuple[ast.Item, ...]


def other_interpretations(items: Sequence[ast.Item]) -> Iterator[PriorityInterpretation]:
    """All interpretations but `FIRST`, lowest place first; none where the declaration has a `default` of its own."""
    nodes = [item for item in items if isinstance(item, ast.ChannelPriorityDeclaration)]
    if len(nodes) != 1 or says_default(nodes[0]):
        return
    node = nodes[0]
    for place, groups in _places(node.groups, ast.NameExpression(Span(node.span.source, *_end(node)), "default")):
        placed = replace(node, groups=groups)
        yield PriorityInterpretation(place, tuple(placed if item is node else item for item in items))


def says_default(node: ast.ChannelPriorityDeclaration) -> bool:
    """True if the declaration has `default` among its channels."""
    return any(isinstance(c, ast.NameExpression) and c.name == "default" for group in node.groups for c in group)


def _end(node: ast.ChannelPriorityDeclaration) -> tuple[int, int]:
    return node.span.end, node.span.end


_Groups = tuple[tuple[ast.Expression, ...], ...]


def _places(groups: _Groups, default: ast.Expression) -> Iterator[tuple[str, _Groups]]:
    from tachk.syntax.printing.expression_printer import print_expressions

    for at, group in enumerate(groups):
        name = print_expressions(group)
        yield f"as high as {name}", (*groups[:at], (*group, default), *groups[at + 1 :])
        above = (
            f"between {name} and {print_expressions(groups[at + 1])}" if at + 1 < len(groups) else "above all others"
        )
        yield above, (*groups[: at + 1], (default,), *groups[at + 1 :])
