"""What hosted builds, hooks and documents say about the project is what the project says itself."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

import tachk

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.skipif(not (ROOT / ".ci/run").is_file(), reason="needs a checkout")


def text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def project() -> dict[str, object]:
    return tomllib.loads(text("pyproject.toml"))


def supported_pythons() -> list[str]:
    """The versions among the classifiers, the oldest first."""
    found = re.findall(r'"Programming Language :: Python :: (3\.\d+)"', text("pyproject.toml"))
    return sorted(found, key=lambda version: int(version.split(".")[1]))


def test_yaml_can_be_read() -> None:
    yaml = pytest.importorskip("yaml")
    paths = [*(ROOT / ".github").rglob("*.yml"), ROOT / ".pre-commit-config.yaml"]
    assert len(paths) >= 7
    for path in paths:
        assert yaml.safe_load(path.read_text(encoding="utf-8")), path


def test_the_licences_of_others_are_distributed() -> None:
    of_others = {path.relative_to(ROOT).as_posix() for path in (ROOT / "third_party").iterdir()}
    assert {f"{folder}/LICENSE" for folder in of_others} | {"LICENSE"} == set(project()["project"]["license-files"])


def test_the_oldest_python_is_the_required_one() -> None:
    assert project()["project"]["requires-python"] == f">={supported_pythons()[0]}"
    assert project()["tool"]["mypy"]["python_version"] == supported_pythons()[0]


def test_hosted_builds_run_the_script_on_every_python() -> None:
    workflow = text(".github/workflows/ci.yml")
    assert "run: .ci/run" in workflow
    listed = re.search(r"python: \[(.*)\]", workflow)
    assert listed is not None
    assert re.findall(r'"(.*?)"', listed.group(1)) == supported_pythons()
    assert set(re.findall(r'python(?:-version)?: "(3\.\d+)"', workflow)) <= set(supported_pythons())
    assert {"g++", "clang++"} <= set(re.findall(r"compiler: \[?([\w+]+)", workflow))


def test_wheels_are_built_for_every_python() -> None:
    expected = [f"cp{version.replace('.', '')}-*" for version in supported_pythons()]
    assert project()["tool"]["cibuildwheel"]["build"].split() == expected


def test_a_tag_publishes_without_a_password() -> None:
    workflow = text(".github/workflows/wheels.yml")
    assert "id-token: write" in workflow
    assert "startsWith(github.ref, 'refs/tags/v')" in workflow
    assert "password" not in workflow.replace("there is no password", "").replace('--password-stdin <<< "$TOKEN"', "")


def test_presets_of_workflows_exist() -> None:
    presets = text("CMakePresets.json")
    named = [
        preset
        for name in (".ci/run", ".github/workflows/ci.yml", "CONTRIBUTING.md")
        for preset in re.findall(r"--workflow --preset ([\w-]+)", text(name))
    ]
    assert named
    for preset in named:
        assert f'"name": "{preset}"' in presets


def test_hooks_run_the_linters_of_the_script() -> None:
    hooks = text(".pre-commit-config.yaml")
    script = text(".ci/run")
    assert set(re.findall(r"id: ([\w-]+)", hooks)) == {"ruff", "ruff-format", "mypy", "lint-imports", "clang-format"}
    for command in ("ruff check", "ruff format", "mypy", "lint-imports", "clang-format"):
        assert f"entry: {command}" in hooks
        assert re.search(rf"^.*\b{command}\b", script, re.MULTILINE)


def test_changes_that_are_not_released_have_their_heading() -> None:
    headings = re.findall(r"^## (.*)$", text("CHANGELOG.md"), re.MULTILINE)
    assert headings[0] == "[Unreleased]"
    assert headings[1].startswith(f"[{tachk.__version__}]")


def test_every_decision_is_listed() -> None:
    pages = {path.name for path in (ROOT / "docs/decisions").glob("*.md")} - {"README.md"}
    assert set(re.findall(r"\]\(([\w-]+\.md)\)", text("docs/decisions/README.md"))) == pages


DECISION = ["Context", "Decision", "What was measured", "Consequences", "What would change our mind"]


def test_every_decision_has_its_parts() -> None:
    index = text("docs/decisions/README.md").replace("\n  ", " ")
    for path in (ROOT / "docs/decisions").glob("[!R]*.md"):
        page = path.read_text(encoding="utf-8")
        assert re.findall(r"^## (.*)$", page, re.MULTILINE) == DECISION, path
        assert f"- [{page.splitlines()[0].removeprefix('# ')}]({path.name}): " in index
