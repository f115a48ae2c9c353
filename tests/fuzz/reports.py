"""Reports of tachk in JSON with some parts changed, missing, or put elsewhere."""

from __future__ import annotations

import json
from collections.abc import Iterator
from random import Random
from typing import Any

_VALUES: tuple[Any, ...] = (
    None,
    True,
    0,
    -1,
    2.5,
    10**15,
    10**30,
    1e308,
    float("nan"),
    float("inf"),
    "",
    "x",
    "\ud800",
    "\0",
    "é\n<script>",
    "1/0",
    "7/2",
    "9" * 300,
    [],
    [1],
    {},
    {"a": 1},
)
_MOST_ITEMS = 6
"""So many items of a list are changed."""


def damaged(random: Random, report: object) -> Any:
    """A copy of a report, with one to three parts that are wrong."""
    document = json.loads(json.dumps(report))
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        places = [place for place in _places(document) if place]
        if not places:
            break
        *way, last = random.choice(places)
        inner = _at(document, way)
        match random.randrange(4):
            case 0:
                del inner[last]
            case 1:
                inner[last] = json.loads(json.dumps(_at(document, random.choice(places))))
            case _:
                inner[last] = random.choice(_VALUES)
    return document


def _places(part: object) -> Iterator[list[Any]]:
    yield []
    items = part.items() if isinstance(part, dict) else enumerate(part[:_MOST_ITEMS]) if isinstance(part, list) else ()
    for key, inner in items:
        for place in _places(inner):
            yield [key, *place]


def _at(document: Any, way: list[Any]) -> Any:
    for key in way:
        document = document[key]
    return document
