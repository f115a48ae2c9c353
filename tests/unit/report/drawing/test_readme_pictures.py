"""The pictures of the README are those that the tool draws now."""

from __future__ import annotations

import runpy
from pathlib import Path
from types import SimpleNamespace

IMAGES = Path(__file__).resolve().parents[4] / "docs" / "images"
MAKE = SimpleNamespace(**runpy.run_path(str(IMAGES / "make.py")))


def test_the_pictures_of_the_readme_are_up_to_date() -> None:
    for name, text in MAKE.drawn().items():
        assert (IMAGES / name).read_text(encoding="utf-8") == text, "run python docs/images/make.py"


def test_they_are_light_or_dark_whatever_the_reader_prefers() -> None:
    light, dark = MAKE.themes(MAKE.automaton()).values()
    assert "prefers-color-scheme" not in light + dark
    assert light != dark
