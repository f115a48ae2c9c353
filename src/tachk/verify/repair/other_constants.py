"""Other values of constants with which recordings are runs.

The network is elaborated with constants that keep their names, and a search near the place where a recording leaves
the model gives one of them another value at the beginning. Of the values that go along there, the nearest on either
side is looked for by halving, and every value that is reported has been held against all recordings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cache

from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError, UsageError
from tachk.base.records import dataclass, replace
from tachk.frontend.loaded import LoadedModel, with_constants
from tachk.model.network import Network
from tachk.model.recording import RecordingMap
from tachk.model.types import BoolType
from tachk.recordings.conformance.location_columns import with_location_variables
from tachk.syntax import ast
from tachk.syntax.rewrite import names_in, rewrite
from tachk.syntax.walk import nodes_of_kind
from tachk.verify.repair.chosen_search import ChosenValue

_LARGEST = 100_000
"""Constants with larger values are left as they are: they are no times and no sizes."""
_STEP = 1.06
"""Values that are tried grow and shrink by this factor, beside all that are near."""
_NEAR = 8
_FACTOR = 4
"""Values are tried up to so many times the value at hand; of 0 up to its square."""


_AT = " at "
"""Stands in the names of numbers, between their values and their places."""


@dataclass(frozen=True, slots=True)
class RepairingConstant:
    """A constant with another value, with which all recordings are runs.

    Attributes:
        name: of the constant; of a number its value and its place.
        before, after: its values; `after` is the nearest one that was found.
        far: the one farthest from it that was found, with all between them that were tried.
    """

    name: str
    before: int
    after: int
    far: int

    @property
    def is_number(self) -> bool:
        """True if it is a number in the text of the model."""
        return _AT in self.name

    @property
    def change(self) -> float:
        """How large the change is: by which part of the larger value."""
        return abs(self.after - self.before) / max(abs(self.after), abs(self.before), 1)


@dataclass(frozen=True, slots=True)
class OpenedModel:
    """A model whose constants can be given values at the beginning of a run.

    Attributes:
        values: those that are tried of each constant.
        choices: one for each of them, in their order.
    """

    network: Network
    mapping: RecordingMap
    values: tuple[tuple[str, int], ...]
    choices: tuple[ChosenValue, ...]


def with_named_numbers(loaded: LoadedModel) -> LoadedModel:
    """The model with a constant in place of each number in a guard or an invariant, named by its value and place.

    It has no properties; `with_constants` takes them up again.
    """
    found: dict[str, ast.IntegerLiteral] = {}

    def named(node: object) -> object:
        if not isinstance(node, ast.IntegerLiteral):
            return node
        name = f"{node.value}{_AT}{node.span}"
        found[name] = node
        return ast.NameExpression(node.span, name)

    def change(node: object) -> object:
        match node:
            case ast.EdgeDeclaration(guard=guard) if guard is not None:
                return replace(node, guard=rewrite(guard, named))
            case ast.LocationDeclaration(invariant=invariant) if invariant is not None:
                return replace(node, invariant=rewrite(invariant, named))
            case _:
                return node

    items = rewrite(loaded.items, change)
    constants = [_constant(name, literal) for name, literal in found.items()]
    return with_constants(replace(loaded, items=(*constants, *items)), {}, ())


def _constant(name: str, literal: ast.IntegerLiteral) -> ast.VariableDeclaration:
    span = literal.span
    type_ = ast.TypeExpression(span, ("const",), ast.BuiltinType(span, "int"))
    return ast.VariableDeclaration(span, type_, (ast.Declarator(span, ast.Identifier(span, name), (), literal),))


def opened_model(loaded: LoadedModel, templates: frozenset[str]) -> OpenedModel:
    """The model with the open constants on which some templates depend, less those of which its structure is made."""
    before = dict(loaded.network.constants)
    names = [name for name in _relevant(loaded.items, templates) if abs(before.get(name, _LARGEST + 1)) <= _LARGEST]
    first = with_constants(loaded, {}, (), names).context.open_constants
    tried = {
        name: [1 - before[name]] if isinstance(first.variables[name].type, BoolType) else values_near(before[name])
        for name in names
        if name not in first.needed
    }
    ranges = {name: (min(*values, before[name]), max(*values, before[name])) for name, values in tried.items()}
    opened = with_constants(loaded, {}, (), tried, ranges)
    assert opened.recording is not None
    network, mapping = with_location_variables(opened.network, opened.recording)
    variables = opened.context.open_constants.variables
    pairs = tuple((name, value) for name, values in tried.items() for value in values)
    choices = (ChosenValue(number, variables[name], value, True) for number, (name, value) in enumerate(pairs))
    return OpenedModel(network, mapping, pairs, tuple(choices))


def values_near(before: int) -> list[int]:
    """Values in place of another one: all that are near, and some that are far."""
    sign = -1 if before < 0 else 1
    size = abs(before)
    found = {size + n for n in range(-_NEAR, _NEAR + 1)}
    factor = 1.0
    while factor < _FACTOR:
        found |= {round(size * factor), round(size / factor)}
        factor *= _STEP
    found |= {0, size // 8, size // 16, size * _FACTOR, *(2**n for n in range(5) if not size)}
    return sorted({sign * value for value in found if value >= 0 and value != size}, key=lambda v: abs(v - before))


def nearest_values(
    loaded: LoadedModel,
    likely: Sequence[tuple[str, int]],
    accepts: Callable[[Network, RecordingMap], bool],
) -> Iterator[RepairingConstant]:
    """The nearest value of each constant on either side that repairs the model alone.

    Args:
        likely: values that go along near the place where a recording leaves the model, the nearest of each first.
        accepts: whether all recordings are runs of a network.
    """
    before = dict(loaded.network.constants)
    for name in dict.fromkeys(name for name, _ in likely):

        @cache
        def accepted(value: int, name: str = name) -> bool:
            try:
                changed = with_constants(loaded, {name: value}, ())
                network = changed.network
            except (InputError, UsageError, UnsupportedError):
                return False
            assert changed.recording is not None
            return accepts(*with_location_variables(network, changed.recording))

        values = [value for other, value in likely if other == name]
        for side in (1, -1):
            there = [value for value in values if (value - before[name]) * side > 0]
            tried = [there[n] for n in sorted({0, len(there) // 4, len(there) // 2, len(there) - 1}) if there]
            first = next((value for value in tried if accepted(value)), None)
            if first is None:
                continue
            last = there[-1] if accepted(there[-1]) else _last(first, there[-1] + side, accepted)
            yield RepairingConstant(name, before[name], _last(first, before[name], accepted), last)


def _last(found: int, rejected: int, accepted: Callable[[int], bool]) -> int:
    """The accepted value that halving finds between an accepted and a rejected one, nearest to that."""
    while abs(found - rejected) > 1:
        middle = (found + rejected) // 2
        if accepted(middle):
            found = middle
        else:
            rejected = middle
    return found


def _relevant(items: Sequence[ast.Item], templates: frozenset[str]) -> Iterator[str]:
    """The global constants on which the text of some templates depends, in the order of the model; without those that
    choose a channel, and those that are computed of others."""
    declared: dict[str, ast.VariableDeclaration] = {}
    functions: dict[str, ast.Node] = {}
    for item in items:
        if isinstance(item, ast.VariableDeclaration):
            declared |= {declarator.name.name: item for declarator in item.declarators}
        elif isinstance(item, ast.FunctionDeclaration):
            functions[item.name.name] = item
    used = set(names_in([i for i in items if isinstance(i, ast.Template) and i.name.name in templates]))
    pending = list(used)
    while pending:
        name = pending.pop()
        node = declared.get(name) or functions.get(name)
        more = names_in(node).keys() - used if node is not None else set()
        used |= more
        pending += more
    indices = {
        name
        for label in nodes_of_kind(list(items), ast.SynchronisationLabel)
        for index in nodes_of_kind(label, ast.IndexExpression)
        for name in names_in(index.index)
    }
    for name, declaration in declared.items():
        is_constant = declaration.type is None or "const" in declaration.type.prefixes
        if name in used and is_constant and name not in indices and _is_number(declaration, name):
            yield name


def _is_number(declaration: ast.VariableDeclaration, name: str) -> bool:
    """True if the declaration gives a number itself, and does not compute it of others."""
    initial = next(each.initialiser for each in declaration.declarators if each.name.name == name)
    return initial is not None and not names_in(initial)
