"""Questions about some of several interchangeable processes, asked of all of them.

Whether the processes 1 and 2 are ever critical together tells these two from the others, so that a search for it has
more states than one for whether any two of them are. If no two of them ever are, then these two are not, either. The
other way round that is so where exchanges keep the initial state, too: whatever one of them makes of a state is reached
if the state is (Emerson, Sistla, Symmetry and model checking, FMSD 9, 1996).
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import replace

from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass
from tachk.engine.symmetry.automorphism import NetworkTerms, Renaming
from tachk.engine.symmetry.detection import find_symmetry
from tachk.engine.symmetry.kinds import ArrayTree, RecordTree, Tree
from tachk.engine.symmetry.sketch import sketch_of
from tachk.engine.symmetry.tables import interchanged
from tachk.model.connectives import any_of
from tachk.model.expressions import Binary, Constant, Expression, Field, Index, LocationTest, Reference, Variable
from tachk.model.network import Network
from tachk.model.remembered import by_network
from tachk.model.substitution import with_parts
from tachk.transform.cone_of_influence import mentioned

MOST_IMAGES = 100
"""A question that becomes more than so many is asked as it is: each state that is found is asked all of them."""


def names_some(network: Network, question: Expression) -> bool:
    """Whether a question mentions anything that exchanges of interchangeable processes move, as far as can be seen."""
    sketch = sketch_of(network)
    if not sketch.repeats:
        return False
    processes, variables = mentioned([question])
    if any(sketch.colours.count(sketch.colours[number]) > 1 for number in processes if number < len(sketch.colours)):
        return True
    moved = _moved(network)
    return not processes.isdisjoint(moved.processes) or not variables.isdisjoint(moved.variables)


@dataclass(frozen=True, slots=True)
class _Moved:
    processes: frozenset[int]
    variables: frozenset[Variable]


@by_network
def _moved(network: Network) -> _Moved:
    symmetry = find_symmetry(network, [])
    renamings = list(symmetry.renamings)
    return _Moved(
        frozenset(process for renaming in renamings for process in renaming.processes),
        frozenset(variable for renaming in renamings for variable in symmetry.reading.moved_variables(renaming)),
    )


def asked_of_all(
    network: Network, targets: Sequence[Expression], conditions: Sequence[Expression]
) -> tuple[Sequence[Expression], Sequence[Expression]] | None:
    """Questions that are true wherever these are, and leave all processes interchangeable that are so where nothing is
    asked; None if there are none, or these do. A condition is true of some state if and only if the one that is asked
    in its place is.
    """
    if not sketch_of(network).repeats:
        return None
    everything = interchanged(network, [])
    if not everything or interchanged(network, [*targets, *conditions]) == everything:
        return None
    symmetry = find_symmetry(network, [])
    renamings = list(symmetry.renamings)
    asked, on_the_way = (
        [_any_image(symmetry.reading, renamings, question) for question in questions]
        for questions in (targets, conditions)
    )
    if on_the_way != list(conditions) and not all(map(symmetry.reading.keeps_initial_values, renamings)):
        return None
    return (asked, on_the_way) if interchanged(network, [*asked, *on_the_way]) == everything else None


def _any_image(reading: NetworkTerms, renamings: Sequence[Renaming], question: Expression) -> Expression:
    """Whether the question, or one that renamings make of it, is true; the question itself if there are too many."""
    images = {_in_any_order(part): part for part in _parts(question, BinaryOperator.OR)}
    pending = list(images.values())
    while pending:
        part = pending.pop()
        for renaming in renamings:
            image = _renamed(part, reading, renaming)
            key = _in_any_order(image)
            if key not in images:
                images[key] = image
                pending.append(image)
        if len(images) > MOST_IMAGES:
            return question
    return any_of(list(images.values()))


def _parts(expression: Expression, operator: BinaryOperator) -> Iterator[Expression]:
    """What is joined by a connective."""
    if isinstance(expression, Binary) and expression.operator is operator:
        yield from _parts(expression.left, operator)
        yield from _parts(expression.right, operator)
    else:
        yield expression


def _in_any_order(expression: Expression) -> Hashable:
    """The same for conjunctions of the same parts."""
    return frozenset(_parts(expression, BinaryOperator.AND))


def _renamed(expression: Expression, reading: NetworkTerms, renaming: Renaming) -> Expression:
    """The image of a question. Numbers are renamed where they are indices or compared with variables; whether nothing
    is forgotten shows where the processes are found to be interchangeable."""

    def of(part: Expression) -> Expression:
        return _renamed(part, reading, renaming)

    def number(tree: Tree | None, part: Expression) -> Expression:
        if not isinstance(part, Constant) or not isinstance(tree, int):
            return of(part)
        return replace(part, value=renaming.value(reading.kinds, tree, part.value))

    match expression:
        case Reference(variable):
            return replace(expression, variable=renaming.variables.get(variable, variable))
        case LocationTest(process):
            return replace(expression, process=renaming.processes.get(process, process))
        case Index(base, index):
            tree = _tree(base, reading)
            return replace(
                expression, base=of(base), index=number(tree.index if isinstance(tree, ArrayTree) else None, index)
            )
        case Binary(BinaryOperator.EQUAL | BinaryOperator.NOT_EQUAL, left, right):
            return replace(
                expression, left=number(_tree(right, reading), left), right=number(_tree(left, reading), right)
            )
        case _:
            return with_parts(expression, of)


def _tree(place: Expression, reading: NetworkTerms) -> Tree | None:
    """The kinds of a variable or a part of one."""
    match place:
        case Reference(variable):
            return reading.reader.trees.get(variable)
        case Index(base):
            tree = _tree(base, reading)
            return tree.element if isinstance(tree, ArrayTree) else None
        case Field(base, name):
            tree = _tree(base, reading)
            return dict(tree.fields)[name] if isinstance(tree, RecordTree) else None
        case _:
            return None
