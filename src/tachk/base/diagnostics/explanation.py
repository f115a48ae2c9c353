"""Explanations of diagnostic codes, for ``tachk explain CODE``, SARIF reports and tests.

The explanations are data: ``explanations/GROUP.toml``, a table for each code, read when one is needed.
The numbers: E00xx files and characters, E01xx syntax, E02xx names, E03xx types, E04xx templates and systems, E05xx
queries and properties, E06xx constants, E07xx unsupported features and run-time errors, E08xx the formats and versions
of other tools, E090x and E091x formulas over traces, E092x runs, E095x rules of a relay, W0xxx warnings.
"""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from textwrap import indent
from types import MappingProxyType

from tachk.base.diagnostics.diagnostic import UsageError

_FOLDER = "explanations"

CODE = re.compile(r"[A-Za-z]+[0-9]+|[A-Za-z]\w?")
"""What is meant as a code where a formula may stand, too: a word that is as short, or as a code is."""


@dataclass(frozen=True, slots=True)
class Explanation:
    """Attributes:
    title: what is wrong, in a few words.
    why: the rule behind it, and how to mend it.
    bad: a short text that has the defect; empty where a text cannot show it.
    good: the same, mended.
    """

    title: str
    why: str
    bad: str = ""
    good: str = ""


def groups() -> tuple[str, ...]:
    """The names of the groups of codes, sorted."""
    folder = files(__package__) / _FOLDER
    return tuple(sorted(file.name.removesuffix(".toml") for file in folder.iterdir() if file.name.endswith(".toml")))


@cache
def explanations(group: str) -> Mapping[str, Explanation]:
    """The codes of a group with their explanations.

    Raises:
        FileNotFoundError: there is no such group.
    """
    text = (files(__package__) / _FOLDER / f"{group}.toml").read_text(encoding="utf-8")
    return MappingProxyType({code: _explanation(table) for code, table in tomllib.loads(text).items()})


@cache
def all_explanations() -> Mapping[str, Explanation]:
    """Every code with its explanation."""
    return MappingProxyType({code: found for group in groups() for code, found in explanations(group).items()})


def explain(code: str) -> str | None:
    """The explanation of a code as text, or None if there is no such code."""
    explanation = all_explanations().get(code.upper())
    if explanation is None:
        return None
    parts = [f"{code.upper()}: {explanation.title}", explanation.why]
    if explanation.bad:
        parts.append("Wrong:\n\n" + indent(explanation.bad, "    "))
    if explanation.good:
        parts.append("Right:\n\n" + indent(explanation.good, "    "))
    return "\n\n".join(parts)


def _explanation(table: Mapping[str, str]) -> Explanation:
    examples = {name: text.removesuffix("\n") for name, text in table.items() if name in ("bad", "good")}
    return Explanation(table["title"], " ".join(table["why"].split()), **examples)


def message_text(code: str) -> str:
    """The explanation of a message. Raises UsageError for a code that no message has."""
    text = explain(code)
    if text is None:
        close = difflib.get_close_matches(code.upper(), all_explanations(), n=3)
        help = f"did you mean {' or '.join(close)}?" if close else "a code is a letter and four digits, such as E0101"
        raise UsageError(f"no message has the code {code}", help)
    return text
