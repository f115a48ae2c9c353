"""The least and the greatest value that a parameter which is mined may have, as they are written."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UsageError

_NUMBER = r"-?\d+(?:\.\d+)?"
_RANGE = re.compile(rf"\s*(?P<low>{_NUMBER})\s*\.\.\s*(?P<high>{_NUMBER})\s*", re.ASCII)
_NAMED = re.compile(r"\s*(?P<name>[A-Za-z_]\w*)\s*=(?P<range>.*)", re.ASCII | re.DOTALL)

Bound = float | str | Fraction


def named_ranges(texts: Iterable[str], option: str) -> dict[str, tuple[Bound, Bound]]:
    """The ranges of texts such as ``T=0..200``. Raises UsageError."""
    found: dict[str, tuple[Bound, Bound]] = {}
    for text in texts:
        named = _NAMED.fullmatch(text)
        match = None if named is None else _RANGE.fullmatch(named["range"])
        if named is None or match is None:
            raise UsageError(f"{option} {text}: expected NAME=LOW..HIGH", f"for example {option} T=0..200")
        if named["name"] in found:
            raise UsageError(f"{option} {named['name']} is given twice")
        found[named["name"]] = (match["low"], match["high"])
    return found


def given_ranges(over: object) -> dict[str, tuple[Bound, Bound]]:
    """The ranges that a program gives: a text as for `named_ranges`, several, or a dictionary from names to two values,
    to a ``range`` of whole numbers, or to a text such as ``"0..200"``. Raises UsageError."""
    if isinstance(over, str):
        return named_ranges([over], "over:")
    if isinstance(over, Mapping):
        return {str(name): _range(str(name), values) for name, values in over.items()}
    if isinstance(over, Iterable):
        texts = list(over)
        if all(isinstance(text, str) for text in texts):
            return named_ranges(texts, "over:")
    raise UsageError(f"over: {over!r} does not say between which values a parameter lies", _EXAMPLE)


_EXAMPLE = 'such as over={"T": (0, 200)} or over="T=0..200"'


def _range(name: str, values: object) -> tuple[Bound, Bound]:
    if isinstance(values, range) and values and abs(values.step) == 1:
        return min(values), max(values)
    match = _RANGE.fullmatch(values) if isinstance(values, str) else None
    if match is not None:
        return match["low"], match["high"]
    if isinstance(values, Sequence) and not isinstance(values, str | range) and len(values) == 2:
        return values[0], values[1]
    raise UsageError(f"over: {name} = {values!r} is not a least and a greatest value", _EXAMPLE)
