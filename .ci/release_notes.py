"""The notes of a release: the section of a version in CHANGELOG.md.

python .ci/release_notes.py v0.3.0
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

CHANGELOG = Path(__file__).parents[1] / "CHANGELOG.md"


def release_notes(version: str) -> str:
    """The text below the heading of a version. Raises SystemExit where there is none, or nothing in it."""
    heading = re.escape(version.removeprefix("v"))
    text = CHANGELOG.read_text(encoding="utf-8")
    found = re.search(rf"^## \[?{heading}\]?[^\n]*\n(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
    if found is None or not found[1].strip():
        raise SystemExit(f"CHANGELOG.md has no section for {version}")
    return found[1].strip() + "\n"


if __name__ == "__main__":
    sys.stdout.write(release_notes(sys.argv[1]))
