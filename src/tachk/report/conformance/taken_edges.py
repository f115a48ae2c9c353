"""The coverage that `tachk conform --coverage --format json` has told, for pictures of the automata."""

from __future__ import annotations

import json
from collections import Counter, defaultdict
from pathlib import Path
from typing import Any

from tachk.diagnostics.diagnostic import UsageError
from tachk.report.pictures import Taken
from tachk.syntax.picture_layout import EdgeKey


def read_taken(path: Path) -> Taken:
    """How often the edges of each template were taken, by all of its processes together.

    Raises UsageError for another file.
    """
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        return _taken(document["coverage"])
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError(f"{path}: {error}") from None
    except (ValueError, KeyError, TypeError):
        raise UsageError(
            f"{path} tells no coverage", "make it: tachk conform MODEL FILE... --coverage --format json -o FILE"
        ) from None


def _taken(edges: list[dict[str, Any]]) -> Taken:
    taken: dict[str, Counter[EdgeKey]] = defaultdict(Counter)
    seen: Counter[tuple[str, str, str]] = Counter()
    if not edges:
        raise KeyError("coverage")
    for edge in edges:
        ends = edge["process"], edge["source"], edge["target"]
        key = EdgeKey(edge["source"], edge["target"], seen[ends])
        taken[edge["template"]][key] += int(edge["times"])
        seen[ends] += 1
    return taken
