"""The values of constants over which a table goes."""

from __future__ import annotations

import re
from collections.abc import Iterable

from tachk.diagnostics.diagnostic import UsageError

_RANGE = re.compile(r"\s*(?P<name>[A-Za-z_]\w*)\s*=\s*(?P<low>-?\d+)\s*(\.\.\s*(?P<high>-?\d+)\s*)?", re.ASCII)
_MOST_ROWS = 10_000


def parse_ranges(texts: Iterable[str]) -> dict[str, range]:
    """``A=0..3,B=5`` as the values of each name. Raises UsageError."""
    found: dict[str, range] = {}
    for text in (part for each in texts for part in each.split(",")):
        match = _RANGE.fullmatch(text)
        if match is None:
            raise UsageError(f"--over {text}: expected NAME=A..B", "for example --over LOSSES=0..3,SPIN=4")
        low = int(match["low"])
        high = low if match["high"] is None else int(match["high"])
        if high < low:
            raise UsageError(f"--over {text}: {high} is less than {low}")
        if match["name"] in found:
            raise UsageError(f"--over {match['name']} is given twice")
        found[match["name"]] = range(low, high + 1)
    rows = 1
    for values in found.values():
        rows *= len(values)
    if rows > _MOST_ROWS:
        raise UsageError(f"--over asks for {rows} rows, and {_MOST_ROWS} are the most")
    return found
