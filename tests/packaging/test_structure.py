"""What each package may hold, and how long and how deep functions may be. CONTRIBUTING.md names every exception."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.support.sources import tree_of

ROOT = Path(__file__).resolve().parents[2]
PYTHON, CORE = ROOT / "src" / "tachk", ROOT / "src" / "core"
CONTRIBUTING = ROOT / "CONTRIBUTING.md"

if not CONTRIBUTING.is_file() or not CORE.is_dir():
    pytest.skip("needs a checkout", allow_module_level=True)

MODULES = sorted(PYTHON.rglob("*.py"))
SOURCES = sorted(path for path in CORE.rglob("*") if path.suffix in {".cpp", ".hpp"})

LIBRARIES = {
    "anyio": {"api.tools"},
    "anywidget": {"report.page"},
    "asammdf": {"recordings.traces.logs"},
    "click": {"cli"},
    "construct": {"xrce"},
    "h5py": {"recordings.traces.logs"},
    "jinja2": {"formats.uppaal", "report"},
    "jsonschema": {"formats"},
    "lark": {"syntax.parsing"},
    "markdown_it": {"report.page"},
    "markupsafe": {"formats.uppaal", "report.page"},
    "matplotlib": {"report"},
    "lz4": {"recordings.traces.logs"},
    "mcap": {"recordings.traces.logs"},
    "mcap_protobuf": {"recordings.traces.logs"},
    "mcp": {"api.tools"},
    "mcp_types": {"api.tools"},
    "networkx": {"formats.layout.placement", "report.run"},
    "numpy": {
        "engine.simulation",
        "meaning",
        "recordings",
        "report.monitor",
        "report.statistics",
        "simulation",
        "verify",
        "xrce",
    },
    "pandas": {"base"},
    "pytest": {"api"},
    "pyarrow": {"recordings.traces", "report.campaign", "simulation", "xrce"},
    "referencing": {"formats"},
    "rosbags": {"recordings.traces.logs"},
    "resvg_py": {"report.drawing"},
    "rich": {"cli", "report"},
    "traitlets": {"report.page"},
    "vcd": {"recordings.traces", "simulation"},
    "xml": {"simulation.fmi", "formats.uppaal", "report"},
    "z3": {"engine"},
    "zstandard": {"recordings.traces.logs"},
}
"""The packages that may use what is not tachk's own or the standard library's; of the latter, `xml`."""

LONGEST_FUNCTION = 60
MOST_MEMBERS = 15
DEEPEST = 5

_STATEMENTS = (ast.If, ast.For, ast.While, ast.With, ast.Try, ast.Match)
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


def room_of(path: Path) -> str:
    return ".".join(path.relative_to(PYTHON).parts[:-1])


def is_inside(room: str, allowed: str) -> bool:
    return room == allowed or room.startswith(f"{allowed}.")


def libraries(path: Path) -> set[str]:
    """What a module imports from outside, anywhere in it."""
    names: set[str] = set()
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names.add(node.module.split(".")[0])
    own = {"tachk", "_typeshed", *sys.stdlib_module_names} - LIBRARIES.keys()
    return names - own


def test_libraries_are_used_where_they_belong() -> None:
    used: dict[str, set[str]] = {}
    strangers = []
    for path in MODULES:
        for library in libraries(path):
            homes = [home for home in LIBRARIES.get(library, ()) if is_inside(room_of(path), home)]
            used.setdefault(library, set()).update(homes)
            if not homes:
                strangers.append(f"{path.relative_to(PYTHON)} uses {library}")
    assert strangers == []
    assert used == LIBRARIES


def test_lark_has_an_upper_bound_because_what_is_private_to_it_is_read() -> None:
    users = [path for path in MODULES if "lark" in libraries(path)]
    text = "".join(path.read_text(encoding="utf-8") for path in users)
    assert "parse_conf" in text and "lalr_analysis" in text, "without these the bound may go"
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    (wanted,) = [found for found in project["dependencies"] if found.startswith("lark")]
    below = re.fullmatch(r"lark>=[\d.]+,<(\d+)\.(\d+)", wanted)
    assert below is not None, "the next minor version may change its parse table"
    assert tuple(int(part) for part in version("lark").split(".")[:2]) < tuple(int(part) for part in below.groups())


def test_no_two_classes_have_the_same_name() -> None:
    places: dict[str, set[str]] = {}
    for path in MODULES:
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.ClassDef):
                places.setdefault(node.name.lstrip("_"), set()).add(path.relative_to(PYTHON).as_posix())
    assert {name: found for name, found in places.items() if len(found) > 1} == {}


def test_every_package_says_what_it_holds() -> None:
    rooms = {path.parent for path in MODULES}
    assert {str(room.relative_to(PYTHON)) for room in rooms if not (room / "__init__.py").is_file()} == set()
    silent = [room for room in rooms if not ast.get_docstring(tree_of(room / "__init__.py"))]
    assert silent == []


def test_every_module_says_what_it_is() -> None:
    assert [path for path in MODULES if not ast.get_docstring(tree_of(path))] == []


# ---- sizes ----------------------------------------------------------------------------------------------------------


def depth_of(node: ast.AST, around: int = 0) -> int:
    """How deep statements are nested. An `elif` is as deep as its `if`, and functions inside begin anew."""
    deepest = around
    for child in ast.iter_child_nodes(node):
        if isinstance(child, (*_FUNCTIONS, ast.Lambda, ast.ClassDef)):
            continue
        is_elif = isinstance(child, ast.If) and isinstance(node, ast.If) and node.orelse == [child]
        inside = around + (isinstance(child, _STATEMENTS) and not is_elif)
        deepest = max(deepest, depth_of(child, inside))
    return deepest


def python_offenders() -> Iterator[str]:
    for path in MODULES:
        name = path.relative_to(ROOT).as_posix()
        for node in ast.walk(tree_of(path)):
            if isinstance(node, _FUNCTIONS) and node.end_lineno is not None:
                if node.end_lineno - node.lineno >= LONGEST_FUNCTION or depth_of(node) > DEEPEST:
                    yield f"{name}: {node.name}"


_NO_CODE = re.compile(
    r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|^[ ]*#(?:[^\n]*\\\n)*[^\n]*',
    re.DOTALL | re.MULTILINE,
)
_SCOPE = re.compile(r"\b(namespace|struct|class|enum|union|extern)\b")


_INITIALISER = re.compile(r"(?<!:)[:,]\s*\w+$")


def functions(text: str) -> Iterator[tuple[str, int]]:
    """The functions of a C++ source with the number of their lines, told by their braces."""
    text = _NO_CODE.sub(lambda found: re.sub(r"[^\n]", "", found.group()), text)
    open_: list[tuple[str, int, str]] = []  # its kind or the name of a function, where it begins, what stands before
    head, first, line = "", 1, 1
    for character in text:
        line += character == "\n"
        if character == "{":
            before = re.sub(r"<[^<>]*>", "", head).strip()
            called = re.search(r"(\w+)\s*\(", before)
            if _INITIALISER.search(before) and called:
                kind = "initialiser"
            elif not before or (_SCOPE.search(before) and not before.endswith(")")):
                kind = "scope"
            elif called and not before.endswith("=") and all(name == "scope" for name, _, _ in open_):
                kind = f"{called[1]}()"
            else:
                kind = "block"
            open_.append((kind, first, head))
            head = ""
        elif character == "}":
            kind, begin, before = open_.pop()
            head = f"{before}{{}}" if kind == "initialiser" else ""
            if kind.endswith("()"):
                yield kind.removesuffix("()"), line - begin + 1
        elif character == ";":
            head = ""
        else:
            first = line if not head.strip() else first
            head += character


def classes(text: str) -> Iterator[tuple[str, int]]:
    """The classes of a C++ source with the number of their data members, told by the layout of clang-format."""
    lines = text.splitlines()
    for number, line in enumerate(lines):
        if begun := re.match(r"( *)(?:struct|class) (\w+)[^;]*\{$", line):
            end = next(n for n in range(number + 1, len(lines)) if lines[n].startswith(f"{begun[1]}}}"))
            inner = f" {{{len(begun[1]) + 2}}}"
            yield begun[2], sum(_members(inside, inner) for inside in lines[number + 1 : end])


def _members(line: str, indent: str) -> int:
    if re.match(rf"{indent}[\w:]+ \(\*\w+\)\(", line):
        return 1  # a pointer to a function
    declared = re.sub(r"\{.*\}| = .*(?=;)| : \d+", "", line.split("//")[0])
    other = "using |static |friend |typedef |struct |class |enum |template |return "
    found = re.match(rf"{indent}(?!{other})[\w:][^()]*?[ &*]\w+((?:, \w+)*);", declared)
    return 1 + found[1].count(",") if found else 0


def core_offenders() -> Iterator[str]:
    for path in SOURCES:
        name, text = path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8")
        yield from (f"{name}: {function}" for function, lines in functions(text) if lines > LONGEST_FUNCTION)
        yield from (f"{name}: {class_}" for class_, members in classes(text) if members > MOST_MEMBERS)


def exceptions() -> dict[str, str]:
    """What the guide excepts, each with its reason."""
    text = CONTRIBUTING.read_text(encoding="utf-8")
    section = text[text.index("### How long and how deep") :].split("\n## ")[0]
    return dict(re.findall(r"^\| `(src/[^`]+)` \| (.+) \|$", section, re.MULTILINE))


def test_what_is_too_long_or_too_deep_is_an_exception_with_a_reason() -> None:
    assert sorted({*python_offenders(), *core_offenders()}) == sorted(exceptions())


def test_data_members_of_the_core_are_counted() -> None:
    text = """
class A final {
 public:
  A(int x) : x_(x) {}
  A& operator=(const A&) = delete;
  int get() const { return x_; }
  struct B {
    bool (*call)(int i);
    std::vector<std::pair<int, int>> pairs{};  // two; at most
    int x, y;
  };

 private:
  static constexpr int size = 3;
  const B* b_ = nullptr;
  std::int64_t x_ : 3;
};
"""
    assert list(classes(text)) == [("A", 2), ("B", 4)]


def test_functions_of_the_core_are_found() -> None:
    text = """
namespace a {
// {
template <class T> struct B : C<T> {
  explicit B(int x) : y{x}, z(x) {
    if (x) {
      call("{");
    }
  }
  int y = 0;
};
static const int table[] = {1, 2};
Result<int>
run(int x,
    int y) {
  return x;
}
}  // namespace a
"""
    assert list(functions(text)) == [("B", 5), ("run", 5)]
