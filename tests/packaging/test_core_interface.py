"""What Python and C++ say about each other must be the same: the stub of the extension, opcodes and fault numbers."""

from __future__ import annotations

import ast
import re
from dataclasses import fields
from enum import Enum
from pathlib import Path

import pytest

from tachk import _core
from tachk.engine.compiler.bytecode import Opcode
from tachk.engine.compiler.program import Comparison, DeadlockLiteral
from tachk.engine.core_search import core_options
from tachk.engine.options import BoundScope, Extrapolation, Options, SearchOrder
from tachk.model.fault import RuntimeErrorKind
from tachk.model.floating import FloatingOperation
from tachk.recordings.traces.monitor_program import AtomRelation, NodeKind, ValueOperator

ROOT = Path(__file__).resolve().parents[2]

WORDS = {
    "Opcode": {"constant": "const", "logical_not": "not", "call_return": "return", "assertion": "assert"},
    "FaultKind": {"assertion": "assert"},
    "SearchOrder": {
        "automatic": "auto",
        "breadth_first": "bfs",
        "depth_first": "dfs",
        "random_depth_first": "random_dfs",
    },
    "NodeKind": {
        "always_false": "false",
        "always_true": "true",
        "logical_not": "not",
        "logical_and": "and",
        "logical_or": "or",
    },
}
"""Names that C++ reserves or uses otherwise, with the names Python has for them."""


def numbers_of(header: str, enumeration: str) -> dict[str, int]:
    if not (ROOT / "src/core").is_dir():
        pytest.skip("needs a checkout")
    text = (ROOT / "src/core" / header).read_text(encoding="utf-8")
    body = re.search(rf"enum class {enumeration}(?: : [\w:]+)? {{(.*?)}};", text, re.DOTALL)
    assert body is not None
    numbers: dict[str, int] = {}
    for item in re.sub(r"//.*", "", body.group(1)).split(","):
        name, _, number = (part.strip() for part in item.partition("="))
        if name:
            numbers[WORDS.get(enumeration, {}).get(name, name)] = (
                int(number) if number else max(numbers.values(), default=-1) + 1
            )
    return numbers


@pytest.mark.parametrize(
    ("header", "enumeration", "mirror"),
    [
        ("machine/opcode.hpp", "Opcode", Opcode),
        ("machine/floating.hpp", "FloatingOperation", FloatingOperation),
        ("machine/opcode.hpp", "FaultKind", _core.FaultKind),
        ("reachability/explorer.hpp", "Status", _core.Status),
        ("order/orders.hpp", "SearchOrder", _core.SearchOrder),
        ("symbolic/abstraction.hpp", "Extrapolation", _core.Extrapolation),
        ("symbolic/abstraction.hpp", "BoundScope", _core.BoundScope),
        ("zones/zone.hpp", "Width", _core.Width),
        ("program/program.hpp", "Comparison", Comparison),
        ("program/program.hpp", "DeadlockLiteral", DeadlockLiteral),
        ("csv/csv_reader.hpp", "CsvFaultKind", _core.CsvFaultKind),
        ("json_lines/json_reader.hpp", "JsonKind", _core.JsonKind),
        ("monitoring/linear/linear_monitor.hpp", "RobustnessKind", _core.Measure),
        ("monitoring/monitor_program.hpp", "ValueOperator", ValueOperator),
        ("monitoring/monitor_program.hpp", "Relation", AtomRelation),
        ("monitoring/monitor_program.hpp", "NodeKind", NodeKind),
    ],
)
def test_the_header_and_python_number_alike(header: str, enumeration: str, mirror: type[Enum]) -> None:
    assert numbers_of(header, enumeration) == {member.name.lower(): member.value for member in mirror}


@pytest.mark.parametrize(
    ("bound", "ours"),
    [
        (_core.SearchOrder, SearchOrder),
        (_core.Extrapolation, Extrapolation),
        (_core.BoundScope, BoundScope),
        (_core.FaultKind, RuntimeErrorKind),
    ],
)
def test_an_enumeration_of_the_core_has_the_members_of_ours(bound: type[Enum], ours: type[Enum]) -> None:
    assert {member.name for member in bound} == {member.name for member in ours}


def test_the_core_takes_every_option_but_those_for_the_network_by_its_name() -> None:
    names = {name for name in vars(_core.Options) if not name.startswith("_")}
    of_networks = {"processes", "without", "engine", "pace", "local_times"}
    assert names == {field.name for field in fields(Options)} - of_networks | {"alu", "merging", "pruning", "attempts"}
    changed = Options(
        order=SearchOrder.RANDOM_DFS,
        seed=2**32 - 1,
        extrapolation=Extrapolation.MAX,
        bounds=BoundScope.GLOBAL,
        subsumption=False,
        width=32,
        scale=False,
        vector=False,
        reclaim=False,
        pack_clocks=2**32 - 1,
        partial_order=True,
        chunk_words=2**16,
        rows_after=2**32 - 1,
        reduced_after=2**32 - 1,
        proof_after=2**32 - 1,
    ).off("alu", "merging", "pruning", "attempts")
    usual, taken = core_options(Options()), core_options(changed)
    assert {name for name in names if getattr(usual, name) == getattr(taken, name)} == {"shortest"}
    assert core_options(Options(shortest=True)).shortest
    assert all(getattr(usual, name) == getattr(_core.Options(), name) for name in names)


def test_the_stub_lists_what_the_extension_has() -> None:
    stub = ROOT / "src/tachk/_core.pyi"
    if not stub.is_file():
        pytest.skip("needs a checkout")
    body = ast.parse(stub.read_text(encoding="utf-8")).body
    classes = [node for node in body if isinstance(node, ast.ClassDef)]
    functions = {node.name for node in body if isinstance(node, ast.FunctionDef)}
    assert {node.name for node in classes} | functions == {name for name in vars(_core) if not name.startswith("_")}
    for class_ in classes:
        extension = getattr(_core, class_.name)
        methods = [n for n in class_.body if isinstance(n, ast.FunctionDef) and n.name != "__init__"]
        members = {n.id for n in ast.walk(class_) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
        there = {name for name in vars(extension) if not name.startswith("_")}
        if extension is not _core.Options:  # the names of whose fields are those of our options
            assert {n.name for n in methods} | members == there, class_.name
        for method in methods:
            signature = re.sub(r"\[[^\[\]]*\]", "", str(getattr(extension, method.name).__doc__).splitlines()[0])
            arguments = [a.arg for a in (*method.args.args, *method.args.kwonlyargs)]
            assert arguments == re.findall(r"[(,] ?(\w+)", signature.split("->")[0])
