"""Every name of a module is used by the product, or stands below with who else uses it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.support.sources import tree_of

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ROOT / "src"

if not (ROOT / "CONTRIBUTING.md").is_file():
    pytest.skip("needs a checkout", allow_module_level=True)

USED_OTHERWISE = {
    "tachk.meaning.avoidance.elapse_before": "the oracle that the search for lassos is tested against",
    "tachk.formats.network_json.network.network_from_json": "docs/uppaal.md: networks from JSON",
    "tachk.formats.network_json.network.same_network": "docs/uppaal.md",
    "tachk.logic.patterns.patterns": "docs/sentence_pictures.py",
    "tachk.recordings.traces.core_monitor.TruthMonitor": "traces in portions, compared with the oracle",
    "tachk.recordings.traces.core_monitor.RobustnessMonitor": "traces in portions, compared with the oracle",
    "tachk.recordings.traces.linear_monitor.robustness_signal": "the values at every instant, compared with the oracle",
    "tachk.api.pytest_plugin": "pyproject.toml: an entry point",
    "tachk.cli.commands.verifyta.run": "pyproject.toml: a console script",
}
"""Modules, or names in them."""

_ROW = re.compile(r"tachk[\w.]*:\w+")
"""An object as tables name it: `tachk.base.plugins`."""

_MEANT_FOR_PYTHON = {"__all__", "__getattr__", "__dir__", "__version__"}


def _module_name(path: Path) -> str:
    return ".".join(path.relative_to(SOURCES).with_suffix("").parts).removesuffix(".__init__")


def _registers(decorator: ast.expr) -> bool:
    """Whether it makes a command, which the command line finds by itself."""
    made = decorator.func if isinstance(decorator, ast.Call) else decorator
    return isinstance(made, ast.Attribute) and made.attr in ("command", "group")


def _defined(tree: ast.Module) -> Iterator[str]:
    for node in tree.body:
        match node:
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                if not any(map(_registers, node.decorator_list)):
                    yield name
            case ast.Assign(targets=targets):
                yield from (target.id for target in targets if isinstance(target, ast.Name))
            case ast.AnnAssign(target=ast.Name(id=name)):
                yield name
            case _:
                pass


def _used(module: str, tree: ast.Module, modules: set[str]) -> Iterator[str]:
    """The names of modules that a module reads, as ``module.name``."""
    known: dict[str, str] = {}
    attributes: set[tuple[str, str]] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            if isinstance(node.ctx, ast.Load):
                yield f"{module}.{node.id}"
        elif isinstance(node, ast.Constant) and _ROW.fullmatch(str(node.value)):
            yield str(node.value).replace(":", ".")
        elif isinstance(node, ast.Attribute):
            if isinstance(node.value, ast.Name):
                attributes.add((node.value.id, node.attr))
        elif isinstance(node, ast.ImportFrom):
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                yield whole
                if whole in modules:
                    known[alias.asname or alias.name] = whole
    yield from (f"{known[owner]}.{name}" for owner, name in attributes if owner in known)


@cache
def unused() -> set[str]:
    trees = {_module_name(path): tree_of(path) for path in SOURCES.rglob("*.py")}
    product = {name: tree for name, tree in trees.items() if not name.startswith("tests.support")}
    used = {name for module, tree in product.items() for name in _used(module, tree, set(trees))}
    defined = {f"{module}.{name}" for module, tree in product.items() for name in _defined(tree)}
    return {name for name in defined - used if name.rpartition(".")[2] not in _MEANT_FOR_PYTHON}


def test_the_product_uses_what_it_defines() -> None:
    left = {name for name in unused() if name not in USED_OTHERWISE and name.rpartition(".")[0] not in USED_OTHERWISE}
    assert left == set()


def test_no_exception_is_stale() -> None:
    dead = unused()
    assert {
        name for name in USED_OTHERWISE if name not in dead and not any(n.startswith(f"{name}.") for n in dead)
    } == set()
