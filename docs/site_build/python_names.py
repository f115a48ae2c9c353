"""The reference of the Python interface: every public name. mkdocstrings reads its signature and its docstring."""

from __future__ import annotations

import ast
import inspect
import re
import sys
import typing
from collections.abc import Iterator, Mapping
from enum import Enum
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import tachk
from docs.site_build import markdown
from docs.site_build.site_files import ROOT, Section, SiteFile

FOLDER = "reference/python/"
STABILITY = ROOT / "docs/stability.md"

_ALONE = ("Model", "Report", "Monitor", "MonitorReport")
"""Classes with a page of their own, by importance."""


def promised_names(stability: str) -> dict[str, tuple[str, ...]]:
    """The names of each module beside `tachk` that are promised: rows of a table in `docs/stability.md`."""
    rows = re.findall(r"^\| `(tachk(?:\.\w+)+)` \| (.*) \|$", stability, re.MULTILINE)
    assert rows, "docs/stability.md has a table of modules"
    return {module: _names_in(module, names) for module, names in sorted(rows)}


def _names_in(module: str, cell: str) -> tuple[str, ...]:
    if "`__all__`" in cell:
        return tuple(import_module(module).__all__)
    return tuple(re.findall(r"`(\w+)`", cell))


def kinds() -> dict[str, tuple[str, ...]]:
    """The names of `tachk.__all__`, by the page that has them."""
    values = {name: getattr(tachk, name) for name in tachk.__all__}
    classes = {name: value for name, value in values.items() if inspect.isclass(value)}
    errors = tuple(name for name, value in classes.items() if issubclass(value, Exception))
    choices = tuple(name for name, value in classes.items() if issubclass(value, Enum))
    others = tuple(name for name in classes if name not in {*errors, *choices, *_ALONE})
    return {
        "Functions": tuple(name for name in values if name not in classes),
        **{name: (name,) for name in _ALONE},
        "Other classes": others,
        "Choices": choices,
        "Errors": errors,
    }


def public_members() -> Iterator[tuple[str, object]]:
    """The functions and methods that the reference has, with their dotted names."""
    values = [(f"tachk.{name}", getattr(tachk, name)) for name in tachk.__all__]
    values += [(path, _at(path)) for path in returned_types()]
    for path, value in values:
        if not isinstance(value, str):
            yield path, value
        if inspect.isclass(value):
            yield from ((f"{path}.{function.__name__}", function) for function in _functions(value))


def _at(path: str) -> object:
    module, _, name = path.rpartition(".")
    return getattr(import_module(module), name)


def returned_types() -> tuple[str, ...]:
    """The classes beside `tachk.__all__` that its functions, methods and attributes give, as dotted paths."""
    public = [getattr(tachk, name) for name in tachk.__all__]
    found = {
        f"{each.__module__}.{each.__qualname__}"
        for value in public
        for function in _functions(value)
        for each in _classes(_annotation(function))
        if each.__module__.startswith("tachk.") and each not in public
    }
    return tuple(sorted(found, key=lambda path: path.rpartition(".")[2]))


def _functions(value: object) -> Iterator[Any]:
    if not inspect.isclass(value):
        yield value
        return
    members = {name: each for base in reversed(_ours(value)) for name, each in vars(base).items()}
    for name, member in members.items():
        function = member.fget if isinstance(member, property) else getattr(member, "__func__", member)
        if not name.startswith("_") and inspect.isfunction(function):
            yield function


def _ours(value: type) -> list[type]:
    """The class and what it inherits from in tachk."""
    return [base for base in value.__mro__ if base.__module__.startswith("tachk.")]


def _annotation(function: object) -> object:
    """What a function returns; its module may name types for type checkers only."""
    if not inspect.isfunction(function):
        return None
    original = inspect.unwrap(function)
    module = sys.modules[original.__module__]
    written = original.__annotations__.get("return")
    return eval(written, {**_named_for_checkers(module), **vars(module)}) if isinstance(written, str) else written


def _named_for_checkers(module: ModuleType) -> dict[str, object]:
    """What a module imports below `if TYPE_CHECKING`."""
    tree = ast.parse(Path(str(module.__file__)).read_text(encoding="utf-8"))
    return {
        alias.asname or alias.name: getattr(import_module(str(statement.module)), alias.name)
        for node in tree.body
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
        for statement in node.body
        if isinstance(statement, ast.ImportFrom) and str(statement.module).startswith("tachk")
        for alias in statement.names
    }


def _classes(annotation: object) -> Iterator[type]:
    if inspect.isclass(annotation):
        yield annotation
    for argument in typing.get_args(annotation):
        yield from _classes(argument)


def python_section(stability: str) -> Section:
    """An overview, pages for the names of `tachk`, for what they return, and for each promised module."""
    modules = promised_names(stability)
    named = {title: [f"tachk.{name}" for name in names] for title, names in kinds().items()}
    pages = [
        *(_page(title, paths) for title, paths in named.items()),
        _page("Results", returned_types(), "What functions and methods of `tachk` return. Import none of these names."),
        *(_page(name, [f"{name}.{each}" for each in names], _summary_of(name)) for name, names in modules.items()),
    ]
    overview = SiteFile(f"{FOLDER}index.md", _overview(modules), "All names")
    groups = {"Modules": tuple(_path(name) for name in modules)}
    return Section(FOLDER, (overview, *pages), groups=groups)


def _path(title: str) -> str:
    return f"{FOLDER}{title.lower().replace(' ', '_')}.md"


def _page(title: str, paths: typing.Iterable[str], introduction: str = "") -> SiteFile:
    directives = (f"::: {path}" for path in paths)
    return SiteFile(_path(title), markdown.joined(f"# {title}", introduction, *directives), title)


def _overview(modules: Mapping[str, tuple[str, ...]]) -> str:
    rows = [
        (f"[`{name}`]({_path(title).removeprefix(FOLDER)}#tachk.{name})", _summary(getattr(tachk, name)))
        for title, names in kinds().items()
        for name in names
    ]
    others = [(f"[`{name}`]({_path(name).removeprefix(FOLDER)})", _summary_of(name)) for name in modules]
    return markdown.joined(
        "# Python interface",
        "These names are stable; see [What is stable](/docs/stability.md). "
        "[Python](/docs/python.md) shows how to use them.",
        "## import tachk",
        markdown.table(("name", "what it is"), rows),
        "## Modules",
        markdown.table(("module", "what it is for"), others),
    )


def _summary(value: object) -> str:
    """The first sentence of a docstring."""
    if isinstance(value, str):
        return "The version of tachk."
    text = inspect.getdoc(value) or ""
    return markdown.plain(" ".join(text.partition("\n\n")[0].replace("``", "`").split()))


def _summary_of(module: str) -> str:
    return _summary(import_module(module))
