"""Files of the repository as pages of the site: documents as they are, programs and models as listings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from docs.site_build import markdown
from docs.site_build.site_files import SiteFile

LANGUAGES = {
    ".c": "c",
    ".csv": "text",
    ".hpp": "cpp",
    ".cpp": "cpp",
    ".json": "json",
    ".lark": "text",
    ".py": "python",
    ".stl": "stl",
    ".ta": "ta",
    ".toml": "toml",
    ".xml": "xml",
    ".yml": "yaml",
    ".yaml": "yaml",
}
"""The language of a listing, by the ending of its file; other texts have none."""

_LONGEST = 60_000
"""Characters of a listing; a longer file is cut, and says so."""


def document(root: Path, path: str, home: str, title: str = "") -> SiteFile:
    """A Markdown file of the repository as a page."""
    return SiteFile(home, (root / path).read_text(encoding="utf-8"), title or path, path)


def listings(root: Path, paths: Iterable[str], homes: Mapping[str, str]) -> tuple[dict[str, str], list[SiteFile]]:
    """Pages for files and folders that pages link to, and that have no other home.

    Returns:
        the home of each, and the pages.
    """
    found: dict[str, str] = {}
    waiting = [path for path in sorted(set(paths)) if path not in homes]
    while waiting:
        path = waiting.pop()
        if path in found or path in homes or not (root / path).exists():
            continue
        if (root / path).is_dir():
            found[path] = f"source/{_visible(path)}/index.md"
            waiting += (f"{path}/{child.name}" for child in _children(root / path))
        else:
            found[path] = f"source/{_visible(path)}.md"
    return found, [_page(root, path, home) for path, home in found.items()]


def _visible(path: str) -> str:
    """A path without leading dots: mkdocs leaves out what is hidden."""
    return "/".join(part.lstrip(".") for part in path.split("/"))


def _children(folder: Path) -> list[Path]:
    return sorted(child for child in folder.iterdir() if child.is_file() and child.suffix in {*LANGUAGES, ".md"})


def _page(root: Path, path: str, home: str) -> SiteFile:
    if (root / path).is_dir():
        text = "\n".join(f"- [{child.name}]({child.name})" for child in _children(root / path))
        return SiteFile(home, markdown.joined(f"# {path}/", text), f"{path}/", f"{path}/index.md")
    content = (root / path).read_text(encoding="utf-8")
    if path.endswith(".md"):
        return SiteFile(home, content, path, path)
    cut = "" if len(content) <= _LONGEST else "The rest of this long file is left out."
    listing = markdown.fence(content[:_LONGEST], LANGUAGES.get(Path(path).suffix, "text"))
    return SiteFile(home, markdown.joined(f"# {path}", listing, cut), path)
