"""Links of the repository in the site: a page of `docs` may link to any file, which the site has then, too."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from docs.site_build.markdown import CODE_OR_LINK

_ELSEWHERE = re.compile(r"[a-z][a-z0-9+.-]*:|#|//", re.IGNORECASE)
"""How a link begins that is not a path."""


def resolved(link: str, origin: str) -> str | None:
    """The path in the repository to which a link of a file leads, None where it leads elsewhere.

    Generated pages link to `/docs/tutorial.md`: a path from the top of the repository.
    """
    path = link.partition("#")[0]
    if not path or _ELSEWHERE.match(link):
        return None
    if path.startswith("/"):
        return posixpath.normpath(path[1:])
    return posixpath.normpath(posixpath.join(posixpath.dirname(origin), path))


def local_links(text: str, origin: str) -> Iterator[str]:
    """The paths in the repository to which a text links; what stands in code is not a link."""
    for found in CODE_OR_LINK.finditer(text):
        link = found["link"] or found["value"]
        if link is not None and (path := resolved(link, origin)) is not None:
            yield path


@dataclass(frozen=True, slots=True)
class SiteLinks:
    """Where the files of the repository are in the site.

    Attributes:
        homes: the path below `docs` for a path of the repository; files of `docs` need none.
    """

    homes: Mapping[str, str]

    def home(self, path: str) -> str | None:
        """The place in the site, or None if the file is not there."""
        if (home := self.homes.get(path)) is not None:
            return home
        return path.removeprefix("docs/") if path.startswith("docs/") else None

    def rewritten(self, text: str, origin: str, page: str) -> str:
        """A text with links that are right in the site.

        Args:
            origin: the file of the repository that the text is from.
            page: the path of its page below `docs`.
        """
        return replaced_links(text, lambda link: self._link(link, origin, page))

    def _link(self, link: str, origin: str, page: str) -> str:
        path = resolved(link, origin)
        home = None if path is None else self.home(path)
        if home is None:
            return link
        anchor = "".join(link.partition("#")[1:])
        return posixpath.relpath(home, posixpath.dirname(page)) + anchor


def replaced_links(text: str, replacement: Callable[[str], str]) -> str:
    """A text with other targets of its links."""

    def replace(found: re.Match[str]) -> str:
        if found["link"] is not None:
            return found["before"] + replacement(found["link"])
        if found["value"] is not None:
            return found["attribute"] + replacement(found["value"])
        return found[0]

    return CODE_OR_LINK.sub(replace, text)
