"""Reads a grammar in lark's notation as a tree of rules, with the comments and headings between them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache

import lark

_HEADING = re.compile(r"^// -{4} (.*?) -+$")
_DEFINITION = re.compile(r"^[?!]?([a-z_][a-z0-9_]*)\s*:", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Word:
    """Text that stands in a model as it is here."""

    text: str


@dataclass(frozen=True, slots=True)
class NamedRule:
    """The place of another rule."""

    name: str


@dataclass(frozen=True, slots=True)
class NamedToken:
    """The place of a token, such as a number or a contextual keyword."""

    name: str


@dataclass(frozen=True, slots=True)
class InOrder:
    """One part after another."""

    parts: tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class OneOf:
    """Any one of the parts."""

    parts: tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class Repeated:
    """A part, as often as one likes; `least` is 0 or 1."""

    part: Part
    least: int


@dataclass(frozen=True, slots=True)
class Maybe:
    """A part that may be left out."""

    part: Part


Part = Word | NamedRule | NamedToken | InOrder | OneOf | Repeated | Maybe


@dataclass(frozen=True, slots=True)
class Rule:
    """Attributes:
    name: as in the grammar.
    body: what it stands for.
    heading: the heading above it in the file; empty above the first one.
    """

    name: str
    body: Part
    heading: str


@cache
def read_rules(text: str) -> tuple[Rule, ...]:
    """The rules of a grammar, in their order. Tokens are left out: lexers cut them, not these rules."""
    headings = _headings(text)
    tree = _notation().parse(text + "\n")
    rules = [node for node in tree.children if isinstance(node, lark.Tree) and node.data == "rule"]
    return tuple(_rule(node, headings) for node in rules)


@cache
def _notation() -> lark.Lark:
    """Lark's own grammar of grammars."""
    return lark.Lark.open_from_package("lark", "lark.lark", ("grammars",), parser="lalr", maybe_placeholders=False)


def _headings(text: str) -> dict[str, str]:
    """The heading above each rule."""
    found: dict[str, str] = {}
    heading = ""
    for line in text.splitlines():
        if (new := _HEADING.match(line)) is not None:
            heading = new[1]
        if (rule := _DEFINITION.match(line)) is not None:
            found[rule[1]] = heading
    return found


def _rule(node: lark.Tree[lark.Token], headings: dict[str, str]) -> Rule:
    name = str(node.children[0]).lstrip("?!")
    return Rule(name, _part(node.children[-1]), headings.get(name, ""))


def _part(node: object) -> Part:
    assert isinstance(node, lark.Tree), node
    children = node.children
    if node.data == "expansions":
        return _smallest(OneOf, children)
    if node.data == "alias":  # `-> name`, the name of a node of the tree, is not a part of the language
        return _part(children[0])
    if node.data == "expansion":
        return _smallest(InOrder, children)
    if node.data == "maybe":
        return Maybe(_smallest(OneOf, children))
    if node.data == "expr":
        return _repeated(_part(children[0]), str(children[1]))
    if node.data == "name":
        name = str(children[0])
        return NamedToken(name) if name.isupper() else NamedRule(name)
    assert node.data == "literal", node.data
    return Word(str(children[0])[1:-1])


def _smallest(kind: type[OneOf] | type[InOrder], children: list[object]) -> Part:
    parts = tuple(_part(child) for child in children)
    return parts[0] if len(parts) == 1 else kind(parts)


def _repeated(part: Part, operator: str) -> Part:
    return Maybe(part) if operator == "?" else Repeated(part, 0 if operator == "*" else 1)
