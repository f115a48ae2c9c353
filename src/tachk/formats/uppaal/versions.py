"""The versions of UPPAAL whose language is known. Imports nothing heavy."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tachk.base.operators import BinaryOperator


class UppaalVersion(StrEnum):
    UPPAAL_4_1 = "uppaal-4.1"
    UPPAAL_5_0 = "uppaal-5.0"

    @property
    def full_name(self) -> str:
        return self.value.replace("uppaal-", "UPPAAL ")

    @property
    def number(self) -> tuple[int, int]:
        return (4, 1) if self is UppaalVersion.UPPAAL_4_1 else (5, 0)

    def knows(self, operator: BinaryOperator) -> bool:
        return operator.since is not None and operator.since <= self.number
