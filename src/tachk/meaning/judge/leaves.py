"""The values of an expression in all discrete states, in finitely many cases.

The reference evaluator runs with unknown numbers in place of the contents of the state. Unknown numbers may be copied.
If the evaluator needs to know more of one, the case is divided, and it runs again. So each case gives the values of
some slots, and its answer is that of all states in it.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Final, TypeVar

from tachk.base.job import check_job
from tachk.base.records import dataclass
from tachk.meaning.discrete import PreparedNetwork
from tachk.model.evaluate import Environment
from tachk.model.fault import EvaluationFault
from tachk.model.traversal import process_expressions, written_variables
from tachk.model.types import ChannelType, ClockType, slot_count

T = TypeVar("T")
Values = Sequence[int]
"""Values in ascending order: a range, or a tuple."""
Case = Mapping[int, Values]
"""The values that some slots may have."""

MOST_CASES = 20_000
"""The largest number of cases into which a question is divided."""
MOST_VALUES = 1_024
"""The number of values of one slot that are distinguished."""
_FEW = 64
"""The number of values up to which they are held one by one."""


class IndivisibleError(Exception):
    """There are too many cases, or something cannot be divided into cases; ``str()`` says what."""

    def __init__(self, reason: str = "there are too many cases") -> None:
        super().__init__(reason)


class _Fork(Exception):
    def __init__(self, slot: int, parts: Sequence[Values]) -> None:
        self.slot, self.parts = slot, parts


class Unknown:
    """The number in a slot, one of several. Whoever asks for more than to have it divides the case."""

    __slots__ = ("slot", "values")

    def __init__(self, slot: int, values: Values) -> None:
        self.slot, self.values = slot, values

    def _divide(self, *_: object) -> Any:
        if len(self.values) > MOST_VALUES:
            raise IndivisibleError
        raise _Fork(self.slot, [(value,) for value in self.values])

    def _compare(self, holds: Callable[[Any, Any], bool], other: object) -> bool:
        if isinstance(other, Unknown):
            return holds(0, 0) if other.slot == self.slot else self._divide()
        if not isinstance(other, int):
            raise IndivisibleError
        parts = _divided(self.values, holds, other)
        if len(parts) > 1:
            raise _Fork(self.slot, parts)
        return holds(parts[0][0], other)

    def __bool__(self) -> bool:
        return self._compare(operator.ne, 0)

    def __eq__(self, other: object) -> bool:
        return self._compare(operator.eq, other)

    def __ne__(self, other: object) -> bool:
        return self._compare(operator.ne, other)

    def __lt__(self, other: object) -> bool:
        return self._compare(operator.lt, other)

    def __le__(self, other: object) -> bool:
        return self._compare(operator.le, other)

    def __gt__(self, other: object) -> bool:
        return self._compare(operator.gt, other)

    def __ge__(self, other: object) -> bool:
        return self._compare(operator.ge, other)

    def __hash__(self) -> int:
        return int(self._divide())

    __int__ = __index__ = __float__ = __neg__ = __abs__ = __invert__ = _divide
    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __floordiv__ = __rfloordiv__ = _divide
    __mod__ = __rmod__ = __pow__ = __rpow__ = __truediv__ = __rtruediv__ = _divide
    __and__ = __rand__ = __or__ = __ror__ = __xor__ = __rxor__ = _divide
    __lshift__ = __rlshift__ = __rshift__ = __rrshift__ = _divide


def _divided(values: Values, holds: Callable[[int, int], bool], other: int) -> list[Values]:
    """The values in parts in all of which, or in none, a comparison with a number is true."""
    if isinstance(values, range):
        low, high = values[0], values[-1] + 1
        parts: list[Values] = [range(low, min(other, high)), range(max(other + 1, low), high)]
        return [part for part in (*parts, (other,) if other in values else ()) if part]
    chosen = tuple(value for value in values if holds(value, other))
    rest = tuple(value for value in values if not holds(value, other))
    return [part for part in (chosen, rest) if part]


class _FaultLeaf:
    def __repr__(self) -> str:
        return "a run-time error"


FAULT: Final = _FaultLeaf()
"""The answer where something cannot be evaluated."""


@dataclass(frozen=True, slots=True)
class Leaf:
    """A case and the answer in it."""

    case: Case
    answer: Any


class Leaves:
    """Questions about the discrete states of a model in which what nothing writes has its initial value.

    Attributes:
        ranges: of each slot the values it may have.
        constants: the slots of variables that nothing writes, with their values.
    """

    def __init__(self, model: PreparedNetwork) -> None:
        self.model = model
        network, layout = model.network, model.layout
        self.processes = len(network.processes)
        written = written_variables([e for process in network.processes for e in process_expressions(process)])
        self.constants = {
            self.processes + index: layout.initial[index]
            for variable, first in layout.first.items()
            for index in range(first, first + slot_count(variable.type))
            if variable not in written or isinstance(layout.types[index], ClockType | ChannelType)
        }
        ranges = [(0, len(process.locations) - 1) for process in network.processes] + list(layout.ranges)
        self.ranges = [_values(low, high) for low, high in ranges]
        for slot, value in self.constants.items():
            self.ranges[slot] = (value,)
        self._contents = [content(slot, values) for slot, values in enumerate(self.ranges)]

    def environment(self, case: Case) -> Environment:
        """The environment in which expressions are evaluated in a case."""
        contents = list(self._contents)
        for slot, values in case.items():
            contents[slot] = content(slot, values)
        return Environment(self.model.layout, contents[self.processes :], contents[: self.processes])

    def of(self, question: Callable[[Environment], T], case: Case) -> Iterator[Leaf]:
        """The answers in the cases into which one is divided. Raises IndivisibleError."""
        pending, count = [case], 1
        while pending:
            check_job()
            case = pending.pop()
            try:
                yield Leaf(case, question(self.environment(case)))
            except EvaluationFault:
                yield Leaf(case, FAULT)
            except _Fork as fork:
                count += len(fork.parts) - 1
                if count > MOST_CASES:
                    raise IndivisibleError from None
                pending += [{**case, fork.slot: part} for part in fork.parts]
            except (TypeError, ValueError):
                raise IndivisibleError from None


def content(slot: int, values: Values) -> Any:
    """A number, or an unknown one."""
    return values[0] if len(values) == 1 else Unknown(slot, values)


def _values(low: int, high: int) -> Values:
    values = range(low, high + 1)
    return tuple(values) if len(values) <= _FEW else values
