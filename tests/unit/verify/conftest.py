"""A short way from a text to verdicts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tachk.base.job import followed
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.verify.verdict import Verdict
from tachk.verify.verify import verify


@pytest.fixture
def verdicts() -> Callable[..., dict[str, Verdict]]:
    """The verdicts of all properties of a model, by name; keywords go to `verify`."""

    def answer(text: str, **options: Any) -> dict[str, Verdict]:
        loaded = load_model(Source("model.ta", text))
        with followed(options.pop("progress", None)):
            return {v.query.name: v for v in verify(loaded.network, loaded.queries, **options)}

    return answer


@pytest.fixture
def answers(verdicts: Callable[..., dict[str, Verdict]]) -> Callable[..., dict[str, str]]:
    """The answers of all properties of a model as words, by name; keywords go to `verify`."""

    def answer(text: str, **options: Any) -> dict[str, str]:
        return {name: verdict.answer.value for name, verdict in verdicts(text, **options).items()}

    return answer
