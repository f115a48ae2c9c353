"""Where functions stand in the sources, and what tokens they consist of: a mutant names both, and no line or file."""

from __future__ import annotations

import ast
import functools
import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
_NO_CODE = {
    ".py": re.compile(r"\s+|#[^\n]*"),
    ".cpp": re.compile(r"\s+|//[^\n]*|/\*.*?\*/", re.DOTALL),
}
_TOKEN = re.compile(r'"""[\s\S]*?"""|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|\w+|[^\w\s]')
_SCOPE = re.compile(r"\b(?:namespace|struct|class|enum|union|extern)\b(?:\s+(\w+))?")


@dataclass(frozen=True, slots=True)
class Place:
    """A function: a part of a file.

    Attributes:
        path: the file, relative to the root of the repository.
        begin, end: what of its text it is.
    """

    path: str
    begin: int
    end: int


def tokens(text: str, suffix: str) -> list[tuple[str, int, int]]:
    """The tokens of a text with their begin and end, without space and comments."""
    skipped = _NO_CODE[".py" if suffix == ".py" else ".cpp"]
    found, at = [], 0
    while at < len(text):
        if space := skipped.match(text, at):
            at = space.end()
        elif token := _TOKEN.match(text, at):
            found.append((token.group(), at, token.end()))
            at = token.end()
        else:
            at += 1
    return found


def spans(text: str, suffix: str, wanted: str) -> list[tuple[int, int]]:
    """Where a text has the tokens of another one."""
    these, those = tokens(text, suffix), [token for token, _, _ in tokens(wanted, suffix)]
    size = len(those)
    starts = (n for n in range(len(these) - size + 1) if these[n][0] == those[0]) if those else iter(())
    return [(these[n][1], these[n + size - 1][2]) for n in starts if [t for t, _, _ in these[n : n + size]] == those]


@functools.cache
def functions() -> dict[str, list[Place]]:
    """All functions by their names: ``function``, ``Class.method`` in Python, ``Class::method`` in C++."""
    found = defaultdict(list)
    for path in sorted([*(ROOT / "src/tachk").rglob("*.py"), *(ROOT / "src/core").rglob("*.[ch]pp")]):
        text = path.read_text(encoding="utf-8")
        walk = _of_python if path.suffix == ".py" else _of_cpp
        for name, begin, end in walk(text):
            found[name].append(Place(path.relative_to(ROOT).as_posix(), begin, end))
    return dict(found)


def _of_python(text: str) -> Iterator[tuple[str, int, int]]:
    lines = [0]
    for line in text.splitlines(keepends=True):
        lines.append(lines[-1] + len(line))

    def walk(body: list[ast.stmt], prefix: str) -> Iterator[tuple[str, int, int]]:
        for node in body:
            if isinstance(node, ast.ClassDef):
                yield from walk(node.body, f"{node.name}.")
            elif isinstance(node, ast.FunctionDef):
                yield f"{prefix}{node.name}", lines[node.lineno - 1], lines[node.end_lineno or node.lineno]

    yield from walk(ast.parse(text).body, "")


def _of_cpp(text: str) -> Iterator[tuple[str, int, int]]:
    open_: list[tuple[str, str, int]] = []  # kind, name, begin
    head, head_at = "", 0
    for token, _, end in tokens(text, ".cpp"):
        if token == "{":
            before = re.sub(r"\s+", " ", re.sub(r"<[^<>]*>", "", head)).strip().replace(" : : ", "::")
            called = re.search(r"((?:\w+::)*~?(?:operator [^\w ]+|\w+)) \(", before)
            inside = all(kind == "scope" for kind, _, _ in open_)
            if inside and called and re.search(r"(?<!:) [:,] \w+$", before):
                open_.append(("initialiser", head, head_at))
                continue
            if inside and (scope := _SCOPE.search(before)) and not (called and before.endswith(")")):
                kind, name = "scope", (scope[1] or "") if "namespace" not in before else ""
            elif inside and called and not before.endswith("="):
                classes = [] if "::" in called[1] else [f"{name}::" for _, name, _ in open_ if name]
                kind, name = "function", "".join([*classes, called[1]])
            else:
                kind, name = "block" if before else "scope", ""
            open_.append((kind, name, head_at))
            head = ""
        elif token == "}":
            if not open_:
                continue
            kind, name, begin = open_.pop()
            head = f"{name} {{ }}" if kind == "initialiser" else ""
            head_at = begin if kind == "initialiser" else end
            if kind == "function":
                yield name, begin, end
        elif token == ";":
            head, head_at = "", end
        else:
            head = f"{head} {token}" if head else token
