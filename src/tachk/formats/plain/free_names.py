"""Names that UPPAAL does not take, by version.

The words of version 5 are those of UPPAAL's open parser UTAP 2.1.1. Of the words that statistical checking brought, the
releases 4.1 took in more and more; only those without which no release did are listed under 4.1.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from tachk.frontend.expressions.builtin_names import BUILTIN_CONSTANTS, BUILTIN_TYPES, FLOATING_FUNCTIONS
from tachk.syntax import ast
from tachk.syntax.rewrite import names_in
from tachk.syntax.walk import nodes_of_kind

# fmt: off
WORDS_4_1 = frozenset(
    {
        "const", "select", "guard", "sync", "assign", "process", "state", "branchpoint", "init", "trans", "urgent",
        "commit", "broadcast", "system", "true", "false", "and", "or", "not", "imply", "for", "while", "do", "if",
        "else", "default", "return", "typedef", "struct", "import", "meta", "before_update", "after_update",
        "progress", "gantt", "forall", "exists", "sum", "priority", "bool", "int", "double", "chan", "clock", "void",
        "scalar", "hybrid", "probability",
    }
)
WORDS_5 = WORDS_4_1 | FLOATING_FUNCTIONS | {
    "exit", "location", "IO", "assert", "query", "string", "dynamic", "spawn", "xor", "abs", "fpclassify",
}
QUERY_WORDS = frozenset(
    {
        "deadlock", "control", "control_t", "minE", "maxE", "minPr", "maxPr", "loadStrategy", "saveStrategy", "under",
        "imitate", "strategy", "simulate", "sat", "Pr", "X", "numOf", "foreach",
    }
)
"""Names in a model, but not in a query."""

DECLARED_5 = frozenset(BUILTIN_TYPES) | frozenset(BUILTIN_CONSTANTS) | {
    "FLT_MIN", "FLT_MAX", "DBL_MIN", "DBL_MAX", "M_PI", "M_PI_2", "M_PI_4", "M_E", "M_LOG2E", "M_LOG10E", "M_LN2",
    "M_LN10", "M_1_PI", "M_2_PI", "M_2_SQRTPI", "M_SQRT2", "M_SQRT1_2",
}
"""The names that version 5 declares before the model."""
# fmt: on


def name_repairs(items: Iterable[ast.Item], formulas: Iterable[object] = ()) -> Mapping[str, str]:
    """The names of a model that some version refuses, each with the reason."""
    listed = tuple(items)
    declared = declared_names(listed)
    queried = names_in(tuple(formulas))
    repairs = {}
    for name in declared:
        reason = naming_conflict(name, name in queried)
        if reason is not None:
            repairs[name] = reason
    return repairs


def naming_conflict(name: str, in_query: bool) -> str | None:
    """The reason why a model cannot declare a name; None if it can."""
    if name in WORDS_4_1:
        return "a word of UPPAAL's language"
    if name in WORDS_5:
        return "a word of UPPAAL 5"
    if name in DECLARED_5:
        return "declared by UPPAAL 5 itself"
    if in_query and name in QUERY_WORDS:
        return "a word of UPPAAL's query language"
    return None


_DECLARING = (
    ast.Declarator,
    ast.Parameter,
    ast.FunctionDeclaration,
    ast.SelectBinding,
    ast.LocationDeclaration,
    ast.Branchpoint,
    ast.Template,
    ast.Instantiation,
)
_BINDING = (ast.QuantifierExpression, ast.IterationStatement)


def declared_names(nodes: object) -> dict[str, ast.Identifier]:
    """Every name that is declared somewhere, with its first declaration."""
    found: dict[str, ast.Identifier] = {}
    for node in nodes_of_kind(nodes, *_DECLARING, *_BINDING):
        name = node.variable if isinstance(node, _BINDING) else node.name
        found.setdefault(name.name, name)
    return found
