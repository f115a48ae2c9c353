from __future__ import annotations

import os
import subprocess
import sys

import pytest


def complete(words: str, position: int) -> list[str]:
    asked = {"COMP_WORDS": words, "COMP_CWORD": str(position), "_TACHK_COMPLETE": "bash_complete"}
    command = [sys.executable, "-m", "tachk"]
    done = subprocess.run(command, env=os.environ | asked, capture_output=True, text=True, check=True)
    return done.stdout.split()


def test_commands_options_choices_and_files_are_completed() -> None:
    assert "plain,verify" in complete("tachk ver", 1)
    assert "plain,--max-states" in complete("tachk verify --max-", 2)
    assert complete("tachk verify --search ", 3) == [
        "plain,auto",
        "plain,bfs",
        "plain,dfs",
        "plain,rdfs",
        "plain,progress",
        "plain,best-first",
    ]
    assert complete("tachk check mod", 2) == ["file,mod"]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_script_is_printed_for_each_shell(shell: str) -> None:
    command = [sys.executable, "-m", "tachk", "completion", shell]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert f"_TACHK_COMPLETE={shell}_complete" in done.stdout
