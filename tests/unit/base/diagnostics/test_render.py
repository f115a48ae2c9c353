"""Diagnostics as text and as data."""

from __future__ import annotations

import re

from tachk.base.diagnostics.diagnostic import Diagnostic, Label
from tachk.base.diagnostics.render import WIDEST, render
from tachk.base.plain_data import PlainData
from tachk.base.span import NOWHERE, Source, Span


def at(text: str, part: str, name: str = "m.ta") -> Span:
    start = text.index(part)
    return Span(Source(name, text), start, start + len(part))


TEXT = "int a;\nint level = heigth;\nclock x;\n"


def test_the_full_form() -> None:
    span = at(TEXT, "heigth")
    label = Label(Span(span.source, 4, 5), "declared here")
    diagnostic = Diagnostic("E0201", "unknown name `heigth`", span, "did you mean `height`?", (label,))
    assert render(diagnostic) == (
        "m.ta:2:13: error[E0201]: unknown name `heigth`\n"
        "    2 | int level = heigth;\n"
        "      |             ^^^^^^\n"
        "    1 | int a;\n"
        "      |     - declared here\n"
        "help: did you mean `height`?"
    )


def test_places_on_one_line_share_it() -> None:
    span = at(TEXT, "heigth")
    diagnostic = Diagnostic("E0201", "m", span, None, (Label(Span(span.source, 11, 16), "of this"),))
    assert render(diagnostic).splitlines()[1:] == [
        "    2 | int level = heigth;",
        "      |             ^^^^^^",
        "      |     ----- of this",
    ]


def test_a_place_in_another_file_is_named() -> None:
    other = Label(at("int b;", "b", "other.ta"), "there")
    assert "  --> other.ta:1:5" in render(Diagnostic("E0201", "m", at(TEXT, "a"), None, (other,))).splitlines()


def test_tabs_and_wide_characters_keep_the_carets_in_place() -> None:
    text = "\tint 幅 = heigth;"
    _, line, carets = render(Diagnostic("E0201", "m", at(text, "heigth"))).splitlines()
    before = line[: line.index("heigth")]
    assert carets.index("^") == len(before) + 1, "a wide character takes two columns"


def test_a_long_line_is_clipped_around_the_place() -> None:
    text = "a" * 5000 + " here " + "b" * 5000
    _, line, carets = render(Diagnostic("E0101", "m", at(text, "here"))).splitlines()
    assert len(line) < WIDEST + 20
    assert line[carets.index("^") : carets.rindex("^") + 1] == "here"


def test_a_range_over_several_lines_is_marked_on_the_first() -> None:
    carets = render(Diagnostic("E0101", "m", at(TEXT, "level = heigth;\nclock"))).splitlines()[2]
    assert carets.count("^") == len("level = heigth;")


def test_ends_of_lines_and_texts() -> None:
    source = Source("m.ta", TEXT)
    assert render(Diagnostic("E0102", "m", Span(source, 6, 6))).splitlines()[2] == "      |       ^"
    assert render(Diagnostic("E0101", "m", Span(source, len(TEXT), len(TEXT)))).startswith("m.ta:4:1")
    assert render(Diagnostic("E0001", "m", Span(Source("m.ta", ""), 0, 0))) == "m.ta:1:1: error[E0001]: m"
    assert render(Diagnostic("E0001", "m", NOWHERE)) == "<built>: error[E0001]: m"


def test_control_characters_do_not_reach_the_terminal() -> None:
    assert "\x1b" not in render(Diagnostic("E0002", "m", at("int \x1b[31m a;", "a")))


def test_colour_only_adds_escape_sequences() -> None:
    diagnostic = Diagnostic("E0201", "m", at(TEXT, "heigth"), "h", (Label(at(TEXT, "level"), "l"),))
    coloured = render(diagnostic, colour=True)
    assert "\x1b[" in coloured
    assert re.sub(r"\x1b\[[0-9;]*m", "", coloured) == render(diagnostic)


def test_json() -> None:
    assert PlainData().of(Diagnostic("E0201", "m", at(TEXT, "heigth"), None, (Label(at(TEXT, "a"), "l"),))) == {
        "code": "E0201",
        "severity": "error",
        "message": "m",
        "help": None,
        "place": {"file": "m.ta", "line": 2, "column": 13, "end_line": 2, "end_column": 19},
        "labels": [
            {
                "text": "l",
                "place": {"file": "m.ta", "line": 1, "column": 5, "end_line": 1, "end_column": 6},
            }
        ],
    }
