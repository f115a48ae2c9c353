"""Models as simulations have them: with floating point variables and hybrid clocks, which a search leaves out."""

from __future__ import annotations

from pathlib import Path

from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.frontend.hybrid_clocks import hybrid_clocks
from tachk.frontend.loaded import LoadedModel


def simulated(loaded: LoadedModel, path: str) -> LoadedModel:
    """The model with the floating point variables and hybrid clocks that a search leaves out, if it was read."""
    leaves_out = any(warning.code == "W0406" for warning in loaded.warnings) or bool(loaded.refusals)
    if not leaves_out and not hybrid_clocks(loaded.items):
        return loaded
    constants = {name: value.span.text for name, value in loaded.overrides.items()}
    written: str | Source = path if Path(path).is_file() else loaded.document.span.source
    return load_model(written, constants, keeps_doubles=True)
