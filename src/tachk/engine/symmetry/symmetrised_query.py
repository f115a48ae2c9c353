"""Symmetrised queries: a query that names some of several interchangeable processes becomes one about all of them.

"Processes 1 and 2 are critical together" breaks the symmetry of these two with the others, so that a search for it has
more states than a search for "any two processes are critical together". If the symmetrised target is unreachable, so is
the original one. The converse holds where the automorphisms keep the initial state, too: then the image of a reachable
state is reachable (Emerson, Sistla, Symmetry and model checking, FMSD 9, 1996).
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence

from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.engine.symmetry.automorphism import NetworkTerms
from tachk.engine.symmetry.coarse_partition import coarse_partition
from tachk.engine.symmetry.detection import find_symmetry
from tachk.engine.symmetry.index_types import ArrayTree, RecordTree, Tree
from tachk.engine.symmetry.renaming import Renaming
from tachk.engine.symmetry.tables import interchanged
from tachk.model.connectives import any_of
from tachk.model.expressions import Binary, Constant, Expression, Field, Index, LocationTest, Reference, Variable
from tachk.model.network import Network
from tachk.model.remembered import by_network
from tachk.model.substitution import with_parts
from tachk.transform.cone_of_influence import mentioned

MOST_IMAGES = 100
"""A query with more images than this is not targets_of_all, as the search evaluates all images on each state."""


def is_asymmetric(network: Network, question: Expression) -> bool:
    """True if a query mentions processes or variables that automorphisms move. May be true without need."""
    partition = coarse_partition(network)
    if not partition.repeats:
        return False
    processes, variables = mentioned([question])
    if any(
        partition.colours.count(partition.colours[number]) > 1
        for number in processes
        if number < len(partition.colours)
    ):
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
        frozenset(variable for renaming in renamings for variable in symmetry.terms.moved_variables(renaming)),
    )


def symmetrised_query(
    network: Network, targets: Sequence[Expression], conditions: Sequence[Expression]
) -> tuple[Sequence[Expression], Sequence[Expression]] | None:
    """Queries that these imply and that keep all symmetries of the network; None if there are none, or these keep them.

    A symmetrised condition is true of some state if and only if the original one is.
    """
    if not coarse_partition(network).repeats:
        return None
    everything = interchanged(network, [])
    if not everything or interchanged(network, [*targets, *conditions]) == everything:
        return None
    symmetry = find_symmetry(network, [])
    renamings = list(symmetry.renamings)
    targets_of_all, conditions_of_all = (
        [_any_image(symmetry.terms, renamings, question) for question in questions]
        for questions in (targets, conditions)
    )
    if conditions_of_all != list(conditions) and not all(map(symmetry.terms.keeps_initial_values, renamings)):
        return None
    return (
        (targets_of_all, conditions_of_all)
        if interchanged(network, [*targets_of_all, *conditions_of_all]) == everything
        else None
    )


def _any_image(terms: NetworkTerms, renamings: Sequence[Renaming], question: Expression) -> Expression:
    """The disjunction of all images of a query under renamings; the query itself if there are too many."""
    images = {_in_any_order(part): part for part in _parts(question, BinaryOperator.OR)}
    pending = list(images.values())
    while pending:
        part = pending.pop()
        for renaming in renamings:
            image = _renamed(part, terms, renaming)
            key = _in_any_order(image)
            if key not in images:
                images[key] = image
                pending.append(image)
        if len(images) > MOST_IMAGES:
            return question
    return any_of(list(images.values()))


def _parts(expression: Expression, operator: BinaryOperator) -> Iterator[Expression]:
    """The operands of a chain of one connective."""
    if isinstance(expression, Binary) and expression.operator is operator:
        yield from _parts(expression.left, operator)
        yield from _parts(expression.right, operator)
    else:
        yield expression


def _in_any_order(expression: Expression) -> Hashable:
    """A key that is equal for conjunctions of the same parts."""
    return frozenset(_parts(expression, BinaryOperator.AND))


def _renamed(expression: Expression, terms: NetworkTerms, renaming: Renaming) -> Expression:
    """The image of a query. Numbers are renamed where they are indices or compared with variables; the caller checks
    that the result keeps the symmetries, which shows that no number was missed."""

    def of(part: Expression) -> Expression:
        return _renamed(part, terms, renaming)

    def number(tree: Tree | None, part: Expression) -> Expression:
        if not isinstance(part, Constant) or not isinstance(tree, int):
            return of(part)
        return replace(part, value=renaming.value(terms.index_types, tree, part.value))

    match expression:
        case Reference(variable):
            return replace(expression, variable=renaming.variables.get(variable, variable))
        case LocationTest(process):
            return replace(expression, process=renaming.processes.get(process, process))
        case Index(base, index):
            tree = _tree(base, terms)
            return replace(
                expression, base=of(base), index=number(tree.index if isinstance(tree, ArrayTree) else None, index)
            )
        case Binary(BinaryOperator.EQUAL | BinaryOperator.NOT_EQUAL, left, right):
            return replace(expression, left=number(_tree(right, terms), left), right=number(_tree(left, terms), right))
        case _:
            return with_parts(expression, of)


def _tree(place: Expression, terms: NetworkTerms) -> Tree | None:
    """The index types of a variable or a part of one."""
    match place:
        case Reference(variable):
            return terms.reader.trees.get(variable)
        case Index(base):
            tree = _tree(base, terms)
            return tree.element if isinstance(tree, ArrayTree) else None
        case Field(base, name):
            tree = _tree(base, terms)
            return dict(tree.fields)[name] if isinstance(tree, RecordTree) else None
        case _:
            return None
