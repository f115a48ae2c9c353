"""Queries as labels of locations, the only thing TChecker searches for.

A query can be written if its predicate is about locations only: it is brought into disjunctive form, and each
alternative becomes a set of labels that some state may have together.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from tachk.analysis.fold import Known
from tachk.base.operators import UnaryOperator
from tachk.formats.tchecker.expression_writer import written_out
from tachk.model.connectives import is_conjunction, sides
from tachk.model.expressions import Binary, Conditional, Constant, Expression, LocationTest, Unary
from tachk.model.network import Network
from tachk.model.query import Query

MAXIMUM_ALTERNATIVES = 256

Places = Mapping[int, frozenset[int]]
"""Some processes, each with the locations it may be in."""


@dataclass(frozen=True, slots=True)
class QueryLabels:
    """Attributes:
    alternatives: sets of labels; the query is about a state that has all labels of one of them.
    places: what each label stands for: a process and some of its locations.
    reason: why labels cannot ask the query; empty if they can.
    """

    query: Query
    alternatives: tuple[tuple[str, ...], ...] = ()
    places: tuple[tuple[str, int, frozenset[int]], ...] = ()
    reason: str = ""

    def of(self, process: int, location: int) -> Iterator[str]:
        """The labels of a location."""
        for label, number, locations in self.places:
            if number == process and location in locations:
                yield label

    def remarks(self) -> Iterator[str]:
        """The comment for a reader of the file."""
        yield " ".join(f"{self.query.name}: {self.query.text}".split())
        if self.reason:
            yield f"    labels cannot ask it: {self.reason}"
            return
        answer = "holds" if self.query.holds_when_reached else "fails"
        if not self.alternatives:
            yield f"    never {answer}: no combination of locations does it"
        for labels in self.alternatives:
            yield f"    {answer} if TChecker reaches -l {','.join(labels)}"


def query_labels(query: Query, network: Network, known: Known, prefix: str) -> QueryLabels:
    """The labels for a query; ``prefix`` begins their names."""
    if query.observer is not None:
        return QueryLabels(query, reason="it is a temporal formula, which an automaton beside the network follows")
    if query.target is None:
        return QueryLabels(query, reason=f"TChecker does not check {query.kind.value}")
    try:
        alternatives = _alternatives(written_out(query.target, known), True, network)
    except _NotLocations:
        return QueryLabels(query, reason="it asks for more than locations")
    labels: dict[tuple[int, frozenset[int]], str] = {}
    sets = []
    for places in alternatives:
        chosen = []
        for process, locations in sorted(places.items()):
            key = process, locations
            chosen.append(labels.setdefault(key, f"{prefix}_{len(labels) + 1}"))
        if not chosen:
            return QueryLabels(query, reason="every state does it")
        sets.append(tuple(chosen))
    named = tuple((label, process, locations) for (process, locations), label in labels.items())
    return QueryLabels(query, tuple(dict.fromkeys(sets)), named)


class _NotLocations(Exception):
    pass


def _alternatives(expression: Expression, positive: bool, network: Network) -> list[Places]:
    match expression:
        case Constant(value):
            return [{}] if (value != 0) == positive else []
        case LocationTest(process, location):
            every = frozenset(range(len(network.processes[process].locations)))
            return [{process: frozenset({location}) if positive else every - {location}}]
        case Unary(UnaryOperator.NOT, operand):
            return _alternatives(operand, not positive, network)
        case Binary() if (conjunctive := is_conjunction(expression, positive)) is not None:
            left, right = sides(expression, positive)
            return _joined(_alternatives(*left, network), _alternatives(*right, network), conjunctive)
        case Conditional(condition, then, otherwise):
            one = _joined(_alternatives(condition, True, network), _alternatives(then, positive, network), True)
            other = _joined(_alternatives(condition, False, network), _alternatives(otherwise, positive, network), True)
            return _joined(one, other, False)
        case _:
            raise _NotLocations


def _joined(left: list[Places], right: list[Places], both: bool) -> list[Places]:
    if not both:
        result = left + right
    else:
        result = [merged for one in left for other in right if (merged := _merged(one, other)) is not None]
    if len(result) > MAXIMUM_ALTERNATIVES:
        raise _NotLocations
    return result


def _merged(one: Places, other: Places) -> Places | None:
    result = dict(one)
    for process, locations in other.items():
        result[process] = result[process] & locations if process in result else locations
        if not result[process]:
            return None
    return result
