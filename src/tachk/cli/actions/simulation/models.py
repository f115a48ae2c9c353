"""Models as simulations and their judges read them: with floating point variables."""

from __future__ import annotations

from tachk.api import Model
from tachk.loading.load import load_model


def simulated_model(path: str, **constants: int | bool | str) -> Model:
    """As `tachk.api.load`."""
    return Model(load_model(path, constants, keeps_doubles=True), path, tuple(constants))
