"""Model checking of networks of timed automata.

``tachk.load("train.ta", N=3).verify()`` reads a model, instantiates it and checks its properties; see `tachk.api`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tachk.api import (
        Answer,
        Extrapolation,
        InputError,
        Limits,
        Model,
        Options,
        Report,
        SearchOrder,
        TachkError,
        UnsupportedError,
        UsageError,
        Verdict,
        load,
    )

__version__ = "0.1.0"

__all__ = [
    "Answer",
    "Extrapolation",
    "InputError",
    "Limits",
    "Model",
    "Options",
    "Report",
    "SearchOrder",
    "TachkError",
    "UnsupportedError",
    "UsageError",
    "Verdict",
    "__version__",
    "load",
]


def __getattr__(name: str) -> object:
    """Loads `tachk.api` when it is first needed, so that ``tachk --version`` need not wait for it."""
    if name in __all__:
        return getattr(import_module("tachk.api"), name)
    raise AttributeError(f"module 'tachk' has no attribute {name!r}")
