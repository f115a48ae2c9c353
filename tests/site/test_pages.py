"""The site as a whole: its navigation, its links, and what its pages are made of."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from typing import Any

import pytest

from docs.site_build.check_links import check
from docs.site_build.contents import Contents, contents_of, pages_of_docs, reference_sections
from docs.site_build.docstrings import readable
from docs.site_build.gallery import comment_as_markdown, first_comment, gallery_section, models
from docs.site_build.highlighting import ModelLexer, keywords
from docs.site_build.links import SiteLinks, local_links
from docs.site_build.markdown import bars_in_tables, code, fence, plain, titled_fences
from docs.site_build.site_files import ROOT, Section, SiteFile, expanded, paths_of
from docs.site_build.verdicts import Answered, ModelVerdicts, find_verdicts, kept_verdicts

if not (ROOT / "mkdocs.yml").is_file():
    pytest.skip("needs a checkout", allow_module_level=True)

SQUARE = '<svg viewBox="0 0 10 10"></svg>'
VERDICTS = ModelVerdicts({"N": 4}, (Answered("safe", "nothing bad", "holds", True, 28, ""),))


@cache
def contents() -> Contents:
    """All pages, with drawings and verdicts that cost nothing."""
    pages = pages_of_docs()
    found = models()
    gallery = gallery_section(dict.fromkeys(found, VERDICTS), {path: {"P": SQUARE} for path in found})
    sections = {**reference_sections(pages, draw=lambda *_: "<svg></svg>"), gallery.folder: gallery}
    return contents_of(sections, pages)


def configuration() -> Mapping[str, Any]:
    yaml = pytest.importorskip("yaml")

    class Loader(yaml.SafeLoader):  # type: ignore[misc, name-defined]
        """Knows no Python: tags of mkdocs.yml stand for None."""

    Loader.add_multi_constructor("tag:yaml.org,2002:python/", lambda *_: None)
    loaded: Mapping[str, Any] = yaml.load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"), Loader)
    return loaded


def test_the_navigation_lists_every_page_once() -> None:
    navigation = list(paths_of(expanded(configuration()["nav"], contents().sections)))
    written = {path.removeprefix("docs/") for path in pages_of_docs()}
    generated = {file.path for file in contents().files if file.path.endswith(".md")}
    assert sorted(navigation) == sorted(written | generated)


def test_the_navigation_names_every_generated_section() -> None:
    assert {path for path in paths_of(configuration()["nav"]) if path.endswith("/")} == contents().sections.keys()


def test_every_link_of_a_page_leads_to_something_in_the_site() -> None:
    links = contents().links
    there = {file.path for file in contents().files}
    texts = {**pages_of_docs(), **{file.origin: file.content for file in contents().files if file.origin}}
    for origin, text in texts.items():
        for path in local_links(text, origin):
            home = links.home(path)
            if (ROOT / path).exists():
                assert home in there or (home and (ROOT / "docs" / home).is_file()), f"{origin}: {path}"


def test_every_model_has_a_page_and_a_picture() -> None:
    paths = {file.path for file in contents().sections["gallery/"].files}
    for model in models():
        assert f"gallery/{model.stem}.md" in paths
        assert contents().links.home(model.relative_to(ROOT).as_posix()) == f"gallery/{model.stem}.md"
    assert len(models()) >= 20


def test_links_are_rewritten_for_the_page_they_stand_on() -> None:
    links = SiteLinks({"README.md": "project/readme.md", "models/a.ta": "gallery/a.md"})
    text = "[a](../../models/a.ta) [b](../b.md#c) [d](#e) [f](https://g) `[h](../../m.ta)` [i](/README.md#j)"
    assert links.rewritten(text, "docs/queries/page.md", "queries/page.md") == (
        "[a](../gallery/a.md) [b](../b.md#c) [d](#e) [f](https://g) `[h](../../m.ta)` [i](../project/readme.md#j)"
    )
    assert links.rewritten('<img src="docs/x.svg">', "README.md", "project/readme.md") == '<img src="../x.svg">'


def test_links_in_fences_stay() -> None:
    text = "```ta\n[a](README.md)\n```\n[b](README.md)"
    assert SiteLinks({"README.md": "r.md"}).rewritten(text, "README.md", "x/y.md").endswith("```\n[b](../r.md)")
    assert list(local_links(text, "README.md")) == ["README.md"]


def test_text_is_quoted() -> None:
    assert plain("A[] x < 3 and `A[] y`") == r"A\[\] x \< 3 and `A[] y`"
    assert code("a`b") == "``a`b``"
    assert fence("```", "text") == "````text\n```\n````"
    assert titled_fences("```ta lamp.ta\nx\n```") == '```ta title="lamp.ta"\nx\n```'
    assert titled_fences("```ta refused E0331\nx\n```") == "```ta\nx\n```"
    assert titled_fences('```ta title="a b"\n') == '```ta title="a b"\n'
    assert bars_in_tables("| `p \\|\\| q` | a \\| b |\n`\\|`") == "| `p || q` | a \\| b |\n`\\|`"


@pytest.mark.parametrize("name", pages_of_docs())
def test_the_markdown_of_pages_is_that_of_mkdocs(name: str) -> None:
    """Fences that it does not know would swallow the headings below; HTML hides Markdown inside it."""
    text = titled_fences(pages_of_docs()[name])
    begun = [line for line in re.findall(r"^```.*$", text, re.MULTILINE) if line != "```"]
    assert [line for line in begun if not re.fullmatch(r'```+\w+( title="[^"]+")?', line)] == []
    assert "<details>" not in text, "<details markdown> lets Markdown stand inside"


def test_sections_are_put_into_the_navigation() -> None:
    section = Section(
        "r/",
        (SiteFile("r/a.md", "", "A"), SiteFile("r/b.md", "", "B"), SiteFile("r/c.svg", "")),
        groups={"G": ("r/b.md",)},
    )
    assert expanded([{"R": "r/"}, {"S": ["r/", "s.md"]}], {"r/": section}) == [
        {"R": [{"A": "r/a.md"}, {"G": [{"B": "r/b.md"}]}]},
        {"S": [{"A": "r/a.md"}, {"G": [{"B": "r/b.md"}]}, "s.md"]},
    ]


def test_comments_of_models_are_read() -> None:
    comment = first_comment(
        "// A lamp.\n//\n// Try it:   tachk verify a.ta      it fails\n//\n// Source: a book.\nint n;\n"
    )
    assert comment_as_markdown(comment) == (
        "A lamp.\n\nTry it:\n\n```sh\ntachk verify a.ta      # it fails\n```\n\nSource: a book."
    )


def test_verdicts_are_found_and_kept(tmp_path: Any) -> None:
    model = ROOT / "models/classics/bridge.ta"
    found = find_verdicts(model)
    assert {each.answer for each in found.answers} == {"holds", "fails"}
    assert all(each.met for each in found.answers)
    first = kept_verdicts((model,), tmp_path)
    assert first == {model: found}
    written = next(tmp_path.glob("*.json"))
    written.write_text(written.read_text().replace("holds", "unknown"))
    assert kept_verdicts((model,), tmp_path) != first


def test_docstrings_have_an_entry_for_each_name() -> None:
    assert readable("Args:\n    a, b: bounds,\n        both.\n    c: one.") == (
        "Args:\n    a: bounds,\n        both.\n    b: bounds,\n        both.\n    c: one."
    )
    assert readable("Attributes:\na: one.\nb: two.") == "Attributes:\n    a: one.\n    b: two."
    assert readable("Some text: with a, b: in it.") == "Some text: with a, b: in it."


def test_words_of_the_language_are_coloured() -> None:
    assert {"process", "location", "invariant", "property", "forall"} <= {*keywords()}
    tokens = {value: str(kind) for kind, value in ModelLexer().get_tokens("init location A; // why")}
    assert tokens["location"] == "Token.Keyword"
    assert tokens["A"] == "Token.Name"
    assert tokens["// why"] == "Token.Comment.Single"


def test_broken_links_are_found(tmp_path: Any) -> None:
    (tmp_path / "a.html").write_text(
        '<a id="here"></a><a href="#here"></a><a href="b.html#there"></a><a href="c.html"></a><a href="sub"></a>'
        '<img src="https://elsewhere/x.png"><a href="https://elsewhere/">x</a><link rel="canonical" href="https://e/">'
    )
    (tmp_path / "b.html").write_text("<p>")
    (tmp_path / "sub").mkdir()
    checked = check(tmp_path)
    assert [re.sub(r"^a\.html: ", "", each) for each in checked.broken] == [
        "loads https://elsewhere/x.png",
        "b.html#there: no such anchor",
        "c.html: no such file",
        "sub: a folder, which does not open without a server",
    ]
    assert checked.elsewhere == {"https://elsewhere/"}
    assert (checked.pages, checked.links) == (2, 4)
