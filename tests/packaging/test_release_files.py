"""The files with which tachk is published and used by other services fit together."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import yaml

import tachk
from tachk.cli.main import COMMANDS, load_command

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
ACTION = yaml.safe_load((ROOT / "action.yml").read_text(encoding="utf-8"))
HOOKS = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text(encoding="utf-8"))
WORKFLOWS = sorted((ROOT / ".github/workflows").glob("*.yml"))

BROKEN = "process P() { init location a; }\nsystem P;\nproperty never : E<> false;\n"


def script(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, ROOT / ".ci" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def distribution_of(requirement: str) -> str:
    return re.split(r"[^\w.-]", requirement, maxsplit=1)[0]


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_workflows_name_jobs_and_files_that_exist(path: Path) -> None:
    workflow = yaml.safe_load(path.read_text(encoding="utf-8"))
    for job in workflow["jobs"].values():
        needed = job.get("needs", [])
        assert {needed} if isinstance(needed, str) else set(needed) <= set(workflow["jobs"])
        for step in job["steps"]:
            for file in re.findall(r"(?<![\w/])\.ci/[\w.]+", step.get("run", "")):
                assert (ROOT / file).is_file(), file


def test_the_action_uses_the_inputs_that_it_has() -> None:
    text = (ROOT / "action.yml").read_text(encoding="utf-8")
    assert set(re.findall(r"inputs\.([\w-]+)", text)) == set(ACTION["inputs"])


def run_steps(folder: Path, inputs: dict[str, str]) -> list[tuple[str, int, str]]:
    """Runs the shell steps of the action but the installation; name, status, output of each, up to a failure."""
    program = folder / "bin/tachk"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m tachk "$@"\n', encoding="utf-8")
    program.chmod(0o755)
    given = {name: inputs.get(name, entry.get("default", "")) for name, entry in ACTION["inputs"].items()}
    outcomes = []
    for step in ACTION["runs"]["steps"]:
        if "run" not in step or step["name"] == "Install":
            continue
        if condition := step.get("if"):
            name, wanted = re.fullmatch(r"inputs\.([\w-]+) == '(\w+)'", condition).groups()  # type: ignore[union-attr]
            if given[name] != wanted:
                continue
        named = {key: given[text.removeprefix("${{ inputs.").removesuffix(" }}")] for key, text in step["env"].items()}
        variables = {**os.environ, **named, "PATH": f"{program.parent}:{os.environ['PATH']}"}
        ended = subprocess.run(
            ["bash", "-eo", "pipefail", "-c", step["run"]], cwd=folder, env=variables, capture_output=True, text=True
        )
        outcomes.append((step["name"], ended.returncode, ended.stdout))
        if ended.returncode:
            break
    return outcomes


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
def test_the_steps_of_the_action_run(tmp_path: Path) -> None:
    shutil.copy(ROOT / "models/classics/fischer.ta", tmp_path)
    steps = run_steps(tmp_path, {"models": "*.ta", "arguments": "-D N=2", "check-format": "true"})
    assert [(name, status) for name, status, _ in steps] == [("Canonical form", 0), ("Check", 0), ("Verify", 0)]
    assert (tmp_path / "tachk.xml").is_file()


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
def test_the_action_marks_a_violation_and_fails(tmp_path: Path) -> None:
    (tmp_path / "m.ta").write_text(BROKEN, encoding="utf-8")
    *_, (name, status, said) = run_steps(tmp_path, {"models": "m.ta"})
    assert (name, status) == ("Verify", 10)
    assert "::error file=m.ta,line=3" in said


@pytest.mark.parametrize("hook", HOOKS, ids=lambda hook: hook["id"])
def test_hooks_call_commands_that_exist(hook: dict[str, Any], tmp_path: Path) -> None:
    program, command, *options = hook["entry"].split()
    assert program in PROJECT["project"]["scripts"]
    assert command in COMMANDS
    known = {option for parameter in load_command(command).params for option in parameter.opts}
    assert set(options) <= known
    assert re.search(hook["files"], "models/m.ta")


def test_the_notes_of_this_version_are_in_the_changelog() -> None:
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    if re.search(rf"^## \[?{re.escape(tachk.__version__)}\]?", text, re.MULTILINE):
        notes = script("release_notes").release_notes(f"v{tachk.__version__}")
        assert notes.startswith("### ")
        assert "\n## " not in notes
    with pytest.raises(SystemExit, match="no section for v99"):
        script("release_notes").release_notes("v99")


def test_recipe_and_formula_name_the_source_and_what_tachk_needs(tmp_path: Path) -> None:
    source = tmp_path / "tachk-1.2.3.tar.gz"
    source.write_bytes(b"source")
    script("fill_in").fill_in("https://example.org/tachk", "v1.2.3", source, tmp_path)
    where = "https://example.org/tachk/releases/download/v1.2.3/tachk-1.2.3.tar.gz"
    text = (tmp_path / "recipe.yaml").read_text(encoding="utf-8")
    recipe = yaml.safe_load(text)
    assert recipe["context"]["version"] == "1.2.3"
    assert recipe["source"] == {"url": where, "sha256": hashlib.sha256(b"source").hexdigest()}
    needed = {text.split(";")[0].replace(",<", " <").replace(",", " ") for text in PROJECT["project"]["dependencies"]}
    run = {re.sub(r" >=", ">=", line).replace(",<", " <") for line in recipe["requirements"]["run"]} - {"python"}
    assert run == needed
    formula = (tmp_path / "tachk.rb").read_text(encoding="utf-8")
    assert where in formula
    assert "@VERSION@" not in text + formula
    assert not re.search(r"@[A-Z0-9]+@", text + formula)
    programs = {line.partition(" = ")[::2] for line in recipe["build"]["python"]["entry_points"]}
    assert programs == set(PROJECT["project"]["scripts"].items())


def test_the_image_installs_extras_that_exist() -> None:
    text = (ROOT / "Dockerfile").read_text(encoding="utf-8")
    (extras,) = re.findall(r"\.whl\)\[([\w,]+)\]", text)
    assert set(extras.split(",")) <= set(PROJECT["project"]["optional-dependencies"])
    assert re.search(r'^ENTRYPOINT \["tachk"\]$', text, re.MULTILINE)


def test_wheels_for_musl_are_built_without_z3(tmp_path: Path) -> None:
    (override,) = PROJECT["tool"]["cibuildwheel"]["overrides"]
    expression = re.fullmatch(r"sed -i '/([\w-]+)/d' \{project\}/pyproject\.toml", override["before-build"])
    assert expression is not None
    lines = (ROOT / "pyproject.toml").read_text(encoding="utf-8").splitlines(keepends=True)
    left = tomllib.loads("".join(line for line in lines if expression[1] not in line))
    names = [list(map(distribution_of, each["project"]["dependencies"])) for each in (PROJECT, left)]
    assert names[1] == [name for name in names[0] if name != "z3-solver"]
