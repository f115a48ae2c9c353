"""The variables and channels that expressions touch, element by element where an index is a constant.

A *component* is a variable, and of an array the first index, where it does not depend on the state: ``sent[0]`` is a
component of ``sent``, and so is all of ``sent`` where the index is not known. Two components overlap if they are of the
same variable and not two different elements of it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from tachk.analysis.fold import Known, fold
from tachk.model.expressions import (
    Assign,
    Call,
    Constant,
    Expression,
    Field,
    Increment,
    Index,
    LocationTest,
    Reference,
    Variable,
)
from tachk.model.remembered import by_part
from tachk.model.traversal import children, denoted, walk, with_bodies

Component = tuple[Variable, int | None]
"""A variable and the first index; None: any element of it, or the variable as a whole."""


class ComponentSet:
    """A set of components that knows which components overlap it."""

    def __init__(self, components: Iterable[Component] = ()) -> None:
        self._elements: dict[Variable, set[int | None]] = {}
        self.add(components)

    def add(self, components: Iterable[Component]) -> None:
        for variable, element in components:
            self._elements.setdefault(variable, set()).add(element)

    def meets(self, components: Iterable[Component]) -> bool:
        """True if one of the components overlaps one of the set."""
        return any(self._meets(variable, element) for variable, element in components)

    def _meets(self, variable: Variable, element: int | None) -> bool:
        own = self._elements.get(variable, ())
        return bool(own) if element is None else element in own or None in own

    def __len__(self) -> int:
        return sum(map(len, self._elements.values()))


def places(place: Expression, known: Known) -> Iterator[Component]:
    """The components of which an assignable expression, or a channel, may denote a part."""
    for one in denoted(place):
        match one:
            case Index(Reference(variable), index):
                number = fold(index, known)
                yield variable, number.value if isinstance(number, Constant) and not variable.reference else None
            case Reference(variable):
                yield variable, None
            case Index(base) | Field(base):
                yield from places(base, known)


def mentioned_components(expressions: Iterable[Expression], known: Known) -> tuple[set[int], set[Component]]:
    """The processes whose locations are tested and the components that occur, functions included."""
    processes: set[int] = set()
    components: set[Component] = set()
    for expression in expressions:
        its_processes, its_components = _mentioned(expression, known)
        processes |= its_processes
        components |= its_components
    return processes, components


@by_part
def _mentioned(expression: Expression, known: Known) -> tuple[frozenset[int], frozenset[Component]]:
    processes: set[int] = set()
    components: set[Component] = set()
    pending = with_bodies([expression])
    while pending:
        match pending.pop():
            case LocationTest(process):
                processes.add(process)
            case Index(Reference(), index) as place:
                components.update(places(place, known))
                pending.append(index)
            case Reference(variable):
                components.add((variable, None))
            case node:
                pending.extend(children(node))
    return frozenset(processes), frozenset(components)


def written_components(expressions: Iterable[Expression], known: Known) -> set[Component]:
    """The components that evaluating the expressions may change, functions included.

    A variable passed for a reference parameter counts only if the function changes that parameter.
    """
    return set().union(*(_written(expression, known) for expression in expressions))


@by_part
def _written(expression: Expression, known: Known) -> frozenset[Component]:
    written: set[Component] = set()
    calls: list[Call] = []
    for outer in with_bodies([expression]):
        for node in walk(outer):
            if isinstance(node, Assign | Increment):
                written.update(places(node.target, known))
            elif isinstance(node, Call):
                calls.append(node)
    changed = True
    while changed:
        before = len(written)
        variables = {variable for variable, _ in written}
        for call in calls:
            for parameter, argument in zip(call.function.parameters, call.arguments, strict=True):
                if parameter.reference and parameter in variables:
                    written.update(places(argument, known))
        changed = len(written) > before
    return frozenset(written)
