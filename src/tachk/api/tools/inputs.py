"""What calls of tools give: models and recordings as texts or paths."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from tachk.api.model import Model
from tachk.base.span import Source
from tachk.formats.loading.load import load_model

MODEL_TEXT = "<model>"
"""What messages call a model that is given as text."""

_NO_PATH = re.compile(r"[\n{};<]")

MODEL_SCHEMA: dict[str, Any] = {
    "type": "string",
    "minLength": 1,
    "description": "The text of a model in tachk's language (.ta, .xta) or UPPAAL's XML, or the path of its file.",
}

CONSTANTS_SCHEMA: dict[str, Any] = {
    "type": "object",
    "additionalProperties": {"type": ["integer", "boolean", "string"]},
    "default": {},
    "description": 'Other values for global constants of the model, such as {"N": 3}; a string is an expression.',
}


def model_source(given: str) -> str | Source:
    """The path of a file, or a text: only a text has a line break, a brace, a semicolon or an angle bracket."""
    return Source(MODEL_TEXT, given) if _NO_PATH.search(given) else given


def read_model(arguments: Mapping[str, Any], keeps_doubles: bool = False) -> Model:
    """The model of a call. Raises InputError and UsageError as `tachk.load`.

    Args:
        keeps_doubles: floating point variables are part of the states, as simulations have them.
    """
    source = model_source(arguments["model"])
    constants = arguments.get("constants", {})
    path = source if isinstance(source, str) else source.name
    return Model(load_model(source, constants, keeps_doubles=keeps_doubles), path, tuple(constants))


@contextmanager
def recorded_file(given: str, name: str) -> Iterator[tuple[str, str]]:
    """The path of a recording, and the beginning of it that no answer shall contain; empty where the call gave a path.

    Args:
        given: a path, or the text of a table, which has a line break.
        name: what answers call a text.
    """
    if "\n" not in given:
        yield given, ""
        return
    with TemporaryDirectory(prefix="tachk-") as folder:
        path = Path(folder) / name
        path.write_text(given, encoding="utf-8")
        yield str(path), str(Path(folder)) + path.anchor[-1:]
