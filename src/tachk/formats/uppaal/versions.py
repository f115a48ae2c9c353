"""The versions of UPPAAL whose language is known. Imports nothing heavy."""

from __future__ import annotations

from enum import StrEnum


class Version(StrEnum):
    UPPAAL_4_1 = "uppaal-4.1"
    UPPAAL_5_0 = "uppaal-5.0"

    @property
    def full_name(self) -> str:
        return self.value.replace("uppaal-", "UPPAAL ")
