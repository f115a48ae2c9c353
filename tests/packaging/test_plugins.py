"""Plug-ins are distributions of their own on the public interface; tachk says what to install where one is missing."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from importlib import import_module, metadata
from pathlib import Path
from types import ModuleType

import pytest

import tachk
from tachk.api import plugin, proofs
from tachk.cli.main import app
from tests.support.sources import tree_of

ROOT = Path(__file__).parents[2]
PLUGINS = sorted(path for path in (ROOT / "plugins").glob("*/src/*") if (path / "__init__.py").is_file())


def imports(folder: Path) -> Iterator[tuple[str, str]]:
    """Module and name of all that a package imports by name."""
    for path in folder.rglob("*.py"):
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.Import):
                yield from ((alias.name, "") for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                yield from ((node.module or "", alias.name) for alias in node.names)


@pytest.mark.parametrize("folder", PLUGINS, ids=lambda folder: folder.name)
def test_a_plug_in_imports_what_is_public(folder: Path) -> None:
    of_tachk = {(module, name) for module, name in imports(folder) if module.split(".")[0] == "tachk"}
    public = {(module.__name__, name) for module in (tachk, plugin, proofs) for name in module.__all__}
    assert of_tachk <= public


@pytest.mark.parametrize("home", [plugin, proofs], ids=lambda home: home.__name__)
def test_what_is_there_for_plug_ins_is_used_by_one(home: ModuleType) -> None:
    used = {name for folder in PLUGINS for module, name in imports(folder) if module == home.__name__}
    assert used == set(home.__all__)


@pytest.mark.parametrize("command", ["verify m.ta --munta proofs", "convert m.ta m.muntax"])
def test_a_plug_in_that_is_missing_is_named(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("m.ta").write_text("process P() { init location a; }\nsystem P;\nproperty p : A[] P.a;\n", encoding="utf-8")
    monkeypatch.setitem(sys.modules, "tachk_munta", None)
    with pytest.raises(SystemExit) as end:
        app(command.split(), prog_name="tachk")
    assert end.value.code == 3
    assert capsys.readouterr() == (
        "",
        "error: the plug-in tachk-munta is not installed\nhelp: pip install tachk-munta\n",
    )
    assert not Path("proofs").exists()


@pytest.mark.parametrize("folder", PLUGINS, ids=lambda folder: folder.name)
def test_an_installed_plug_in_is_whole(folder: Path) -> None:
    name = folder.parent.parent.name
    try:
        files = metadata.files(f"tachk-{name}")
    except metadata.PackageNotFoundError:
        pytest.skip(f"tachk-{name} is not installed")
    assert files is not None
    assert metadata.version(f"tachk-{name}") == import_module(folder.name).__version__
    installed = {path.name for path in files if path.parts[0] == folder.name and "__pycache__" not in path.parts}
    assert installed == {path.name for path in folder.iterdir() if path.name != "__pycache__"}
