"""The methods of records by the number of their fields, compiled with the package and not at each start.

`records` puts the names of fields in the place of ``p_0``, ``p_1``, and so on. The tables are what `text` says, which
also gives the methods of records with more fields.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

assign: Any = object.__setattr__
after: Any = None
"""What `records` gives to the code of a record: it stands here for the compiler only."""


def text(kind: str, number: int) -> str:
    """The text of a method for so many fields."""
    names = [f"p_{each}" for each in range(number)]
    match kind:
        case "equal":
            mine, others = ("".join(f"{whose}.{name}, " for name in names) for whose in ("self", "other"))
            return (
                f"lambda self, other: ({mine}) == ({others}) if self.__class__ is other.__class__ else NotImplemented"
            )
        case "hash":
            return f"lambda self: hash(({''.join(f'self.{name}, ' for name in names)}))"
        case _:
            steps = [*(f"assign(self, {name!r}, {name})" for name in names), *(["after(self)"] * (kind != "init"))]
            return f"lambda {', '.join(['self', *names])}: {' or '.join(steps) or None}"


METHODS: dict[str, tuple[Callable[..., Any], ...]] = {
    "init": (
        lambda self: None,
        lambda self, p_0: assign(self, "p_0", p_0),
        lambda self, p_0, p_1: assign(self, "p_0", p_0) or assign(self, "p_1", p_1),
        lambda self, p_0, p_1, p_2: assign(self, "p_0", p_0) or assign(self, "p_1", p_1) or assign(self, "p_2", p_2),
        lambda self, p_0, p_1, p_2, p_3: (
            assign(self, "p_0", p_0) or assign(self, "p_1", p_1) or assign(self, "p_2", p_2) or assign(self, "p_3", p_3)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5, p_6: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
            or assign(self, "p_6", p_6)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
            or assign(self, "p_6", p_6)
            or assign(self, "p_7", p_7)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
            or assign(self, "p_6", p_6)
            or assign(self, "p_7", p_7)
            or assign(self, "p_8", p_8)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8, p_9: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
            or assign(self, "p_6", p_6)
            or assign(self, "p_7", p_7)
            or assign(self, "p_8", p_8)
            or assign(self, "p_9", p_9)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8, p_9, p_10: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
            or assign(self, "p_6", p_6)
            or assign(self, "p_7", p_7)
            or assign(self, "p_8", p_8)
            or assign(self, "p_9", p_9)
            or assign(self, "p_10", p_10)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8, p_9, p_10, p_11: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
            or assign(self, "p_6", p_6)
            or assign(self, "p_7", p_7)
            or assign(self, "p_8", p_8)
            or assign(self, "p_9", p_9)
            or assign(self, "p_10", p_10)
            or assign(self, "p_11", p_11)
        ),
    ),
    "init and after": (
        lambda self: after(self),
        lambda self, p_0: assign(self, "p_0", p_0) or after(self),
        lambda self, p_0, p_1: assign(self, "p_0", p_0) or assign(self, "p_1", p_1) or after(self),
        lambda self, p_0, p_1, p_2: (
            assign(self, "p_0", p_0) or assign(self, "p_1", p_1) or assign(self, "p_2", p_2) or after(self)
        ),
        lambda self, p_0, p_1, p_2, p_3: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or after(self)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or after(self)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
            or after(self)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5, p_6: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
            or assign(self, "p_6", p_6)
            or after(self)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
            or assign(self, "p_6", p_6)
            or assign(self, "p_7", p_7)
            or after(self)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
            or assign(self, "p_6", p_6)
            or assign(self, "p_7", p_7)
            or assign(self, "p_8", p_8)
            or after(self)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8, p_9: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
            or assign(self, "p_6", p_6)
            or assign(self, "p_7", p_7)
            or assign(self, "p_8", p_8)
            or assign(self, "p_9", p_9)
            or after(self)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8, p_9, p_10: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
            or assign(self, "p_6", p_6)
            or assign(self, "p_7", p_7)
            or assign(self, "p_8", p_8)
            or assign(self, "p_9", p_9)
            or assign(self, "p_10", p_10)
            or after(self)
        ),
        lambda self, p_0, p_1, p_2, p_3, p_4, p_5, p_6, p_7, p_8, p_9, p_10, p_11: (
            assign(self, "p_0", p_0)
            or assign(self, "p_1", p_1)
            or assign(self, "p_2", p_2)
            or assign(self, "p_3", p_3)
            or assign(self, "p_4", p_4)
            or assign(self, "p_5", p_5)
            or assign(self, "p_6", p_6)
            or assign(self, "p_7", p_7)
            or assign(self, "p_8", p_8)
            or assign(self, "p_9", p_9)
            or assign(self, "p_10", p_10)
            or assign(self, "p_11", p_11)
            or after(self)
        ),
    ),
    "equal": (
        lambda self, other: () == () if self.__class__ is other.__class__ else NotImplemented,
        lambda self, other: (self.p_0,) == (other.p_0,) if self.__class__ is other.__class__ else NotImplemented,
        lambda self, other: (
            (
                self.p_0,
                self.p_1,
            )
            == (
                other.p_0,
                other.p_1,
            )
            if self.__class__ is other.__class__
            else NotImplemented
        ),
        lambda self, other: (
            (
                self.p_0,
                self.p_1,
                self.p_2,
            )
            == (
                other.p_0,
                other.p_1,
                other.p_2,
            )
            if self.__class__ is other.__class__
            else NotImplemented
        ),
        lambda self, other: (
            (
                self.p_0,
                self.p_1,
                self.p_2,
                self.p_3,
            )
            == (
                other.p_0,
                other.p_1,
                other.p_2,
                other.p_3,
            )
            if self.__class__ is other.__class__
            else NotImplemented
        ),
        lambda self, other: (
            (
                self.p_0,
                self.p_1,
                self.p_2,
                self.p_3,
                self.p_4,
            )
            == (
                other.p_0,
                other.p_1,
                other.p_2,
                other.p_3,
                other.p_4,
            )
            if self.__class__ is other.__class__
            else NotImplemented
        ),
        lambda self, other: (
            (
                self.p_0,
                self.p_1,
                self.p_2,
                self.p_3,
                self.p_4,
                self.p_5,
            )
            == (
                other.p_0,
                other.p_1,
                other.p_2,
                other.p_3,
                other.p_4,
                other.p_5,
            )
            if self.__class__ is other.__class__
            else NotImplemented
        ),
        lambda self, other: (
            (
                self.p_0,
                self.p_1,
                self.p_2,
                self.p_3,
                self.p_4,
                self.p_5,
                self.p_6,
            )
            == (
                other.p_0,
                other.p_1,
                other.p_2,
                other.p_3,
                other.p_4,
                other.p_5,
                other.p_6,
            )
            if self.__class__ is other.__class__
            else NotImplemented
        ),
    ),
    "hash": (
        lambda self: hash(()),
        lambda self: hash((self.p_0,)),
        lambda self: hash(
            (
                self.p_0,
                self.p_1,
            )
        ),
        lambda self: hash(
            (
                self.p_0,
                self.p_1,
                self.p_2,
            )
        ),
        lambda self: hash(
            (
                self.p_0,
                self.p_1,
                self.p_2,
                self.p_3,
            )
        ),
        lambda self: hash(
            (
                self.p_0,
                self.p_1,
                self.p_2,
                self.p_3,
                self.p_4,
            )
        ),
        lambda self: hash(
            (
                self.p_0,
                self.p_1,
                self.p_2,
                self.p_3,
                self.p_4,
                self.p_5,
            )
        ),
    ),
}
