"""The values of options go to the dataclasses that have fields of their names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tachk.base.records import fields


def distributed(given: Mapping[str, Any], *kinds: type) -> list[Any]:
    """The dataclasses of the arguments of a command: each value of an option goes to the field of its name."""
    left = dict(given)
    made = [kind(**{each.name: left.pop(each.name) for each in fields(kind) if each.name in left}) for kind in kinds]
    assert not left, f"options that no dataclass takes: {', '.join(left)}"
    return made
