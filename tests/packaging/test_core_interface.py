"""What Python and C++ say about each other must be the same: the stub of the extension, opcodes and fault numbers."""

from __future__ import annotations

import ast
import re
from enum import IntEnum
from pathlib import Path

import pytest

from tachk import _core
from tachk.compiler.bytecode import Opcode
from tachk.compiler.program import Comparison, DeadlockLiteral
from tachk.engines import zone
from tachk.engines.options import Extrapolation, SearchOrder
from tachk.engines.zone import CoreStatus
from tachk.model.fault import RuntimeErrorKind
from tachk.runtime.monitor_program import NodeKind, Relation, ValueOperator
from tachk.runtime.trace_csv import FaultKind as CsvFaultKind

ROOT = Path(__file__).resolve().parents[2]

WORDS = {
    "Opcode": {"constant": "const", "logical_not": "not", "call_return": "return", "assertion": "assert"},
    "FaultKind": {"assertion": "assert"},
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
        ("machine/opcode.hpp", "FaultKind", RuntimeErrorKind),
        ("reachability/explorer.hpp", "Status", CoreStatus),
        ("program/program.hpp", "Comparison", Comparison),
        ("program/program.hpp", "DeadlockLiteral", DeadlockLiteral),
        ("csv/csv_reader.hpp", "CsvFaultKind", CsvFaultKind),
        ("monitoring/monitor_program.hpp", "ValueOperator", ValueOperator),
        ("monitoring/monitor_program.hpp", "Relation", Relation),
        ("monitoring/monitor_program.hpp", "NodeKind", NodeKind),
    ],
)
def test_the_header_and_python_number_alike(header: str, enumeration: str, mirror: type[IntEnum]) -> None:
    assert numbers_of(header, enumeration) == {member.name.lower(): member.value for member in mirror}


@pytest.mark.parametrize(
    ("header", "enumeration", "numbers"),
    [
        ("reachability/options.hpp", "SearchOrder", zone._ORDERS),
        ("symbolic/abstraction.hpp", "Extrapolation", zone._EXTRAPOLATIONS),
        ("zones/zone.hpp", "Width", zone._WIDTHS),
    ],
)
def test_options_have_the_numbers_of_the_header(header: str, enumeration: str, numbers: dict[object, int]) -> None:
    names = {
        SearchOrder.BFS: "breadth_first",
        SearchOrder.DFS: "depth_first",
        SearchOrder.RANDOM_DFS: "random_depth_first",
        Extrapolation.NONE: "none",
        Extrapolation.MAX: "max",
        Extrapolation.LU: "lu",
        16: "narrow",
        32: "wide",
        64: "widest",
    }
    assert numbers_of(header, enumeration) == {names[option]: number for option, number in numbers.items()}


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
        assert {n.name for n in methods} == {name for name in vars(extension) if not name.startswith("_")}, class_.name
        for method in methods:
            signature = re.sub(r"\[[^\[\]]*\]", "", str(getattr(extension, method.name).__doc__).splitlines()[0])
            arguments = [a.arg for a in (*method.args.args, *method.args.kwonlyargs)]
            assert arguments == re.findall(r"[(,] ?(\w+)", signature.split("->")[0])
