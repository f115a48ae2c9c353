"""Names that the user may have meant."""

from __future__ import annotations

from collections.abc import Iterable


def closest(name: str, candidates: Iterable[str], likeness: float = 0.6) -> str | None:
    """The candidate most like a misspelt name, upper and lower case being alike; None if none is like it.

    Args:
        likeness: from 0 to 1, as `difflib` measures it.
    """
    from difflib import get_close_matches

    by_lower = {candidate.lower(): candidate for candidate in candidates}
    close = get_close_matches(name.lower(), by_lower, n=1, cutoff=likeness)
    return by_lower[close[0]] if close else None


def unknown_key(name: str, candidates: Iterable[str]) -> KeyError:
    """The error of a mapping that has no such name, with those it has."""
    return KeyError(f"{name!r}; there are {', '.join(map(repr, candidates)) or 'none'}")


def did_you_mean(name: str, candidates: Iterable[str]) -> str | None:
    """A help text that names the known name closest to a misspelt one, if one is close."""
    found = closest(name, candidates, 0.7)
    return f"did you mean `{found}`?" if found else None
