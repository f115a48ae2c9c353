"""The coverage in a report of `tachk conform --coverage --format json`, for pictures of the automata."""

from __future__ import annotations

from collections import Counter, defaultdict
from pathlib import Path
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.formats.written_reports import check_report, read_json
from tachk.report.pictures import Taken
from tachk.syntax.picture_layout import EdgeKey

_HOW = "make it: tachk conform MODEL FILE... --coverage --format json -o FILE"


def read_taken(path: Path) -> Taken:
    """The number of times that the edges of each template were taken, by all of its processes together.

    Raises UsageError for another file.
    """
    document = read_json(path, _HOW)
    if not document.get("coverage"):
        raise UsageError(f"{path} contains no coverage", _HOW)
    check_report(document, "conform", path, _HOW)
    return _taken(document["coverage"])


def _taken(edges: list[dict[str, Any]]) -> Taken:
    taken: dict[str, Counter[EdgeKey]] = defaultdict(Counter)
    seen: Counter[tuple[str, str, str]] = Counter()
    for edge in edges:
        ends = edge["process"], edge["source"], edge["target"]
        key = EdgeKey(edge["source"], edge["target"], seen[ends])
        taken[edge["template"]][key] += edge["times"]
        seen[ends] += 1
    return taken
