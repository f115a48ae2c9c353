"""Checks a built site: `python -m docs.site_build.check_links build/site`.

Every link, picture, script and style within the site leads to a file of it, every anchor to an element, and nothing is
loaded from elsewhere. Links for readers to other sites are counted, not followed.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

_LOADED = {("link", "href"), ("script", "src"), ("img", "src"), ("source", "srcset"), ("iframe", "src")}
"""What a browser loads by itself."""
_FOLLOWED = {("a", "href")}
_NOT_LOADED = ("canonical", "next", "prev", "alternate")


class _Page(HTMLParser):
    """The anchors of a page, and the targets of its links."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.anchors: set[str] = set()
        self.followed: list[str] = []
        self.loaded: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.anchors |= {value for name in ("id", "name") if (value := values.get(name))}
        if tag == "link" and values.get("rel") in _NOT_LOADED:
            return
        for name, value in attrs:
            if value is not None and (tag, name) in _FOLLOWED:
                self.followed.append(value)
            elif value is not None and (tag, name) in _LOADED:
                self.loaded.append(value.split()[0] if name == "srcset" else value)


@dataclass(frozen=True, slots=True)
class Checked:
    """Attributes:
    pages: how many were read.
    links: how many links within the site were followed.
    elsewhere: links to other sites.
    broken: what leads nowhere, with the page that has it.
    """

    pages: int
    links: int
    elsewhere: frozenset[str]
    broken: tuple[str, ...]


@cache
def _read(path: Path) -> _Page:
    page = _Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page


def check(site: Path) -> Checked:
    """Follows every link of every page."""
    pages = sorted(site.rglob("*.html"))
    links = 0
    elsewhere: set[str] = set()
    broken: list[str] = []
    for path in pages:
        page = _read(path)
        name = path.relative_to(site)
        elsewhere |= {target for target in page.followed if _is_elsewhere(target)}
        broken += (f"{name}: loads {target}" for target in page.loaded if _is_elsewhere(target))
        inside = [each for each in (*page.followed, *page.loaded) if not _is_elsewhere(each)]
        links += len(inside)
        broken += (f"{name}: {each}: {fault}" for each in inside for fault in _faults(site, path, each))
    return Checked(len(pages), links, frozenset(elsewhere), tuple(dict.fromkeys(broken)))


def _is_elsewhere(target: str) -> bool:
    parts = urlsplit(target)
    return bool(parts.netloc) or parts.scheme not in ("", "file")


def _faults(site: Path, page: Path, target: str) -> Iterator[str]:
    parts = urlsplit(target)
    path = unquote(parts.path)
    file = page if not path else site / path[1:] if path.startswith("/") else page.parent / path
    if file.is_dir():
        yield "a folder, which does not open without a server"
    elif not file.is_file():
        yield "no such file"
    elif parts.fragment and file.suffix == ".html" and unquote(parts.fragment) not in _read(file.resolve()).anchors:
        yield "no such anchor"


def summary(checked: Checked) -> Mapping[str, int]:
    """The counts."""
    return {
        "pages": checked.pages,
        "links within the site": checked.links,
        "links to other sites": len(checked.elsewhere),
        "broken": len(checked.broken),
    }


def main() -> None:
    """The command."""
    checked = check(Path(sys.argv[1]).resolve())
    for each in checked.broken:
        print(each)
    print(", ".join(f"{count} {what}" for what, count in summary(checked).items()))
    sys.exit(bool(checked.broken))


if __name__ == "__main__":
    main()
