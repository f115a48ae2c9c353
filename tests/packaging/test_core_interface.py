"""What Python and C++ say about each other must be the same: the stub of the extension, opcodes and fault numbers."""

from __future__ import annotations

import ast
import re
from enum import IntEnum
from pathlib import Path

import pytest

from tachk import _core
from tachk.model.fault import RuntimeErrorKind
from tachk.semantics.bytecode import Opcode

ROOT = Path(__file__).resolve().parents[2]

WORDS = {
    "constant": "const",
    "logical_not": "not",
    "call_return": "return",
    "assertion": "assert",
}
"""Names that C++ reserves or uses otherwise, with the names Python has for them."""


def numbers_of(enumeration: str) -> dict[str, int]:
    header = (ROOT / "src/core/include/tachk/opcode.hpp").read_text(encoding="utf-8")
    body = re.search(rf"enum class {enumeration} : std::int32_t {{(.*?)}};", header, re.DOTALL)
    assert body is not None
    pairs = re.findall(r"(\w+) = (\d+),", body.group(1))
    return {WORDS.get(name, name): int(number) for name, number in pairs}


@pytest.mark.parametrize(("enumeration", "mirror"), [("Opcode", Opcode), ("FaultKind", RuntimeErrorKind)])
def test_the_header_and_python_number_alike(enumeration: str, mirror: type[IntEnum]) -> None:
    if not (ROOT / "src/core").is_dir():
        pytest.skip("needs a checkout")
    assert numbers_of(enumeration) == {member.name.lower(): member.value for member in mirror}


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
