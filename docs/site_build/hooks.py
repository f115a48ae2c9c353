"""What mkdocs calls: generated files become part of the site, and links and fences of the pages what mkdocs knows."""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
if find_spec("tachk") is None:
    sys.path.append(str(ROOT / "src"))

from mkdocs.structure.files import File, Files  # noqa: E402

from docs.site_build import highlighting  # noqa: E402
from docs.site_build.contents import Contents, build_contents  # noqa: E402
from docs.site_build.markdown import bars_in_tables, titled_fences  # noqa: E402
from docs.site_build.site_files import expanded  # noqa: E402

HOME = "README.md"
"""The page that has the whole width."""

WEIGHTS = {"reference/commands/": 2, "tutorial": 2, "decisions/": 0.5, "performance": 0.5, "history": 0.2}
"""How much pages count in the search, by how their paths begin; 1 without an entry."""

_built: list[Contents] = []
"""What the build in progress has generated."""


def on_config(config: Any) -> Any:
    """Generates the pages, and puts them into the navigation."""
    highlighting.register()
    _built[:] = [build_contents()]
    config.nav = expanded(config.nav, _built[0].sections)
    return config


def on_files(files: Files, config: Any) -> Files:
    """Adds the generated files."""
    for file in _built[0].files:
        files.append(File.generated(config, file.path, content=file.content))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """The text of a page as the site needs it."""
    path = page.file.src_uri
    if path == HOME:
        page.meta["hide"] = ["navigation", "toc"]
    page.meta["search"] = search_of(path)
    origins = {file.path: file.origin for file in _built[0].files}
    origin = origins.get(path) or f"docs/{path}"
    return bars_in_tables(titled_fences(_built[0].links.rewritten(markdown, origin, path)))


def search_of(path: str) -> dict[str, Any]:
    """How the search treats a page: it leaves out listings of files, and prefers what a reader looks for first."""
    if path.startswith("source/"):
        return {"exclude": True}
    return {"boost": next((weight for begin, weight in WEIGHTS.items() if path.startswith(begin)), 1)}
