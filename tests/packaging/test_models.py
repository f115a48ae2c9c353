"""The models of the project: in canonical form, and the same network however they are written down."""

from __future__ import annotations

from pathlib import Path

import pytest

from tachk.base.resources import data_root
from tachk.cli.commands.fmt import run_fmt
from tachk.cli.exit_status import ExitStatus

MODELS = sorted((data_root() / "models").rglob("*.ta"))


def test_there_are_models() -> None:
    assert MODELS


@pytest.mark.parametrize("path", MODELS, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_it_is_in_canonical_form(path: Path) -> None:
    """`tachk fmt` on the file mends a failure."""
    assert run_fmt((path,), check_only=True, to_stdout=False) is ExitStatus.AS_EXPECTED
