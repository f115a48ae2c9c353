"""The columns of visible events: what the channel alone says, and what is noted in variables while a step is taken."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product

from tachk.base.operators import CONSTANT_HIGH, CONSTANT_LOW
from tachk.frontend.expressions.folded_expressions import substitute
from tachk.model.builder import NetworkBuilder, Term
from tachk.model.expressions import Constant, Expression, Reference, Variable
from tachk.model.recording import VisibleEvents
from tachk.model.types import ChannelType, IntType, element_type
from tachk.recordings.conformance.event_streams import index_range, index_type

ANYTHING = IntType(CONSTANT_LOW, CONSTANT_HIGH)
"""What a column may hold."""

IndexValues = Mapping[Variable, Expression]
"""The values of the indices of a channel."""


def is_broadcast(visible: VisibleEvents) -> bool:
    type_ = element_type(visible.channel.type)
    return isinstance(type_, ChannelType) and type_.broadcast


def noted_variables(builder: NetworkBuilder, number: int, visible: VisibleEvents) -> dict[str, Term]:
    """A variable for each column that is not known from the channel."""
    return {
        name: builder.declare(f"seen[{number}].{name}", ANYTHING, 0)
        for name, expression in visible.columns
        if not is_of_channel(visible, expression)
    }


def is_of_channel(visible: VisibleEvents, column: Expression) -> bool:
    match column:
        case Constant():
            return True
        case Reference(variable):
            return variable in visible.indices
        case _:
            return False


def index_cases(visible: VisibleEvents) -> Iterator[dict[Variable, int]]:
    """The values of the indices, one for each element of the channel."""
    free = [index for index in visible.indices if isinstance(index, Variable)]
    for values in product(*(index_range(index_type(variable)) for variable in free)):
        yield dict(zip(free, values, strict=True))


def noting_updates(visible: VisibleEvents, noted: Mapping[str, Term], indices: IndexValues) -> Iterator[Term]:
    for name, expression in visible.columns:
        if name in noted:
            yield noted[name].assign(Term(substitute(expression, indices, set())))


def channel_indices(visible: VisibleEvents, values: IndexValues) -> list[Expression]:
    return [values[index] if isinstance(index, Variable) else index for index in visible.indices]
