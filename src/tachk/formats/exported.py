"""Inputs and results of writing a model in another format. Imports nothing heavy."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tachk.base.records import dataclass

if TYPE_CHECKING:
    from tachk.formats.plain.plain_model import PlainRewriting


@dataclass(frozen=True, slots=True)
class Writing:
    """Options of the export of a model for choices that the format leaves open.

    Attributes:
        definitions: the names of the constants that were given another value when the model was loaded.
        repair_names: rename what a version of UPPAAL would not take as a name.
        observers: give temporal properties observers; otherwise they are comments for UPPAAL.
    """

    definitions: tuple[str, ...] = ()
    repair_names: bool = True
    observers: bool = False


@dataclass(frozen=True, slots=True)
class Exported:
    """Attributes:
    text: the content of the file.
    queries: the content of a .q file beside it; empty if there is none.
    steps: what was written differently than in the model.
    """

    text: str
    queries: str = ""
    steps: tuple[PlainRewriting, ...] = ()
