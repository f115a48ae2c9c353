"""The types and constants that UPPAAL 5 declares itself, written out for versions that do not."""

from __future__ import annotations

from typing import Any

from tachk.formats.plain.free_names import declared_names
from tachk.formats.plain.plain_model import PlainRewriting
from tachk.frontend.expressions.builtin_names import BUILTIN_CONSTANTS, BUILTIN_TYPES
from tachk.model.types import IntType
from tachk.syntax import ast
from tachk.syntax.rewrite import rewrite


def without_builtins(items: tuple[ast.Item, ...], steps: list[PlainRewriting]) -> tuple[ast.Item, ...]:
    """The items with ranges and numbers for the built-in names that they do not declare themselves."""
    own = declared_names(items)

    def change(node: Any) -> Any:
        match node:
            case ast.NamedType(span, name) if name in BUILTIN_TYPES and name not in own:
                type_ = BUILTIN_TYPES[name]
                assert isinstance(type_, IntType)
                steps.append(PlainRewriting("built-in name", span, f"`{name}` is `int[{type_.low}, {type_.high}]`"))
                low, high = ast.IntegerLiteral(span, type_.low), ast.IntegerLiteral(span, type_.high)
                return ast.RangeType(span, low, high)
            case ast.NameExpression(span, name) if name in BUILTIN_CONSTANTS and name not in own:
                value = BUILTIN_CONSTANTS[name]
                steps.append(PlainRewriting("built-in name", span, f"`{name}` is {value}"))
                return ast.IntegerLiteral(span, value)
            case _:
                return node

    return rewrite(items, change)
