"""The reference of diagnostics: every code with the rule behind it, an example, and the same mended."""

from __future__ import annotations

from importlib.resources import files
from itertools import takewhile

from docs.site_build import markdown
from docs.site_build.site_files import Section, SiteFile
from tachk.base.diagnostics.explanation import Explanation, explanations, groups

FOLDER = "reference/messages/"

_WARNING = "W"


def message_section() -> Section:
    """An overview with every code, and a page for each group of codes."""
    pages = tuple(
        SiteFile(_path(group), _page(group), markdown.plain(group.replace("_", " ").capitalize())) for group in groups()
    )
    return Section(FOLDER, (SiteFile(f"{FOLDER}index.md", _overview(), "All messages"), *pages))


def _path(group: str) -> str:
    return f"{FOLDER}{group}.md"


def _overview() -> str:
    rows = sorted(
        (code, group, explanation.title) for group in groups() for code, explanation in explanations(group).items()
    )
    tables = [
        markdown.joined(
            f"## {title}",
            markdown.table(
                ("code", "what is wrong"),
                [
                    (f"[{code}]({group}.md#{code.lower()})", markdown.plain(what))
                    for code, group, what in rows
                    if code.startswith(_WARNING) is warns
                ],
            ),
        )
        for title, warns in (("Errors", False), ("Warnings", True))
    ]
    return markdown.joined(
        "# Messages",
        "Each message of tachk has a code. `tachk explain E0201` prints the entry of a code, which stands here, too.",
        *tables,
    )


def _page(group: str) -> str:
    entries = (_entry(code, explanation) for code, explanation in sorted(explanations(group).items()))
    return markdown.joined(
        f"# Messages: {group.replace('_', ' ')}", markdown.plain(_comment(group)), *(entry for entry in entries)
    )


def _entry(code: str, explanation: Explanation) -> str:
    wrong = (f"Wrong:\n\n{markdown.fence(explanation.bad, 'ta')}",) if explanation.bad else ()
    right = (f"Right:\n\n{markdown.fence(explanation.good, 'ta')}",) if explanation.good else ()
    title = f"## {code}: {markdown.plain(explanation.title)} {{ #{code.lower()} }}"
    return markdown.joined(title, markdown.plain(explanation.why), *wrong, *right).rstrip()


def _comment(group: str) -> str:
    """The comment at the top of the file of a group."""
    file = files("tachk.base.diagnostics") / "explanations" / f"{group}.toml"
    lines = file.read_text(encoding="utf-8").splitlines()
    return " ".join(line.removeprefix("#").strip() for line in takewhile(lambda line: line.startswith("#"), lines))
