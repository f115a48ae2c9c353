"""Putting the parts of a template together: the lines of the classic body, the blocks of the location-centric one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, Label
from tachk.base.records import dataclass, replace
from tachk.base.span import Span
from tachk.syntax import ast
from tachk.syntax.edge_clauses import ClauseKind
from tachk.syntax.parsing.misplaced import Misplaced

CLAUSE_ORDER = tuple(kind.value for kind in ClauseKind)


@dataclass(frozen=True, slots=True)
class ClassicLine:
    """A line of the classic body: ``state``, ``branchpoint``, ``commit``, ``urgent``, ``init`` or ``trans``."""

    kind: str
    span: Span
    nodes: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class WrittenClause:
    """A clause of an edge or a location, such as ``guard x > 5;``."""

    kind: str
    span: Span
    value: Any


def clauses_of(clauses: Sequence[WrittenClause]) -> dict[str, Any]:
    """The fields of an edge that its clauses fill; ``probability`` may stand anywhere.

    Raises:
        Misplaced: a clause occurs twice or out of order.
    """
    given: dict[str, WrittenClause] = {}
    for clause in clauses:
        if clause.kind in given:
            how = "join them with &&" if clause.kind == "guard" else "join them with a comma"
            raise Misplaced(
                Diagnostic(
                    "E0107",
                    f"this edge has two '{clause.kind}' clauses",
                    clause.span,
                    how if clause.kind in ("guard", "select", "assign") else "remove one",
                    (Label(given[clause.kind].span, "the first one"),),
                )
            )
        for before in given.values():
            if CLAUSE_ORDER.index(before.kind) > CLAUSE_ORDER.index(clause.kind) and before.kind != "probability":
                raise Misplaced(
                    Diagnostic(
                        "E0105",
                        f"'{clause.kind}' must come before '{before.kind}'",
                        clause.span,
                        "the order is " + ", ".join(CLAUSE_ORDER),
                        (Label(before.span, f"'{before.kind}' is here"),),
                    )
                )
        given[clause.kind] = clause
    values = {kind: clause.value for kind, clause in given.items()}
    return {
        "selects": tuple(values.get("select", ())),
        "guard": values.get("guard"),
        "synchronisation": values.get("sync"),
        "updates": tuple(values.get("assign", ())),
        "probability": values.get("probability"),
    }


def template(
    span: Span, doc: str, name: ast.Identifier, parameters: tuple[ast.Parameter, ...], items: Sequence[Any]
) -> ast.Template:
    """A template from the items in its braces.

    Raises:
        Misplaced: the two forms of a body are mixed, or a line names a location that no ``state`` line declares.
    """
    lines = [item for item in items if isinstance(item, ClassicLine)]
    blocks = [item for item in items if isinstance(item, ast.LocationDeclaration | ast.Branchpoint)]
    not_declarations = ClassicLine | ast.LocationDeclaration | ast.Branchpoint
    declarations = tuple(item for item in items if not isinstance(item, not_declarations))
    if lines and blocks:
        later, earlier = (lines[0], blocks[0]) if lines[0].span.start > blocks[0].span.start else (blocks[0], lines[0])
        raise Misplaced(
            Diagnostic(
                "E0108",
                f"template '{name.name}' mixes location blocks with 'state' and 'trans' lines",
                later.span,
                "use one form in a template; tachk fmt writes location blocks",
                (Label(earlier.span, "the other form is used here"),),
            )
        )
    if blocks:
        return ast.Template(
            span,
            name,
            parameters,
            declarations,
            tuple(block for block in blocks if isinstance(block, ast.LocationDeclaration)),
            tuple(block for block in blocks if isinstance(block, ast.Branchpoint)),
            classic=False,
            doc=doc,
        )
    return ast.Template(
        span,
        name,
        parameters,
        declarations,
        _classic_locations(lines),
        tuple(ast.Branchpoint(n.span, n) for line in lines if line.kind == "branchpoint" for n in line.nodes),
        _classic_edges(lines),
        classic=True,
        doc=doc,
    )


def _classic_locations(lines: Sequence[ClassicLine]) -> tuple[ast.LocationDeclaration, ...]:
    locations: list[ast.LocationDeclaration] = [n for line in lines if line.kind == "state" for n in line.nodes]
    known = {location.name.name for location in locations}
    flagged: dict[str, set[str]] = {"commit": set(), "urgent": set(), "init": set()}
    for line in lines:
        if line.kind not in flagged:
            continue
        for identifier in line.nodes:
            if identifier.name not in known:
                raise Misplaced(
                    Diagnostic(
                        "E0109",
                        f"'{line.kind}' names '{identifier.name}', which is not a location of this template",
                        identifier.span,
                        "declare it in the 'state' line",
                    )
                )
            flagged[line.kind].add(identifier.name)
    return tuple(
        replace(
            location,
            initial=location.name.name in flagged["init"],
            urgent=location.name.name in flagged["urgent"],
            committed=location.name.name in flagged["commit"],
        )
        for location in locations
    )


def _classic_edges(lines: Sequence[ClassicLine]) -> tuple[ast.EdgeDeclaration, ...]:
    """All edges; one that omits its source has the source of the edge before it."""
    edges: list[ast.EdgeDeclaration] = []
    for line in lines:
        if line.kind != "trans":
            continue
        source: ast.Identifier | None = None
        for edge in line.nodes:
            if edge.source is not None:
                source = edge.source
            elif source is None:
                raise Misplaced(
                    Diagnostic(
                        "E0110",
                        "the first edge of a 'trans' line needs a source location",
                        edge.span,
                        "write 'Source -> Target { ... }'",
                    )
                )
            else:
                edge = replace(edge, source=source)
            edges.append(edge)
    return tuple(edges)
