"""A `match` over an enum or a closed union names every member, or refuses the rest, or stands here with a reason.

mypy's `exhaustive-match` sees to a match without a catch-all, unless its last case has a guard. A catch-all that goes
on with a value is what it cannot see through: a member that was forgotten takes that path, and a verdict may change.
"""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.support.sources import tree_of

ROOT = Path(__file__).parents[2]
SOURCES = ROOT / "src/tachk"
DECIDING = (
    "model",
    "logic",
    "frontend",
    "meaning",
    "analysis",
    "transform",
    "engine",
    "verify",
    "recordings/monitors",
)
"""The packages in which a wrong path changes a verdict."""

FEW = 3
"""A match that picks out so many kinds of a union asks about these; the rest is meant to be whatever else there is."""

REASONS = {
    "Anything else is walked as it is built, whatever it is.": {
        "model/traversal.reads_clock",
        "analysis/fold._fold",
        "frontend/expressions/folded_expressions._folded",
        "frontend/context.Context.effects_of",
        "model/metas._LastingMetas.value",
        "recordings/monitors/line_compiler._LineChecker.without_first_instant",
    },
    "Anything else goes to a function that names every member.": {
        "engine/compiler/codegen.CodeGenerator.address",
        "engine/compiler/codegen.CodeGenerator.effect",
        "analysis/fold._fold_place",
        "analysis/interpreter.place",
        "analysis/interpreter.truth",
        "logic/constant_values.value_of",
        "model/evaluate._place",
        "engine/symmetry/symmetrised_query._renamed",
    },
    "Anything else is kept as it is, one condition or one formula, which says the same.": {
        "engine/compiler/goal._disjuncts",
        "engine/smt/conditions._parts",
        "frontend/expressions/folded_expressions.binary",
        "logic/observer/past_windows._absent",
        "logic/observer/past_windows._clauses",
        "logic/simplify._simpler",
        "meaning/constraints._parts",
    },
    "Anything else gets the answer on the safe side: it may fail, move, or have any value.": {
        "engine/compiler/condition_code.ConditionCompiler._test",
        "analysis/divisors._divisor",
        "analysis/failures._assumed_fails",
        "analysis/fold.cannot_fail",
        "engine/compiler/edge_pattern.linear_term",
        "engine/compiler/hybrid.is_affine",
        "analysis/intervals.arithmetic",
        "frontend/dropped.is_harmless",
        "frontend/hybrid_clocks._stops_or_runs",
        "frontend/expressions/typing.value_range",
        "logic/bound_directions.directions_in",
        "meaning/clock_constants.interval",
        "meaning/discrete._is_the_same_everywhere",
        "verify/synthesis/bounds_of_parameters._Occurrences._in_comparison",
        "verify/synthesis/bounds_of_parameters._Occurrences._interval",
        "verify/synthesis/bounds_of_parameters._Occurrences.in_condition",
        "verify/synthesis/region.Region._sides",
    },
    "Anything else has no such form, and the caller refuses it.": {
        "frontend/expressions/places.is_place",
        "frontend/expressions/typed_expressions._member",
        "frontend/expressions/typing.same_shape",
        "model/clock_sums.clock_sum",
        "recordings/monitors/line_compiler._computed",
        "recordings/monitors/line_compiler._constant",
    },
    "It is a truth value unless it has a clock in it.": {"engine/compiler/goal._is_condition"},
    "What is looked for, findings or words, concerns these kinds only.": {
        "frontend/expressions/changed_places.changed_first",
        "frontend/expressions/name_expressions.misuse_help",
        "recordings/monitors/line_compiler._LineChecker.not_linear",
        "recordings/monitors/line_compiler.line_findings",
    },
}


def _names(node: ast.expr) -> list[str]:
    """``A | b.C``: A, C."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitOr):
        return _names(node.left) + _names(node.right)
    return [node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""]


def _closed(trees: Iterable[ast.Module]) -> _Closed:
    enums: set[str] = set()
    members: set[str] = set()
    for node in (node for tree in trees for node in tree.body):
        if isinstance(node, ast.ClassDef) and any(name.endswith("Enum") for b in node.bases for name in _names(b)):
            enums.add(node.name)
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.BinOp):
            members.update(_names(node.value))
    return _Closed(enums, members - {"", "None", "bool", "float", "int", "str"})


@dataclass(frozen=True)
class _Closed:
    """The names of enums, and of the members of unions that have a name."""

    enums: set[str]
    members: set[str]

    def kinds(self, pattern: ast.pattern) -> set[str]:
        """The members of a union that a pattern names at its outermost."""
        found = {
            name for inner in _outermost(pattern) if isinstance(inner, ast.MatchClass) for name in _names(inner.cls)
        }
        return found & self.members

    def names_an_enum(self, pattern: ast.pattern) -> bool:
        values = [inner.value for inner in _outermost(pattern) if isinstance(inner, ast.MatchValue)]
        owners = {name for value in values if isinstance(value, ast.Attribute) for name in _names(value.value)}
        return not owners.isdisjoint(self.enums)

    def is_asked(self, match: ast.Match) -> bool:
        """Whether a match goes through the members of an enum or a union, rather than ask about a few of them."""
        kinds = set().union(*(self.kinds(case.pattern) for case in match.cases))
        return len(kinds) > FEW or any(self.names_an_enum(case.pattern) for case in match.cases)


def _outermost(pattern: ast.pattern) -> Iterator[ast.pattern]:
    match pattern:
        case ast.MatchOr(patterns=patterns) | ast.MatchSequence(patterns=patterns):
            for inner in patterns:
                yield from _outermost(inner)
        case ast.MatchAs(pattern=ast.pattern() as inner):
            yield from _outermost(inner)
        case _:
            yield pattern


def _matches(node: ast.AST, path: str) -> Iterator[tuple[str, ast.Match]]:
    """The match statements inside, each with the function that has it."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Match):
            yield path, child
        named = isinstance(child, ast.ClassDef | ast.FunctionDef)
        yield from _matches(child, f"{path}.{child.name}" if named else path)


def _goes_on(last: ast.match_case) -> bool:
    """Whether the last case takes everything and goes on with it, or has a guard, behind which mypy does not look."""
    if last.guard is not None:
        return True
    if not (isinstance(last.pattern, ast.MatchAs) and last.pattern.pattern is None):
        return False
    refused = isinstance(last.body[-1], ast.Raise)
    calls = [name for node in ast.walk(last) if isinstance(node, ast.Call) for name in _names(node.func)]
    return not refused and not {"assert_never", "error"} & set(calls)


def _open_matches() -> Iterator[str]:
    trees = {path: tree_of(path) for path in sorted(SOURCES.rglob("*.py"))}
    closed = _closed(trees.values())
    for path, tree in trees.items():
        module = path.relative_to(SOURCES).with_suffix("").as_posix()
        if module.startswith(tuple(f"{room}/" for room in DECIDING)):
            yield from (
                name for name, match in _matches(tree, module) if closed.is_asked(match) and _goes_on(match.cases[-1])
            )


def test_what_a_match_does_not_name_is_rejected_or_has_a_reason() -> None:
    listed = [name for names in REASONS.values() for name in names]
    assert len(listed) == len(set(listed))
    assert set(_open_matches()) == set(listed)


def test_mypy_looks_at_matches_without_a_catch_all() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["mypy"]
    assert "exhaustive-match" in settings["enable_error_code"]
