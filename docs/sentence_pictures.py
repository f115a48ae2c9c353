"""Makes the catalogue in docs/sentences.md and its pictures: `python docs/sentence_pictures.py`.

Each picture is a short run of which the example sentence is true; a test checks that, and that all is up to date.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from tachk.base.span import Source
from tachk.logic.patterns import CATALOGUE, Pattern, patterns
from tachk.logic.sentences import meaning
from tachk.syntax.formulas.printer import print_formula
from tachk.syntax.sentences.parser import parse_sentence
from tachk.syntax.sentences.printer import print_sentence

DOCS = Path(__file__).resolve().parent
PAGE = DOCS / "sentences.md"
FOLDER = DOCS / "sentences"
BEGIN, END = "<!-- begin catalogue -->", "<!-- end catalogue -->"

LAST = 14
"""Seconds that a picture shows."""


@dataclass(frozen=True, slots=True)
class Mark:
    """Something beside the signals.

    Attributes:
        kind: ``some`` (true at some instant of the window), ``all`` (throughout), ``none`` (at no instant), ``length``
            (a dimension), ``scope``.
        signal: the row it belongs to; of a scope, its name.
        label: above it in the middle, or with ``<`` at its begin.
    """

    kind: str
    signal: str
    begin: int
    end: int
    label: str = ""


@dataclass(frozen=True, slots=True)
class Picture:
    """Attributes:
    waves: for each signal the intervals ``[begin, end)`` in which it is true, or the instants from which it has values.
    instants: from which time is counted, drawn as dotted lines.
    """

    waves: dict[str, str]
    marks: tuple[str, ...] = ()
    instants: tuple[int, ...] = ()


PICTURES: dict[str, Picture] = {
    "universality": Picture({"p": "0-14"}),
    "absence": Picture({"p": ""}),
    "existence": Picture({"p": "9-11"}, ("some p 0 14",)),
    "bounded existence": Picture({"p": "3-4 9-11"}, ("some p 0 5 5 s",), (0,)),
    "initial response": Picture({"q": "4-8"}, ("some q 0 5 5 s",), (0,)),
    "bounded recurrence": Picture({"q": "1-2 6-7 11-14"}, ("length q 2 6 ≤ 5 s", "length q 7 11 ≤ 5 s")),
    "implication": Picture({"p": "2-4 8-10", "q": "1-6 8-10"}, ("all q 2 4", "all q 8 10")),
    "exclusion": Picture({"p": "2-6 10-12", "q": "0-1 7-9"}, ("none q 2 6", "none q 10 12")),
    "bounded response": Picture({"p": "2-4", "q": "6-9"}, ("some q 2 7 5 s",), (2,)),
    "bounded response to an edge": Picture({"p": "2-13", "q": "4-5"}, ("some q 2 7 5 s",), (2,)),
    "response to a change": Picture(
        {"x": "0:1 2:4 8:3", "q": "5-6 8-9"}, ("some q 2 7 5 s", "some q 8 13 5 s"), (2, 8)
    ),
    "response": Picture({"p": "2-4 7-8", "q": "12-13"}, ("some q 2 14",), (2,)),
    "delayed response": Picture({"p": "2-3", "q": "5-7"}, ("some q 4 7 2 s to 5 s",), (2,)),
    "exact response": Picture({"p": "2-4", "q": "7-9"}, ("all q 7 9", "length p 2 7 5 s"), (2, 7)),
    "bounded invariance": Picture({"p": "2-4", "q": "2-10"}, ("all q 2 9 during p and 5 s longer",), (2,)),
    "bounded absence": Picture({"p": "2-4", "q": "0-1 10-12"}, ("none q 2 9 during p and 5 s longer",), (2,)),
    "bounded absence after an edge": Picture({"p": "2-13", "q": "0-1 8-10"}, ("none q 2 7 5 s",), (2,)),
    "response of minimum duration": Picture(
        {"p": "2-3", "q": "5-9"}, ("some q 2 7 <begins in 5 s", "length q 5 9 ≥ 2 s"), (2,)
    ),
    "response of maximum duration": Picture({"p": "2-3", "q": "5-6"}, ("some q 2 7 <5 s", "length q 5 6 ≤ 2 s"), (2,)),
    "response of bounded duration": Picture(
        {"p": "2-3", "q": "5-7"}, ("some q 2 7 <begins in 5 s", "length q 5 7 1 s to 2 s"), (2,)
    ),
    "response until": Picture({"p": "2-3", "q": "2-6", "r": "6-8"}, ("all q 2 6", "some r 2 7 5 s"), (2,)),
    "lasting response": Picture({"p": "3-5", "q": "3-14"}, ("all q 3 14",), (3,)),
    "minimum duration": Picture({"p": "2-7 9-14"}, ("length p 2 7 ≥ 5 s", "length p 9 14 ≥ 5 s")),
    "maximum duration": Picture({"p": "2-5 8-13"}, ("length p 2 5 ≤ 5 s", "length p 8 13 ≤ 5 s")),
    "precedence": Picture({"p": "7-9 11-13", "q": "4-5"}, ("none p 0 4",)),
    "bounded precedence": Picture({"p": "6-9", "q": "3-5"}, ("length q 5 9 ≤ 5 s",), (9,)),
    "response to a minimum duration": Picture(
        {"p": "1-3 6-11", "q": "9-10"}, ("length p 6 11 ≥ 3 s", "some q 6 11 5 s"), (6,)
    ),
    "response to a minimum duration, from its end": Picture(
        {"p": "1-8", "q": "7-9"}, ("length p 1 4 3 s", "some q 4 9 5 s"), (1, 4)
    ),
    "response to a maximum duration": Picture(
        {"p": "1-3 6-11", "q": "4-5"}, ("length p 1 3 ≤ 3 s", "some q 1 6 5 s"), (1,)
    ),
    "response to a maximum duration, from the fall": Picture(
        {"p": "1-3 6-11", "q": "7-8"}, ("length p 1 3 ≤ 3 s", "some q 3 8 5 s"), (3,)
    ),
    "response to a maximum duration, from its end": Picture(
        {"p": "1-3", "q": "7-8"}, ("length p 1 4 3 s", "some q 4 9 5 s"), (1, 4)
    ),
    "response to a bounded duration": Picture(
        {"p": "1-3 6-11", "q": "4-5"}, ("length p 1 3 1 s to 3 s", "some q 1 6 5 s"), (1,)
    ),
    "response to a bounded duration, from the fall": Picture(
        {"p": "1-3 6-11", "q": "7-8"}, ("length p 1 3 1 s to 3 s", "some q 3 8 5 s"), (3,)
    ),
    "absence before": Picture({"R": "8-10", "p": "9-12"}, ("scope before_R 0 8", "none p 0 8")),
    "absence after": Picture({"Q": "4-5", "p": "1-3"}, ("scope after_Q 4 14", "none p 4 14")),
    "absence between": Picture({"Q": "3-4", "R": "8-9", "p": "1-2 9-12"}, ("scope between_Q_and_R 3 8", "none p 3 8")),
    "absence after until": Picture(
        {"Q": "2-3 10-11", "R": "6-7", "p": "7-9"},
        ("scope after_Q_until_R 2 6", "none p 2 6", "scope after_Q_until_R 10 14", "none p 10 14"),
    ),
    "absence while": Picture({"Q": "3-8", "p": "1-2 9-12"}, ("scope while_Q 3 8", "none p 3 8")),
    "existence before": Picture({"R": "9-11", "p": "4-6"}, ("scope before_R 0 9", "some p 0 9")),
    "existence after": Picture({"Q": "3-4", "p": "1-2 9-11"}, ("scope after_Q 3 14", "some p 3 14")),
    "existence between": Picture({"Q": "2-3", "R": "9-10", "p": "6-7"}, ("scope between_Q_and_R 2 9", "some p 2 9")),
    "existence after until": Picture(
        {"Q": "2-3", "R": "9-10", "p": "6-7"}, ("scope after_Q_until_R 2 9", "some p 2 9")
    ),
    "bounded response before": Picture(
        {"R": "11-12", "p": "3-4 12-13", "q": "6-7"}, ("scope before_R 0 11", "some q 3 8 5 s"), (3,)
    ),
    "bounded response after": Picture(
        {"Q": "4-5", "p": "1-2 6-7", "q": "9-10"}, ("scope after_Q 4 14", "some q 6 11 5 s"), (6,)
    ),
    "bounded response between": Picture(
        {"Q": "2-3", "R": "11-12", "p": "4-5 13-14", "q": "7-8"},
        ("scope between_Q_and_R 2 11", "some q 4 9 5 s"),
        (4,),
    ),
    "bounded response after until": Picture(
        {"Q": "2-3", "R": "11-12", "p": "4-5 13-14", "q": "7-8"},
        ("scope after_Q_until_R 2 11", "some q 4 9 5 s"),
        (4,),
    ),
    "bounded response while": Picture(
        {"Q": "3-8", "p": "1-2 6-7", "q": "9-10"}, ("scope while_Q 3 8", "some q 6 11 5 s"), (6,)
    ),
    "precedence between": Picture(
        {"Q": "2-3", "R": "12-13", "p": "1-2 8-9", "q": "5-6"}, ("scope between_Q_and_R 2 12", "none p 2 5")
    ),
    "bounded recurrence between": Picture(
        {"Q": "1-2", "R": "11-12", "q": "5-6"},
        ("scope between_Q_and_R 1 11", "length q 1 5 ≤ 5 s", "length q 6 11 ≤ 5 s"),
    ),
    "bounded recurrence while": Picture(
        {"Q": "1-11", "q": "5-6"}, ("scope while_Q 1 11", "length q 1 5 ≤ 5 s", "length q 6 11 ≤ 5 s")
    ),
}


def runs(wave: str) -> list[tuple[int, int]]:
    """The intervals ``[begin, end)`` of a truth value."""
    pairs = (piece.split("-") for piece in wave.split())
    return [(int(begin), int(end)) for begin, end in pairs]


def values(wave: str) -> list[tuple[int, int]]:
    """The instants from which a number has a value, with the value."""
    pairs = (piece.split(":") for piece in wave.split())
    return [(int(instant), int(value)) for instant, value in pairs]


def marks(picture: Picture) -> Iterator[Mark]:
    for text in picture.marks:
        found = re.fullmatch(r"(\w+) (\w+) (\d+) (\d+)(?: (.+))?", text)
        assert found is not None, text
        kind, signal, begin, end, label = found.groups()
        yield Mark(kind, signal, int(begin), int(end), label or "")


# ---- drawing -------------------------------------------------------------------------------------------------------

LEFT, UNIT, ROW, HIGH, TOP = 34, 26, 46, 14, 14

STYLE = """\
text{font:12px "DejaVu Sans",Verdana,Arial,sans-serif}
.name{font-weight:bold}
.label{font-size:11px;text-anchor:middle}
.left{text-anchor:start}
.wave{fill:none;stroke:#000;stroke-width:1.6}
.true{fill:#bbb}
.some{fill:none;stroke:#000;stroke-dasharray:5 3}
.all{fill:none;stroke:#000;stroke-width:2.4}
.none{fill:url(#hatch);stroke:#000;stroke-width:.8}
.thin{stroke:#000;stroke-width:.9;fill:none}
.instant{stroke:#000;stroke-width:.9;stroke-dasharray:1.5 3}
.scope{stroke:#000;stroke-width:3}
.tick{font-size:10px;text-anchor:middle;fill:#444}"""

HATCH = """\
<defs><pattern id="hatch" width="6" height="6" patternUnits="userSpaceOnUse" patternTransform="rotate(45">\
<path d="M0 0V6" stroke="#000" stroke-width=".9"/></pattern></defs>"""


def place(time: int) -> int:
    return LEFT + time * UNIT


def draw(pattern: Pattern) -> str:
    """The picture of a pattern as SVG."""
    picture = PICTURES[pattern.name]
    scopes = [mark for mark in marks(picture) if mark.kind == "scope"]
    top = TOP + (22 if scopes else 0)
    base = {name: top + ROW * number + 30 for number, name in enumerate(picture.waves)}
    bottom = top + ROW * len(base) + 4
    width, height = place(LAST) + 14, bottom + 20
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}" height="{height}"',
        f'viewBox="0 0 {width:g} {height}">',
        f"<title>{escape(pattern.example)}</title>",
        f"<style>{STYLE}</style>",
        HATCH,
        f'<rect width="{width:g}" height="{height}" fill="#fff"/>',
        *(_scope(mark) for mark in scopes),
    ]
    for name, wave in picture.waves.items():
        parts += _values(name, values(wave), base[name]) if ":" in wave else _truth(name, runs(wave), base[name])
    parts += [_instant(instant, min(base.values()) - HIGH - 6, bottom) for instant in picture.instants]
    for mark in marks(picture):
        if mark.kind != "scope":
            parts += _window(mark, base[mark.signal])
    parts += _axis(bottom)
    return "\n".join((*parts, "</svg>", ""))


def _scope(mark: Mark) -> str:
    begin, end = place(mark.begin), place(mark.end)
    words = escape(mark.signal.replace("_", " "))
    return (
        f'<path class="scope" d="M{begin} {TOP + 12}H{end}"/>'
        f'<path class="thin" d="M{begin} {TOP + 7}v10M{end} {TOP + 7}v10"/>'
        f'<text class="label" x="{(begin + end) / 2:g}" y="{TOP + 5}">{words}</text>'
    )


def _truth(name: str, intervals: Sequence[tuple[int, int]], base: int) -> Iterator[str]:
    yield f'<text class="name" x="8" y="{base}">{escape(name)}</text>'
    path = f"M{place(0)} {base}"
    for begin, end in intervals:
        width = (end - begin) * UNIT
        yield f'<rect class="true" x="{place(begin)}" y="{base - HIGH}" width="{width}" height="{HIGH}"/>'
        path += f"H{place(begin)}V{base - HIGH}H{place(end)}"
        path += f"V{base}" if end < LAST else ""
    path += "" if intervals and intervals[-1][1] >= LAST else f"H{place(LAST)}"
    yield f'<path class="wave" d="{path}"/>'


def _values(name: str, steps: Sequence[tuple[int, int]], base: int) -> Iterator[str]:
    yield f'<text class="name" x="8" y="{base}">{escape(name)}</text>'
    ends = [*(begin for begin, _ in steps[1:]), LAST]
    for (begin, value), end in zip(steps, ends, strict=True):
        yield (
            f'<rect class="wave" x="{place(begin)}" y="{base - HIGH}" width="{(end - begin) * UNIT}" height="{HIGH}"/>'
            f'<text class="label" x="{(place(begin) + place(end)) / 2:g}" y="{base - 3}">{value}</text>'
        )


def _instant(instant: int, top: int, bottom: int) -> str:
    return f'<path class="instant" d="M{place(instant)} {top}V{bottom}"/>'


def _window(mark: Mark, base: int) -> Iterator[str]:
    begin, end = place(mark.begin), place(mark.end)
    middle = (begin + end) / 2
    if mark.kind == "length":
        y = base - HIGH - 9
        yield (
            f'<path class="thin" d="M{begin} {y - 4}v8M{end} {y - 4}v8M{begin} {y}H{end}'
            f'M{begin + 5} {y - 3}L{begin} {y}l5 3M{end - 5} {y - 3}L{end} {y}l-5 3"/>'
            f'<text class="label" x="{middle:g}" y="{y - 6}">{escape(mark.label)}</text>'
        )
        return
    top, height = base - HIGH - 4, HIGH + 8
    yield f'<rect class="{mark.kind}" x="{begin}" y="{top}" width="{end - begin}" height="{height}"/>'
    if mark.label.startswith("<"):
        # Beside a length that is drawn above the same row.
        yield f'<text class="label left" x="{begin}" y="{top - 4}">{escape(mark.label[1:])}</text>'
    elif mark.label:
        yield f'<text class="label" x="{middle:g}" y="{top - 4}">{escape(mark.label)}</text>'


def _axis(y: int) -> Iterator[str]:
    ticks = "".join(f"M{place(time)} {y}v4" for time in range(LAST + 1))
    yield f'<path class="thin" d="M{place(0)} {y}H{place(LAST)}{ticks}"/>'
    for time in range(0, LAST, 5):
        yield f'<text class="tick" x="{place(time)}" y="{y + 15}">{time}{" s" if time else ""}</text>'


# ---- the page ------------------------------------------------------------------------------------------------------


def file_name(pattern: Pattern) -> str:
    return re.sub(r"[^a-z]+", "_", pattern.name.lower()) + ".svg"


def catalogue() -> str:
    """The tables of the page."""
    lines: list[str] = []
    for family in CATALOGUE:
        lines += [
            "",
            f"### {family.title}",
            "",
            "| sentence | formula | observer | meaning | picture |",
            "|---|---|---|---|---|",
        ]
        for pattern in family.patterns:
            formula = pattern.formula.replace("|", "\\|")
            lines.append(
                f"| {pattern.example} | `{formula}` | {pattern.shape or '–'} | {pattern.name}: {pattern.meaning} "
                f"| ![{pattern.name}](sentences/{file_name(pattern)}) |"
            )
    return "\n".join((*lines, *scoped_patterns())).strip()


SCOPES = ("", "before R, ", "after Q, ", "between Q and R, ", "after Q until R, ", "while Q, ")
DEMANDS = {
    "absence": "p must not occur.",
    "universality": "p must be true.",
    "existence": "p must occur.",
    "bounded existence": "p must occur within 5 s.",
    "response": "whenever p is true, eventually, q must be true.",
    "bounded response": "whenever p is true, within 5 s, q must be true.",
    "bounded invariance": "whenever p is true, q must stay true for at least 5 s.",
    "precedence": "whenever p is true, q must have been true.",
    "bounded recurrence": "p must occur at least every 5 s.",
    "minimum duration": "whenever p becomes true, p must stay true for at least 5 s.",
    "maximum duration": "whenever p becomes true, p must stay true for at most 5 s.",
}


def scoped_patterns() -> Iterator[str]:
    """Every pattern in every scope, with its formula."""
    yield from ("", "### Every pattern in every scope", "", "| pattern | sentence | formula |", "|---|---|---|")
    for name, demand in DEMANDS.items():
        for number, scope in enumerate(SCOPES):
            text = scope + demand
            sentence, found = parse_sentence(Source("catalogue", text))
            assert sentence is not None, found
            formula = print_formula(meaning(sentence)).replace("|", "\\|")
            yield f"| {'' if number else name} | {print_sentence(sentence)} | `{formula}` |"


def page(text: str) -> str:
    """The page with its catalogue made anew."""
    before, rest = text.split(BEGIN)
    return f"{before}{BEGIN}\n\n{catalogue()}\n\n{END}{rest.split(END)[1]}"


def main() -> None:
    FOLDER.mkdir(exist_ok=True)
    for pattern in patterns():
        (FOLDER / file_name(pattern)).write_text(draw(pattern), encoding="utf-8")
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
