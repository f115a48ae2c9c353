"""Nothing that a user can name lacks its entry in the reference, which is generated from the code at each build."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import click
import pytest

import tachk
from docs.site_build.commands import FOLDER as COMMANDS
from docs.site_build.commands import anchor_of, page_of, shown_parameters
from docs.site_build.contents import pages_of_docs, reference_sections
from docs.site_build.grammar_diagrams import FOLDER as GRAMMAR
from docs.site_build.grammar_diagrams import INVISIBLE, NAMED, PAGES, SPELT, railroad, visible
from docs.site_build.grammar_notation import InOrder, Maybe, NamedToken, OneOf, Part, Repeated, Rule, read_rules
from docs.site_build.messages import FOLDER as MESSAGES
from docs.site_build.python_names import FOLDER as PYTHON
from docs.site_build.python_names import STABILITY, promised_names, public_members
from docs.site_build.schemas import FOLDER as JSON
from docs.site_build.site_files import ROOT, Section
from tachk.base.diagnostics.explanation import all_explanations
from tachk.base.resources import grammar_text
from tachk.cli.main import COMMANDS as COMMAND_NAMES
from tachk.cli.main import load_command

if not (ROOT / "mkdocs.yml").is_file():
    pytest.skip("needs a checkout", allow_module_level=True)


@cache
def sections() -> Mapping[str, Section]:
    return reference_sections(pages_of_docs(), draw=lambda rule, _: f"<svg>{rule.name}</svg>")


def text(path: str) -> str:
    folder = path.rpartition("/")[0] + "/"
    return next(file.content for file in sections()[folder].files if file.path == path)


def anchors(page: str) -> Counter[str]:
    return Counter(re.findall(r"\{ #(\S+) \}", page))


@pytest.mark.parametrize("name", COMMAND_NAMES)
def test_every_command_has_a_page_with_every_argument_and_option(name: str) -> None:
    page = text(page_of(name))
    assert f"`tachk {name}`" in text(f"{COMMANDS}index.md")
    expected = {anchor_of(each) for each in shown_parameters(load_command(name))}
    assert set(anchors(page)) == expected
    assert max(anchors(page).values(), default=1) == 1
    for parameter in shown_parameters(load_command(name)):
        if isinstance(parameter, click.Option):
            assert all(option in page for option in (*parameter.opts, *parameter.secondary_opts))


def test_every_public_name_has_an_entry() -> None:
    entries = Counter(
        entry for file in sections()[PYTHON].files for entry in re.findall(r"^::: (\S+)$", file.content, re.MULTILINE)
    )
    stability = STABILITY.read_text(encoding="utf-8")
    promised = [("tachk", name) for name in tachk.__all__]
    promised += [(module, name) for module, names in promised_names(stability).items() for name in names]
    assert len(promised) > 100
    for module, name in promised:
        assert entries[f"{module}.{name}"] == 1, f"{module}.{name}"
    assert all(f"[`{name}`]" in text(f"{PYTHON}index.md") for name in tachk.__all__)


def test_every_public_member_says_what_it_is() -> None:
    """The reference leaves out what has no docstring."""
    assert [name for name, value in public_members() if not (value.__doc__ or "").strip()] == []


def test_every_code_has_an_entry() -> None:
    found = Counter(anchor for file in sections()[MESSAGES].files for anchor in anchors(file.content))
    codes = [code.lower() for code in all_explanations()]
    assert found == Counter(codes)
    index = text(f"{MESSAGES}index.md")
    assert all(f"#{code})" in index for code in codes)
    for code, explanation in all_explanations().items():
        page = next(file.content for file in sections()[MESSAGES].files if f"{{ #{code.lower()} }}" in file.content)
        assert explanation.bad in page
        assert explanation.good in page


SCHEMAS = sorted((ROOT / "docs/schema").glob("*.schema.json"))


@pytest.mark.parametrize("path", SCHEMAS, ids=lambda path: path.name.removesuffix(".schema.json"))
def test_every_schema_has_a_page_with_every_field(path: Path) -> None:
    page = text(f"{JSON}{path.name.removesuffix('.schema.json')}.md")
    fields = set(re.findall(r"^\| `(?:[^`|]*\.)?(\S+?)`", page, re.MULTILINE))
    assert set(field_names(json.loads(path.read_text(encoding="utf-8")))) <= fields


def field_names(schema: Any) -> Iterator[str]:
    """The names of all properties of a schema, at any depth."""
    if isinstance(schema, list):
        for each in schema:
            yield from field_names(each)
    elif isinstance(schema, dict):
        for key, value in schema.items():
            if key in ("properties", "$defs"):
                yield from value if key == "properties" else ()
                yield from field_names(list(value.values()))
            elif key not in ("required", "enum", "const", "description"):
                yield from field_names(value)


def rules() -> list[tuple[str, Rule]]:
    names = sorted(path.stem for path in (ROOT / "grammar").glob("*.lark"))
    return [(name, rule) for name in names for rule in read_rules(grammar_text(name))]


def test_every_rule_of_the_grammar_has_a_diagram() -> None:
    files = {page.path: page.file for page in PAGES}
    found = Counter(
        (files[file.path], anchor)
        for file in sections()[GRAMMAR].files
        if file.path in files
        for anchor in anchors(file.content)
    )
    assert found == Counter((name, rule.name) for name, rule in rules() if visible(rule.body) is not None)


def test_every_token_of_the_grammar_can_be_shown() -> None:
    used = {name for _, rule in rules() for name in tokens(rule.body)}
    assert used <= {*NAMED, *SPELT, *INVISIBLE}
    assert not NAMED.keys() & SPELT.keys()


def tokens(part: Part) -> Iterator[str]:
    if isinstance(part, NamedToken):
        yield part.name
    elif isinstance(part, InOrder | OneOf):
        for each in part.parts:
            yield from tokens(each)
    elif isinstance(part, Maybe | Repeated):
        yield from tokens(part.part)


def test_diagrams_are_drawn() -> None:
    pytest.importorskip("railroad", reason="needs railroad-diagrams, of the group docs")
    for _, rule in rules():
        if visible(rule.body) is not None:
            assert railroad(rule, lambda name: f"page.html#{name}").startswith("<svg")


def test_what_is_generated_is_not_stored() -> None:
    """So it cannot be older than the code."""
    for folder in ("reference", "gallery", "project", "source"):
        assert not (ROOT / "docs" / folder).exists()
