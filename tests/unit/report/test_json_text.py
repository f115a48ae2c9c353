from __future__ import annotations

import json

from hypothesis import given, settings
from hypothesis import strategies as st

from tachk.report.json_text import LongList, json_pieces, json_text

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


def test_long_lists_are_written_item_by_item() -> None:
    items = [{"value": n, "of": ["x" * n, "é", None, 0.5], "empty": []} for n in range(150)]
    value = {"before": 1, "deep": [{"first": items}, {"more": [items, [1, 2]]}], "after": {}}
    long = LongList(items)
    streamed = {"before": 1, "deep": [{"first": long}, {"more": [long, [1, 2]]}], "after": {}}
    assert "".join(json_pieces(streamed)) == json_text(value)
    assert "".join(json_pieces(value)) == json_text(value)
    assert max(map(len, json_pieces(streamed))) < len(json_text(items[-1])) + 100
