"""Edges that a template may lack, made of its vocabulary.

Most simple ones first: a guard that is relaxed is an edge beside the one whose guard it is.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator
from itertools import product

from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.span import Source, Span
from tachk.syntax import ast
from tachk.syntax.chains import chain, conjuncts
from tachk.syntax.edge_clauses import edge_clauses
from tachk.syntax.printing.expression_printer import print_clause
from tachk.syntax.rewrite import names_in, rewrite
from tachk.verify.repair.vocabulary import INTERNAL, EdgeLabel, PlacedEdge, Vocabulary, label_of


@dataclass(frozen=True, slots=True)
class ProposedEdge:
    """An edge that a template may lack.

    Attributes:
        preference: of its guard: one that completes those of the siblings, one that others have, a part of one, none.
        relaxes: the edge whose guard it relaxes; None: it is a further edge.
    """

    template: str
    source: str
    edge: ast.EdgeDeclaration
    preference: int
    relaxes: ast.EdgeDeclaration | None = None

    @property
    def target(self) -> str:
        return self.edge.target.name

    @property
    def text(self) -> str:
        """The edge as the language writes it in the block of its source."""
        return edge_text(self.edge)


def edge_text(edge: ast.EdgeDeclaration) -> str:
    """An edge in one line."""
    clauses = "".join(f" {clause.kind.value} {print_clause(clause)};" for clause in edge_clauses(edge))
    return f"to {edge.target.name} {{{clauses} }}" if clauses else f"to {edge.target.name};"


_COMPLETES, _OWN, _PART, _NONE = range(4)
_Proposed = Iterator[tuple[str, ast.EdgeDeclaration, int, ast.EdgeDeclaration | None]]
"""The source, the edge, the preference of its guard, and the edge whose guard it relaxes."""


@dataclass(frozen=True, slots=True)
class ProposalKind:
    """A way to make edges of a vocabulary.

    Attributes:
        name: as docs/repair.md lists it.
        rank: small ones are tried first.
        edges: of a vocabulary.
    """

    name: str
    rank: int
    edges: Callable[[Vocabulary], _Proposed]


def _with_wider_guard(words: Vocabulary) -> _Proposed:
    """Edges of which one condition of the guard is left out, or the whole guard."""
    for placed in words.edges:
        if placed.edge.guard is None:
            continue
        parts = conjuncts(placed.edge.guard)
        shorter = [parts[:n] + parts[n + 1 :] for n in range(len(parts))]
        for rest in [*shorter, *([[]] if len(parts) > 1 else [])]:
            yield placed.source, replace(placed.edge, guard=_all(rest)), _PART if rest else _NONE, placed.edge


def _completed(words: Vocabulary) -> _Proposed:
    """Edges beside another one, where the guards of all such edges are false."""
    for placed in words.edges:
        for guard in words.complementary(placed.source, label_of(placed.edge)):
            yield placed.source, replace(placed.edge, guard=guard), _COMPLETES, None


def _moved(words: Vocabulary) -> _Proposed:
    """Edges with another source, another target, or both where they are loops."""
    for placed in words.edges:
        for source, target in product(words.locations, repeat=2):
            moved = (source != placed.source) + (target != placed.edge.target.name)
            loop = placed.source == placed.edge.target.name and source == target
            if moved == 1 or (moved == 2 and loop):
                label = label_of(placed.edge)
                for guard, preference in _guards(words, source, label, placed):
                    yield source, _aimed(placed.edge, target, guard), preference, None


def _guards(
    words: Vocabulary, source: str, label: EdgeLabel, placed: PlacedEdge | None = None
) -> Iterator[tuple[ast.Expression | None, int]]:
    """The guards of an edge from a location with a label, each with its preference."""
    for guard in words.complementary(source, label):
        yield guard, _COMPLETES
    if placed is not None and placed.edge.guard is not None:
        yield placed.edge.guard, _OWN
    yield None, _NONE


def _with_unused(words: Vocabulary) -> _Proposed:
    """Edges that call a function that nothing calls, or synchronise where only the other side does."""
    single = [updates for updates in words.updates if len(updates) == 1]
    for call, label in product(words.calls, (INTERNAL, *words.labels)):
        for updates in [(call,), *((call, *each) for each in single)]:
            yield from _everywhere(words, label, updates, words.conditions)
    for label in words.unanswered:
        for updates in [(), *((call,) for call in words.calls), *words.updates]:
            yield from _everywhere(words, label, updates, words.conditions)


def _unheard(words: Vocabulary) -> _Proposed:
    """Edges that receive a broadcast that nobody receives."""
    for label in words.unheard:
        for updates in [(), *((call,) for call in words.calls), *words.updates]:
            yield from _everywhere(words, label, updates, words.conditions)


def _plain(words: Vocabulary) -> _Proposed:
    """Edges without updates."""
    for label in (INTERNAL, *words.labels, *words.other_labels):
        yield from _everywhere(words, label, (), words.conditions)


def _mixed(words: Vocabulary) -> _Proposed:
    """Edges with the label of one and the updates of another."""
    for label, updates in product((INTERNAL, *words.labels), words.updates):
        yield from _everywhere(words, label, updates)


def _everywhere(
    words: Vocabulary, label: EdgeLabel, updates: tuple[ast.Expression, ...], conditions: Iterable[ast.Expression] = ()
) -> _Proposed:
    for source, target in product(words.locations, repeat=2):
        if source == target and label.synchronisation is None and not updates:
            continue
        span = words.template.name.span
        aim = ast.Identifier(span, target)
        for guard, preference in [*_guards(words, source, label), *((condition, _OWN) for condition in conditions)]:
            edge = ast.EdgeDeclaration(span, None, aim, label.selects, guard, label.synchronisation, updates)
            yield source, edge, preference, None


KINDS = (
    ProposalKind("unused", 0, _with_unused),
    ProposalKind("relaxed", 0, _with_wider_guard),
    ProposalKind("completed", 0, _completed),
    ProposalKind("moved", 0, _moved),
    ProposalKind("plain", 1, _plain),
    ProposalKind("unheard", 1, _unheard),
    ProposalKind("mixed", 2, _mixed),
)
"""The kinds of proposals. Those with a larger rank are more, and are tried only where the others are not enough."""


def proposals(words: Vocabulary, rank: int, sources: Collection[str]) -> Iterator[ProposedEdge]:
    """The edges of the kinds with one rank that the template has not, each once.

    Args:
        sources: the locations at which they may begin.
    """
    known = {(placed.source, edge_text(placed.edge)) for placed in words.edges}
    for kind in KINDS:
        if kind.rank != rank:
            continue
        for source, edge, preference, relaxes in kind.edges(words):
            if source not in sources:
                continue
            key = source, edge_text(edge)
            if key not in known and _is_closed(edge):
                known.add(key)
                yield ProposedEdge(words.template.name.name, source, edge, preference, relaxes)


def _is_closed(edge: ast.EdgeDeclaration) -> bool:
    """True if no binding of a select is there for nothing."""
    used = names_in([edge.guard, edge.synchronisation, edge.updates]) if edge.selects else {}
    return all(binding.name.name in used for binding in edge.selects)


def _all(parts: list[ast.Expression]) -> ast.Expression | None:
    return chain(BinaryOperator.AND, parts, parts[0].span) if parts else None


def _aimed(edge: ast.EdgeDeclaration, target: str, guard: ast.Expression | None) -> ast.EdgeDeclaration:
    return replace(edge, target=ast.Identifier(edge.target.span, target), guard=guard)


def listed(proposed: Iterable[ProposedEdge]) -> list[ProposedEdge]:
    """The edges with places of their own in a text that lists them, by which their elaborated edges, and what is wrong
    with them, are recognised."""
    every = list(proposed)
    lines = [f"{each.source} {each.text}\n" for each in every]
    source = Source("proposed edges", "".join(lines))
    placed, start = [], 0
    for each, line in zip(every, lines, strict=True):
        span = Span(source, start, start + len(line) - 1)
        plain = replace(each.edge, source=None, doc="", probability=None, controllable=True)
        placed.append(replace(each, edge=_at(plain, span)))
        start += len(line)
    return placed


def _at(edge: ast.EdgeDeclaration, span: Span) -> ast.EdgeDeclaration:
    """The edge with one place for all of it."""
    return rewrite(edge, lambda node: replace(node, span=span))
