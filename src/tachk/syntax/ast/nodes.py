"""The base of all nodes of the tree."""

from __future__ import annotations

from tachk.base.records import dataclass, field
from tachk.base.span import Span


@dataclass(frozen=True, slots=True)
class Node:
    """Every node has a place; equality ignores it, so trees of differently laid out texts compare equal."""

    span: Span = field(compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Identifier(Node):
    name: str
