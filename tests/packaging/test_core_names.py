"""A folder of the core is a namespace, and no type has the name of another one there: two definitions of one name in a
library make it undefined what a program does (one-definition rule, C++20 [basic.def.odr])."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections import defaultdict
from pathlib import Path

import pytest

CORE = Path(__file__).resolve().parents[2] / "src" / "core"
if not CORE.is_dir():
    pytest.skip("needs a checkout", allow_module_level=True)

PARTS_OF_A_NAMESPACE = {"reduced_kernel.hpp", "zone_contracts.hpp"}
_SCOPE = re.compile(r"^namespace\s*([\w:]*)\s*\{")
_SCOPE_END = re.compile(r"^\}\s*//\s*namespace")
_TYPE = re.compile(r"^(?:class|struct|union|enum(?: class)?) (\w+)\b(?!::|(?: : [\w:]+)?;)")
_ALIAS = re.compile(r"^using\s+(\w+)\s*=")


def types_of(text: str) -> list[str]:
    """The types that a file defines at namespace scope, with their namespaces; what only the file knows is left out."""
    scopes: list[str] = []
    found = []
    for line in text.splitlines():
        if scope := _SCOPE.match(line):
            scopes.append(scope[1])
        elif _SCOPE_END.match(line):
            scopes.pop()
        elif (name := _TYPE.match(line) or _ALIAS.match(line)) and "" not in scopes:
            found.append("::".join([*scopes, name[1]]))
    assert not scopes
    return found


def namespace_of(source: Path) -> str:
    """What a file of the core opens: its folders; the border to Python is one namespace."""
    folders = source.relative_to(CORE).parent.parts
    return "::".join(("tachk", *(folders[:1] if folders[0] == "bind" else folders)))


def test_a_folder_is_a_namespace() -> None:
    for path in sorted([*CORE.rglob("*.hpp"), *CORE.rglob("*.cpp")]):
        if path.parent == CORE / "fmi" / "library" or path.name in PARTS_OF_A_NAMESPACE:
            continue  # functions of C, and what another header includes within its own namespace
        opened = re.findall(r"^namespace (tachk[\w:]*) \{", path.read_text(encoding="utf-8"), re.MULTILINE)
        own = namespace_of(path)
        assert opened, path
        assert all(f"{name}::".startswith(f"{own}::") for name in opened), path


def test_each_type_is_defined_once() -> None:
    places = defaultdict(set)
    for path in sorted([*CORE.rglob("*.hpp"), *CORE.rglob("*.cpp")]):
        for name in types_of(path.read_text(encoding="utf-8")):
            places[name].add(path.relative_to(CORE).as_posix())
    assert len(places) > 250
    assert {name: sorted(found) for name, found in places.items() if len(found) > 1} == {}


def test_all_sources_of_the_engine_can_be_compiled_as_one(tmp_path: Path) -> None:
    """CMake compiles them in groups, and a new source changes who is in which: names of anonymous namespaces differ."""
    compiler = shutil.which(os.environ.get("CXX", "c++"))
    if compiler is None:
        pytest.skip("needs a compiler")
    if os.environ.get("TACHK_SAME_CORE"):
        pytest.skip("the same sources have passed before")
    listing = (CORE / "CMakeLists.txt").read_text(encoding="utf-8")
    begin = listing.index("add_library(tachk_core")
    sources = re.findall(r"[\w/]+\.cpp", listing[begin : listing.index(")", begin)])
    assert len(sources) > 90
    whole = tmp_path / "whole.cpp"
    whole.write_text("".join(f'#include "{CORE / source}"\n' for source in sources), encoding="utf-8")
    command = [compiler, "-std=c++20", "-fsyntax-only", f"-I{CORE}", whole]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_what_is_found() -> None:
    text = """
namespace tachk::zones {
namespace {
struct Own {};
}  // namespace
class Declared;
class Defined final {
  struct Inner {};
};
enum class Kind { one };
using Number = int;
template <class T>
struct Made {};
}  // namespace tachk::zones
"""
    assert types_of(text) == [f"tachk::zones::{name}" for name in ("Defined", "Kind", "Number", "Made")]
