"""The model that recordings are held against, where the `recording` of a model names another one."""

from __future__ import annotations

import os
from collections.abc import Iterable

from tachk.formats.loading.load import load_model
from tachk.frontend.loaded import LoadedModel


def recorded_model(loaded: LoadedModel, path: str, definitions: Iterable[str]) -> LoadedModel:
    """The model that the `recording` of a model names, or the model itself.

    Args:
        path: of the model; the other one is named relative to it.
        definitions: the constants that were given another value: they have it in both.

    Raises UsageError, InputError.
    """
    named = loaded.recording.model if loaded.recording is not None else None
    if named is None:
        return loaded
    other = os.path.join(os.path.dirname(path), named.path)
    own = dict(loaded.network.constants)
    given = {name: own[name] for name in definitions if name in own}
    if given:
        known = dict(load_model(other, {}).network.constants)
        given = {name: value for name, value in given.items() if name in known}
    return load_model(other, {**dict(named.constants), **given})
