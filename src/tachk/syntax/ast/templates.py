"""Templates: locations, branchpoints and edges."""

from __future__ import annotations

from tachk.base.records import dataclass
from tachk.base.words import Direction
from tachk.syntax.ast.declarations import Declaration
from tachk.syntax.ast.expressions import Expression, Parameter, TypeExpression
from tachk.syntax.ast.nodes import Identifier, Node


@dataclass(frozen=True, slots=True)
class SelectBinding(Node):
    """``i : int[0,3]``."""

    name: Identifier
    type: TypeExpression


@dataclass(frozen=True, slots=True)
class SynchronisationLabel(Node):
    """``c!``, ``c[i]?``, or with a value ``c!e`` / ``c?x``; ``direction`` is None in CSP style."""

    channel: Expression
    direction: Direction | None
    value: Expression | None = None


@dataclass(frozen=True, slots=True)
class EdgeDeclaration(Node):
    """``source`` and ``target`` name locations or branchpoints. A conjunction written with commas (UPPAAL 3.x) is read
    as ``&&``. ``source`` is None inside a location block, where the location is the source."""

    source: Identifier | None
    target: Identifier
    selects: tuple[SelectBinding, ...] = ()
    guard: Expression | None = None
    synchronisation: SynchronisationLabel | None = None
    updates: tuple[Expression, ...] = ()
    probability: Expression | None = None
    controllable: bool = True
    doc: str = ""


@dataclass(frozen=True, slots=True)
class LocationDeclaration(Node):
    """``edges`` is empty in the classic form. ``initial``, ``urgent`` and ``committed`` are merged from the ``init``,
    ``urgent`` and ``commit`` lines of the classic form. The rate of the exponential distribution, which only
    statistical checking looks at, is ``exponential_rate`` divided by ``rate_divisor``, written ``rate : divisor``."""

    name: Identifier
    invariant: Expression | None = None
    exponential_rate: Expression | None = None
    initial: bool = False
    urgent: bool = False
    committed: bool = False
    edges: tuple[EdgeDeclaration, ...] = ()
    doc: str = ""
    rate_divisor: Expression | None = None


@dataclass(frozen=True, slots=True)
class Branchpoint(Node):
    """A choice; in the location-centric form it owns its outgoing edges."""

    name: Identifier
    edges: tuple[EdgeDeclaration, ...] = ()


@dataclass(frozen=True, slots=True)
class Template(Node):
    """Attributes:
    classic: written with ``state ... trans ...``; then ``edges`` holds all edges with their sources. Otherwise the
        locations hold them.
    """

    name: Identifier
    parameters: tuple[Parameter, ...]
    declarations: tuple[Declaration, ...]
    locations: tuple[LocationDeclaration, ...]
    branchpoints: tuple[Branchpoint, ...] = ()
    edges: tuple[EdgeDeclaration, ...] = ()
    classic: bool = True
    doc: str = ""
