from __future__ import annotations

import json

from hypothesis import given, settings
from hypothesis import strategies as st

from tachk.report.json_text import json_text

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


@settings(max_examples=40)
@given(VALUES)
def test_it_is_the_same_value(value: object) -> None:
    assert json.loads(json_text(value)) == value


def test_what_fits_on_a_line_stands_on_one() -> None:
    value = {"short": [1, 2], "long": ["x" * 60] * 3}
    lines = json_text(value).splitlines()
    assert lines[0] == "{"
    assert lines[1] == ' "short": [1, 2],'
    assert lines[2] == ' "long": ['
    assert len(lines) == 8
