"""From the text of a grammar to its tables, which lark computes. The only module that knows lark.

It uses what lark keeps for itself (the parse table and the options of rules), so pyproject.toml bounds its version.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import lark
from lark.lexer import Lexer, PatternStr
from lark.parsers.lalr_analysis import Shift

from tachk.syntax.parsing.grammar import Grammar, GrammarRule, Terminal


class _NoLexer(Lexer):
    """Tokens are cut by `tachk.syntax.parsing.tokens` and fed to the parser one by one."""

    def __init__(self, lexer_conf: Any) -> None:
        pass

    def lex(self, *_: Any) -> Iterator[Any]:
        return iter(())


def compile_grammar(text: str, starts: Sequence[str]) -> Grammar:
    """The tables of a grammar in lark's notation, with all tokens kept and None for what is absent in ``[...]``.

    Names are made plain strings: lark's own kind could not be loaded without lark.
    """
    parser = lark.Lark(
        text, parser="lalr", lexer=_NoLexer, start=list(starts), keep_all_tokens=True, maybe_placeholders=True
    )
    configuration = parser.parse_interactive("", start=starts[0]).parser_state.parse_conf
    table = configuration.parse_table
    numbers = {id(rule): number for number, rule in enumerate(parser.rules)}
    rows = {
        int(state): {
            str(name): int(argument) if action is Shift else ~numbers[id(argument)]
            for name, (action, argument) in row.items()
        }
        for state, row in configuration.states.items()
    }
    terminals = tuple(
        Terminal(
            str(each.name),
            str(each.pattern.value) if isinstance(each.pattern, PatternStr) else None,
            str(each.pattern.to_regexp()),
            each.priority,
        )
        for each in parser.terminals
    )
    rules = tuple(_rule(rule) for rule in parser.rules)
    ends = [{str(name): state for name, state in found.items()} for found in (table.start_states, table.end_states)]
    return Grammar(terminals, rules, rows, *ends)


def _rule(rule: Any) -> GrammarRule:
    size = len(rule.expansion)
    absent = rule.options.empty_indices
    places = tuple(len(ones) for ones in "".join(str(int(each)) for each in absent).split("0")) if absent else ()
    inlined = frozenset(
        place for place, symbol in enumerate(rule.expansion) if not symbol.is_term and symbol.name.startswith("_")
    )
    callback = rule.alias or rule.options.template_source or rule.origin.name
    return GrammarRule(
        str(rule.origin.name), str(callback), size, places, inlined, bool(rule.options.expand1 and not rule.alias)
    )
