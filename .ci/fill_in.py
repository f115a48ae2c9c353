"""Fills in the recipe for conda-forge and the formula for Homebrew, for the source distribution of a release.

python .ci/fill_in.py https://github.com/OWNER/NAME v0.3.0 dist/tachk-0.3.0.tar.gz FOLDER
"""

from __future__ import annotations

import hashlib
import sys
from pathlib import Path

TEMPLATES = ("conda/recipe.yaml", "homebrew/tachk.rb")
PACKAGING = Path(__file__).parents[1] / "packaging"


def fill_in(repository: str, tag: str, source: Path, folder: Path) -> None:
    """Writes the finished files into a folder."""
    values = {
        "VERSION": tag.removeprefix("v"),
        "REPOSITORY": repository,
        "SOURCE": f"{repository}/releases/download/{tag}/{source.name}",
        "SHA256": hashlib.sha256(source.read_bytes()).hexdigest(),
    }
    for name in TEMPLATES:
        text = (PACKAGING / name).read_text(encoding="utf-8")
        for word, value in values.items():
            text = text.replace(f"@{word}@", value)
        (folder / Path(name).name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    fill_in(sys.argv[1], sys.argv[2], Path(sys.argv[3]), Path(sys.argv[4]))
