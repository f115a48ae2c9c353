"""The reference of the grammar: a railroad diagram for each rule, drawn from `grammar/*.lark`.

Drawing needs the package `railroad-diagrams`; which rule stands where does not.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from io import StringIO
from typing import Any

from docs.site_build import markdown
from docs.site_build.grammar_notation import (
    InOrder,
    Maybe,
    NamedRule,
    NamedToken,
    OneOf,
    Part,
    Rule,
    Word,
    read_rules,
)
from docs.site_build.site_files import Section, SiteFile
from tachk.base.resources import grammar_text
from tachk.syntax.parsing.contextual import SPELLING

FOLDER = "reference/grammar/"

Draw = Callable[[Rule, Callable[[str], str | None]], str]
"""A diagram of a rule as SVG; the function has the target of the link of a rule that it names, if there is one."""


@dataclass(frozen=True, slots=True)
class GrammarPage:
    """Attributes:
    title: of the page.
    file: the grammar.
    headings: those in the grammar whose rules stand here.
    introduction: above the rules.
    """

    title: str
    file: str
    headings: tuple[str, ...]
    introduction: str

    @property
    def path(self) -> str:
        return f"{FOLDER}{self.title.lower().replace(' ', '_')}.md"


PAGES = (
    GrammarPage("Models", "tachk", ("",), "A model is a document."),
    GrammarPage(
        "Templates",
        "tachk",
        ("templates",),
        "The body of a `process`: the classic form of UPPAAL, or blocks of locations. "
        "[The language](/docs/language.md) says what they mean.",
    ),
    GrammarPage(
        "Declarations",
        "expression",
        ("types", "variables", "functions"),
        "Types, variables and functions, global or in a template.",
    ),
    GrammarPage(
        "Expressions",
        "expression",
        ("expressions, loosest first",),
        "Operators stand in the order in which they bind, the loosest first.",
    ),
    GrammarPage(
        "Queries",
        "query",
        ("",),
        "A query as an argument, in a file or in a `property`; see [Queries](/docs/queries/README.md).",
    ),
    GrammarPage(
        "Formulas",
        "stl",
        ("",),
        "Temporal formulas; [Temporal properties](/docs/logic.md) says what they mean.",
    ),
    GrammarPage(
        "Sentences",
        "sentences",
        ("", "scopes", "triggers", "delays", "responses", "what parts are made of"),
        "Requirements in English; [Sentences](/docs/sentences.md) says what they mean. "
        "Letter case and blanks do not matter.",
    ),
    GrammarPage(
        "Parts of XML",
        "tachk",
        ("fragments: labels and sections of UPPAAL XML",),
        "What stands in the labels and sections of UPPAAL's XML files.",
    ),
)
"""The pages, and which rules of the grammar stand on each."""

NAMED = {
    "NAME": "name",
    "QUOTED": "`name`",
    "INTEGER": "integer",
    "FLOAT": "number",
    "STRING": '"text"',
    "UNIT": "unit of time",
    "UNCHECKED": "statistical query",
    "SENTENCE": "sentence",
    "CONDITION": "condition",
    "DURATION": "duration",
    "LABEL": "name",
    "OPAQUE_BLOCK": "{ ... }",
    "LEGACY_PARAMETER": "name",
}
"""Tokens with many spellings, by what they are called."""

SPELT = {
    **{token: (word,) for token, word in SPELLING.items()},
    "EQUALS": ("=", ":="),
    "ASSIGNMENT_OPERATOR": ("+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>="),
    "QUANTIFIER": ("A[]", "A<>", "E[]", "E<>"),
    "FORMULA_PREFIX": ("F", "G", "O", "H"),
    "FORMULA_INFIX": ("U", "W", "S"),
    "EDGE": ("rise", "fall", "change"),
    "INTERVAL_OPEN": ("[", "("),
    "INTERVAL_CLOSE": ("]", ")"),
    "INFINITY": ("inf",),
    "IMPLIES": ("->",),
    "FULL_STOP": (".",),
    "LEGACY_CONST": ("const",),
    "LEGACY_AND": (",",),
}
"""Tokens that are written in one way, or in few."""

INVISIBLE = ("ERROR", "FORMULA")
"""Tokens that stand for no text: what was passed over after a mistake, and where a formula begins."""


def grammar_section(draw: Draw | None = None) -> Section:
    """An overview and the pages of the grammar.

    Args:
        draw: draws a rule; None for railroad diagrams.
    """
    draw = draw or railroad
    rules = {name: read_rules(grammar_text(name)) for name in dict.fromkeys(page.file for page in PAGES)}
    targets = {(page.file, rule.name): page for page in PAGES for rule in _rules_of(page, rules)}
    pages = tuple(SiteFile(page.path, _page(page, _rules_of(page, rules), targets, draw), page.title) for page in PAGES)
    overview = markdown.joined(
        "# Grammar",
        "Round boxes are written as they stand; square ones are other rules, or names and numbers. "
        "The diagrams are drawn from the grammar that the parser uses.",
        *(
            f"- [{page.title}]({page.path.removeprefix(FOLDER)}): "
            + ", ".join(
                f"[{rule.name}]({page.path.removeprefix(FOLDER)}#{rule.name})" for rule in _rules_of(page, rules)
            )
            for page in PAGES
        ),
    )
    return Section(FOLDER, (SiteFile(f"{FOLDER}index.md", overview, "All rules"), *pages))


def _rules_of(page: GrammarPage, rules: Mapping[str, Sequence[Rule]]) -> list[Rule]:
    """The rules of a page; those that stand only for a mistake are left out."""
    return [rule for rule in rules[page.file] if rule.heading in page.headings and visible(rule.body) is not None]


def _page(page: GrammarPage, rules: Sequence[Rule], targets: Mapping[tuple[str, str], GrammarPage], draw: Draw) -> str:
    def target(name: str) -> str | None:
        found = targets.get((page.file, name)) or next((targets[key] for key in targets if key[1] == name), None)
        return None if found is None else f"{found.path.removeprefix(FOLDER).removesuffix('.md')}.html#{name}"

    entries = (
        f'## {rule.name} {{ #{rule.name} }}\n\n<div class="railroad">\n{draw(rule, target)}\n</div>' for rule in rules
    )
    return markdown.joined(f"# Grammar: {page.title.lower()}", page.introduction, *entries)


def visible(part: Part) -> Part | None:
    """A part without the tokens that stand for no text; None if nothing is left."""
    if isinstance(part, NamedToken) and part.name in INVISIBLE:
        return None
    if isinstance(part, NamedRule) and part.name in ("skipped", "skipped_clause"):
        return None
    if isinstance(part, InOrder):
        kept = tuple(each for inner in part.parts if (each := visible(inner)) is not None)
        return InOrder(kept) if kept else None
    if isinstance(part, OneOf):
        kept = tuple(each for inner in part.parts if (each := visible(inner)) is not None)
        return OneOf(kept) if len(kept) > 1 else kept[0] if kept else None
    return part


def railroad(rule: Rule, target: Callable[[str], str | None]) -> str:
    """The railroad diagram of a rule."""
    import railroad as library

    body = visible(rule.body)
    assert body is not None, rule.name
    svg = StringIO()
    library.Diagram(_drawn(body, target)).writeSvg(svg.write)
    return "\n".join(line for line in svg.getvalue().splitlines() if line.strip())


def _drawn(part: Part, target: Callable[[str], str | None]) -> Any:
    import railroad as library

    def drawn(each: Part) -> Any:
        return _drawn(each, target)

    if isinstance(part, Word):
        return library.Terminal(part.text)
    if isinstance(part, NamedRule):
        return library.NonTerminal(part.name, href=target(part.name))
    if isinstance(part, NamedToken):
        return _token(part.name)
    if isinstance(part, InOrder):
        return library.Sequence(*(drawn(each) for each in part.parts))
    if isinstance(part, OneOf):
        return library.Choice(0, *(drawn(each) for each in part.parts))
    if isinstance(part, Maybe):
        return library.Optional(drawn(part.part))
    return library.OneOrMore(drawn(part.part)) if part.least else library.ZeroOrMore(drawn(part.part))


def _token(name: str) -> Any:
    import railroad as library

    if name in NAMED:
        return library.NonTerminal(NAMED[name])
    words = [library.Terminal(word) for word in SPELT[name]]
    return words[0] if len(words) == 1 else library.Choice(0, *words)
