"""Looks at a built site in a browser, without a server: `python -m docs.site_build.in_browser build/site OUT`.

Needs `pip install playwright` and a Chromium (`playwright install chromium`, or the path of one in CHROMIUM). Opens
pages by file://, writes screenshots into OUT, and ends with status 1 if a page loads something from elsewhere or shows
an error in the console, if a search finds nothing, if a page is wider than a phone, or if there is no dark mode.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

DESKTOP = {"width": 1280, "height": 800}
PHONE = {"width": 390, "height": 844}

ON_A_PHONE = (
    "index.html",
    "tutorial.html",
    "language.html",
    "gallery/index.html",
    "gallery/fischer.html",
    "reference/commands/verify.html",
    "reference/grammar/templates.html",
    "reference/json/verify.html",
    "reference/messages/types.html",
    "reference/python/model.html",
)
"""Pages that must not be wider than a phone."""

LOOKED_AT = (
    "tutorial.html",
    "language.html",
    "semantics.html",
    "micro_xrce_dds.html",
    "gallery/index.html",
    "gallery/fischer.html",
    "reference/commands/index.html",
    "reference/commands/verify.html",
    "reference/grammar/templates.html",
    "reference/grammar/expressions.html",
    "reference/json/verify.html",
    "reference/messages/index.html",
    "reference/messages/types.html",
    "reference/python/index.html",
    "reference/python/model.html",
    "reference/python/functions.html",
)
"""Pages whose screenshots are made, in both colour schemes."""

SEARCHED = {
    "deadlock": "deadlock",
    "--max-seconds-each": "verify.html",
    "E0201": "names.html",
    "synthesize": "synthesi",
    "NetworkBuilder": "builder.html",
}
"""Words, and what the address of one of the first results contains."""


_BOTTOM = "[...document.querySelectorAll('article > *')].pop().getBoundingClientRect().bottom"
_BACKGROUND = "getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)"


@dataclass(frozen=True, slots=True)
class Site:
    """Attributes:
    browser: of playwright.
    folder: the built site.
    output: of the screenshots.
    faults: what was wrong so far.
    """

    browser: Any
    folder: Path
    output: Path
    faults: list[str]

    def address(self, page: str) -> str:
        return (self.folder / page).resolve().as_uri()

    @contextmanager
    def tab(self, scheme: str = "light", size: dict[str, int] | None = None) -> Iterator[Any]:
        """A new tab, in which errors and requests to elsewhere are faults."""
        context = self.browser.new_context(color_scheme=scheme, viewport=size or DESKTOP, reduced_motion="reduce")
        tab = context.new_page()
        tab.on("pageerror", lambda error: self.faults.append(f"{tab.url}: {error}"))
        tab.on("console", lambda line: self.faults.extend([f"{tab.url}: {line.text}"] * (line.type == "error")))
        tab.on("request", lambda sent: self.faults.extend([f"loads {sent.url}"] * sent.url.startswith("http")))
        yield tab
        context.close()


def look_at_pages(site: Site) -> None:
    """Screenshots in both schemes; the home page fits one screen, and the dark one is dark."""
    for scheme in ("light", "dark"):
        with site.tab(scheme) as tab:
            tab.goto(site.address("index.html"))
            tab.screenshot(path=site.output / f"home_{scheme}.png")
            if tab.evaluate(_BOTTOM) > DESKTOP["height"]:
                site.faults.append("index.html: does not fit one screen")
            if (sum(tab.evaluate(_BACKGROUND)[:3]) < 384) is not (scheme == "dark"):
                site.faults.append(f"index.html: {scheme} has the background {tab.evaluate(_BACKGROUND)}")
            for page in LOOKED_AT:
                tab.goto(site.address(page))
                tab.screenshot(path=site.output / f"{page.replace('/', '_').removesuffix('.html')}_{scheme}.png")


def search(site: Site) -> None:
    """What a reader types into the field at the top."""
    from playwright.sync_api import Error

    with site.tab() as tab:
        for number, (word, expected) in enumerate(SEARCHED.items()):
            tab.goto(site.address("index.html"))
            tab.click("label.md-search__icon[for=__search], .md-search__input")
            tab.type(".md-search__input", word)
            try:
                tab.wait_for_selector(".md-search-result__item a", timeout=15_000)
            except Error:
                site.faults.append(f"search for {word}: nothing found")
                continue
            links = tab.eval_on_selector_all(".md-search-result__item a", "all => all.slice(0, 12).map(a => a.href)")
            if not any(expected in link for link in links):
                site.faults.append(f"search for {word}: {expected} is not among {links}")
            tab.wait_for_timeout(300)
            tab.screenshot(path=site.output / f"search_{number}.png")


def look_on_a_phone(site: Site) -> None:
    """No page scrolls to the side."""
    with site.tab("light", PHONE) as tab:
        for page in ON_A_PHONE:
            tab.goto(site.address(page))
            width = tab.evaluate("document.scrollingElement.scrollWidth")
            if width > PHONE["width"]:
                site.faults.append(f"{page}: {width} pixels wide on a phone of {PHONE['width']}")
            tab.screenshot(path=site.output / f"phone_{page.replace('/', '_').removesuffix('.html')}.png")


def main() -> None:
    """The command."""
    from playwright.sync_api import sync_playwright

    folder, output = Path(sys.argv[1]), Path(sys.argv[2])
    output.mkdir(parents=True, exist_ok=True)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=os.environ.get("CHROMIUM") or None)
        site = Site(browser, folder, output, [])
        for look in (look_at_pages, search, look_on_a_phone):
            look(site)
        browser.close()
    for fault in dict.fromkeys(site.faults):
        print(fault)
    print(f"{len(list(output.glob('*.png')))} screenshots, {len(set(site.faults))} faults")
    sys.exit(bool(site.faults))


if __name__ == "__main__":
    main()
