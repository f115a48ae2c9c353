"""Short ways to load a text and to see what is found in it."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.frontend.loaded import LoadedModel


def complete(text: str) -> str:
    """The text with a process and a system line where it has none."""
    if "process " not in text:
        text += "\nprocess P() { state s; init s; }"
    if re.search(r"^\s*system ", text, re.MULTILINE) is None:
        text += "\nsystem P;"
    return text


@pytest.fixture
def load() -> Callable[..., LoadedModel]:
    def loader(text: str, **constants: int | bool | str) -> LoadedModel:
        return load_model(Source("model.ta", complete(text)), constants)

    return loader


@pytest.fixture
def find() -> Callable[..., list[tuple[str, str]]]:
    """Code and underlined text of every finding."""

    def finder(text: str, **constants: int | bool | str) -> list[tuple[str, str]]:
        found: tuple[Diagnostic, ...]
        try:
            loaded = load_model(Source("model.ta", complete(text)), constants)
            found = (*loaded.refusals, *loaded.warnings)
        except InputError as error:
            found = error.diagnostics
        return [(d.code, d.span.text) for d in found]

    return finder


@pytest.fixture
def edge() -> Callable[[str, str], str]:
    """A process with one edge with the given labels, behind the given declarations."""

    def text(declarations: str, labels: str) -> str:
        return f"{declarations}\nprocess P() {{ state s; init s; trans s -> s {{ {labels} }}; }}"

    return text
