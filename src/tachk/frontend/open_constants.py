"""Constants that keep their names in a network, for analyses that ask what their values do.

Everywhere else a scalar constant is a number wherever it is used. An open constant is a variable that nothing changes,
and so is a constant whose value is an expression of open ones; where elaboration needs the value nevertheless (the size
of an array, a range, an initial value), it takes the one at hand and notes the place.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from tachk.base.records import dataclass, field
from tachk.base.span import Span
from tachk.model.expressions import Variable

if TYPE_CHECKING:
    from tachk.logic.bound_directions import Easier


@dataclass(slots=True)
class OpenConstants:
    """Attributes:
    names: of global constants that are to stay open.
    ranges: the least and the largest value that one may be given in the network itself, for analyses that run it;
        others are for reading only.
    variables: those that were declared so far, by name.
    needed: where elaboration needed the value of one, by name; the first place of each. Bounds of properties are left
        out.
    in_bounds: what more of one does to a property of whose bounds it is a part, by name, each with a place: whether
        the property is true more often; None: this is not known.
    """

    names: frozenset[str] = frozenset()
    ranges: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    variables: dict[str, Variable] = field(default_factory=dict)
    needed: dict[str, Span] = field(default_factory=dict)
    in_bounds: dict[str, dict[Easier, Span]] = field(default_factory=dict)

    def among(self, variables: Iterable[Variable]) -> list[str]:
        """The names of the open constants among variables."""
        if not self.variables:
            return []
        given = set(variables)
        return [name for name, variable in self.variables.items() if variable in given]

    def note(self, read: Iterable[Variable], span: Span) -> None:
        """Elaboration computes something from these variables."""
        for name in self.among(read):
            self.needed.setdefault(name, span)

    def in_bound(self, name: str, easier: Easier, span: Span) -> None:
        """A property has a bound that depends on one."""
        self.in_bounds.setdefault(name, {}).setdefault(easier, span)
