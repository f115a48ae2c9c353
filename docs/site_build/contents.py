"""All that is generated for the site, and where the files of the repository are in it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from docs.site_build.commands import command_section, examples
from docs.site_build.gallery import gallery_section, models
from docs.site_build.grammar_diagrams import Draw, grammar_section
from docs.site_build.links import SiteLinks, local_links
from docs.site_build.listings import document, listings
from docs.site_build.messages import message_section
from docs.site_build.python_names import python_section
from docs.site_build.schemas import schema_section
from docs.site_build.site_files import ROOT, Section, SiteFile
from docs.site_build.verdicts import kept_verdicts

DOCUMENTS = {
    "README.md": ("project/readme.md", "README"),
    "CHANGELOG.md": ("project/changelog.md", "Changelog"),
    "CONTRIBUTING.md": ("project/contributing.md", "Contributing"),
    "SECURITY.md": ("project/security.md", "Security"),
    "RELEASING.md": ("project/releasing.md", "Releasing"),
    "plugins/munta/README.md": ("project/munta.md", "The plug-in for Munta"),
}
"""Documents outside of `docs` that the site shows, with their places and titles there."""

PLACES = {
    "models": "gallery/index.md",
    "models/classics": "gallery/index.md",
    "models/micro_xrce_dds": "gallery/index.md",
    "grammar": "reference/grammar/index.md",
    "src/tachk/__init__.py": "reference/python/index.md",
    "src/tachk/base/diagnostics/explanations": "reference/messages/index.md",
    "src/tachk/cli/commands": "reference/commands/index.md",
    "docs/queries": "queries/README.md",
    "docs/decisions": "decisions/README.md",
    "docs": "README.md",
}
"""Folders and files of the repository, with the pages that stand for them: who reads the repository finds the source
of what is generated."""


@dataclass(frozen=True, slots=True)
class Contents:
    """Attributes:
    sections: what is generated, by the folders that the navigation names.
    files: all generated files.
    links: where the files of the repository are.
    """

    sections: Mapping[str, Section]
    files: tuple[SiteFile, ...]
    links: SiteLinks


def pages_of_docs(root: Path = ROOT) -> dict[str, str]:
    """The text of every page that is written by hand, by its path in the repository."""
    return {
        path.relative_to(root).as_posix(): path.read_text(encoding="utf-8")
        for path in sorted((root / "docs").rglob("*.md"))
    }


def reference_sections(pages: Mapping[str, str], root: Path = ROOT, draw: Draw | None = None) -> dict[str, Section]:
    """What is generated from the code, by its folders; for `draw` see `grammar_section`."""
    sections = (
        command_section(examples(pages)),
        python_section(pages["docs/stability.md"]),
        message_section(),
        schema_section(root / "docs/schema"),
        grammar_section(draw),
    )
    return {section.folder: section for section in sections}


def all_sections(pages: Mapping[str, str], root: Path = ROOT) -> dict[str, Section]:
    """The reference, and the gallery with pictures and verdicts."""
    found = models(root)
    gallery = gallery_section(kept_verdicts(found), {path: pictures_of(path) for path in found}, root)
    return {**reference_sections(pages, root), gallery.folder: gallery}


def pictures_of(path: Path) -> dict[str, str]:
    """The SVG of each template of a model; templates that it imports stand in the models that hold them."""
    from tachk.report.pictures import draw_file

    return {picture.name: picture.svg for picture in draw_file(path, {}, None)}


def contents_of(sections: Mapping[str, Section], pages: Mapping[str, str], root: Path = ROOT) -> Contents:
    """Everything that the site needs beside the files of `docs`: the sections, and what pages link to."""
    documents = [
        document(root, path, home, title) for path, (home, title) in DOCUMENTS.items() if (root / path).exists()
    ]
    homes = {
        **PLACES,
        **{file.origin: file.path for file in documents},
        **{path: home for section in sections.values() for path, home in section.homes.items()},
    }
    linked = linked_files({**pages, **{file.origin: file.content for file in documents}})
    listed, listing_pages = listings(root, (path for path in linked if not path.startswith("docs/")), homes)
    project = Section("project/", tuple(documents))
    source = Section("source/", tuple(listing_pages))
    everything = {**sections, "project/": project, "source/": source}
    files = tuple(file for section in everything.values() for file in section.files)
    return Contents(everything, files, SiteLinks({**homes, **listed}))


def build_contents(root: Path = ROOT) -> Contents:
    """The whole of it."""
    pages = pages_of_docs(root)
    return contents_of(all_sections(pages, root), pages, root)


def linked_files(texts: Mapping[str, str]) -> Iterable[str]:
    """The files and folders of the repository to which texts link."""
    return sorted({path for origin, text in texts.items() for path in local_links(text, origin)})
