from __future__ import annotations

import re
from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.commands.models import run_copy, run_list
from tachk.cli.exit_status import ExitStatus
from tachk.cli.main import app


def test_systems_are_listed_and_parts_are_not(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_list() is ExitStatus.AS_EXPECTED
    lines = capsys.readouterr().out.splitlines()
    assert ["classics/fischer", "Fischer's mutual exclusion by timing."] in [line.split(maxsplit=1) for line in lines]
    assert not any(line.startswith("lib/") for line in lines)


def test_a_listed_model_has_a_whole_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    run_list()
    assert all(line.endswith((".", "!", "?")) for line in capsys.readouterr().out.splitlines())


def test_a_second_model_is_not_taken_for_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UsageError, match="csma_cd is the name of a model"):
        run_copy("fischer", Path("csma_cd"))
    assert not list(tmp_path.iterdir())


def test_a_model_without_imports_stands_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run_copy("fischer", tmp_path / "new")
    assert capsys.readouterr().out == f"written: {tmp_path / 'new/fischer.ta'}\n"
    assert tachk.load(tmp_path / "new/fischer.ta", N=2).verify().met


@pytest.mark.parametrize("name", ["publication", "micro_xrce_dds/subscription", "models/micro_xrce_dds/spec.ta"])
def test_a_model_comes_with_what_it_imports(name: str, tmp_path: Path) -> None:
    run_copy(name, tmp_path)
    (copied,) = tmp_path.rglob(Path(name).stem + ".ta")
    assert tachk.load(copied).properties


def test_an_edited_copy_is_not_lost(tmp_path: Path) -> None:
    run_copy("bridge", tmp_path)
    run_copy("bridge", tmp_path)
    (tmp_path / "bridge.ta").write_text("mine", encoding="utf-8")
    with pytest.raises(UsageError, match=r"bridge\.ta is there and different"):
        run_copy("bridge", tmp_path)
    run_copy("bridge", tmp_path, force=True)
    assert tachk.load(tmp_path / "bridge.ta").properties


def test_a_misspelt_model_is_guessed() -> None:
    with pytest.raises(UsageError) as caught:
        run_copy("fisher", Path())
    assert caught.value.help == "did you mean fischer?"


def test_the_skill_for_agents_is_copied(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    line = ["mcp", "--copy-skill", str(tmp_path)]
    assert app.main(line, standalone_mode=False) == 0
    skill = tmp_path / "tachk/SKILL.md"
    assert skill.read_text(encoding="utf-8").startswith("---\nname: tachk\n")
    pages = list((tmp_path / "tachk").rglob("*.md"))
    linked = [page.parent / name for page in pages for name in re.findall(r"\]\(([\w/.]+)\)", page.read_text("utf-8"))]
    assert len(linked) >= 3 and all(path.is_file() for path in linked)
    assert app.main(line, standalone_mode=False) == 0
    skill.write_text("mine")
    assert app.main(line, standalone_mode=False) == 2
    assert f"{skill} is there and different" in capsys.readouterr().err
