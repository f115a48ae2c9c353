"""Syntax errors and what elaboration can still say are reported together."""

from __future__ import annotations

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model


def messages(text: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        load_model(Source("m.ta", text))
    return [f"{d.code} {d.span.text}" for d in caught.value.diagnostics]


PROCESS = "process P() { init location a; }\n"


def test_errors_of_intact_items_are_reported_beside_a_syntax_error() -> None:
    text = "int n = ;\n" + PROCESS + "process Q() { init location a { invariant z < 3; } }\nsystem P, Q, R;"
    assert messages(text) == ["E0101 ;", "E0201 z", "E0206 R"]


def test_an_item_with_a_syntax_error_is_not_evaluated_further() -> None:
    text = "process P() { init location a { invariant z < ; to b { guard y > 1; } } }\nsystem P;"
    assert len(messages(text)) == 1


def test_a_name_that_a_damaged_item_mentions_is_not_called_unknown() -> None:
    text = "int n m;\n" + PROCESS + "system P;\nproperty p : A[] m > 0;\nproperty q : A[] k > 0;"
    assert [m for m in messages(text) if m.startswith("E0201")] == ["E0201 k"]


def test_a_missing_system_line_is_not_complained_about_beside_a_syntax_error() -> None:
    assert all(not m.startswith("E0410") for m in messages("int n = ;\n" + PROCESS))
