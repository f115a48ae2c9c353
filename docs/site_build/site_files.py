"""What is generated for the site: files, and sections of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
"""The checkout."""


@dataclass(frozen=True, slots=True)
class SiteFile:
    """A file that mkdocs finds as if it stood in `docs`.

    Attributes:
        path: below `docs`, with slashes; a page ends with ``.md``.
        content: its text, Markdown for a page.
        title: of a page, as the navigation shows it; empty for other files.
        origin: the file of the repository that the text was taken from, to which its links are relative; empty where
            it was generated.
    """

    path: str
    content: str
    title: str = ""
    origin: str = ""


@dataclass(frozen=True, slots=True)
class Section:
    """A folder of generated files.

    Attributes:
        folder: below `docs`, with a slash at the end: ``reference/commands/``. The navigation in `mkdocs.yml` names it.
        files: pages in the order of the navigation, the first one an overview; then files that they need.
        homes: the page that stands for a file of the repository, such as a model for its page of the gallery.
        groups: headings of the navigation, each with the paths of its pages; empty for one flat list.
    """

    folder: str
    files: tuple[SiteFile, ...]
    homes: Mapping[str, str] = field(default_factory=dict)
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def navigation(self) -> list[dict[str, object]]:
        """The section as mkdocs wants it: titles and paths, lists for headings."""
        titles = {file.path: file.title for file in self.files if file.path.endswith(".md")}
        grouped = {path for paths in self.groups.values() for path in paths}
        entries: list[dict[str, object]] = [{title: path} for path, title in titles.items() if path not in grouped]
        for name, paths in self.groups.items():
            entries.append({name: [{titles[path]: path} for path in paths]})
        return entries


def expanded(navigation: object, sections: Mapping[str, Section]) -> object:
    """A navigation in which each folder of a section is replaced by its pages."""
    if isinstance(navigation, dict):
        return {title: expanded(entry, sections) for title, entry in navigation.items()}
    if isinstance(navigation, list):
        return [each for entry in navigation for each in _spliced(expanded(entry, sections))]
    if isinstance(navigation, str) and navigation in sections:
        return sections[navigation].navigation()
    return navigation


def _spliced(entry: object) -> list[object]:
    """A section without a title of its own, as its pages."""
    return entry if isinstance(entry, list) else [entry]


def paths_of(navigation: object) -> Iterator[str]:
    """The paths that a navigation names."""
    if isinstance(navigation, dict):
        navigation = list(navigation.values())
    if isinstance(navigation, list):
        for entry in navigation:
            yield from paths_of(entry)
    elif isinstance(navigation, str):
        yield navigation
