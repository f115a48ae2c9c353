"""The page about the architecture says what the code does."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from tachk.engine.options import REDUCTIONS
from tachk.engine.portfolio import PORTFOLIO, SearchStrategy
from tachk.transform.transformation import Exactness
from tachk.verify.strategies import every_strategy
from tachk.verify.strategy import Strategy

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")


def test_the_drawing_has_the_rooms_in_the_order_of_the_contract() -> None:
    (drawing,) = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)
    rooms = [line.split()[0] for line in drawing.splitlines()]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    (layers,) = (each["layers"] for each in contracts if each["type"] == "layers" and each["exhaustive"])
    assert rooms == layers
    folders = {path.parent.name for path in (ROOT / "src/tachk").glob("*/__init__.py")}
    assert set(rooms) == folders


def test_the_tables_are_those_of_the_code() -> None:
    rows = re.findall(r"^\| `([\w-]+)` \| (.*?) \| (\w+) \|$", PAGE, re.MULTILINE)
    assert rows == [(row.name, row.meaning, _decides(row)) for row in (*every_strategy(), *PORTFOLIO)]


def _decides(strategy: Strategy | SearchStrategy) -> str:
    found = Exactness.REACHABLE in strategy.exactness or Exactness.RUN in strategy.exactness
    absent = Exactness.UNREACHABLE in strategy.exactness or Exactness.NO_RUN in strategy.exactness
    return "both" if found and absent else "found" if found else "absent"


def test_reductions_and_files_that_are_named_exist() -> None:
    assert all(f"`{name}`" in PAGE for name in REDUCTIONS)
    for path in re.findall(r"`((?:\w+/)+\w+\.py)`", PAGE):
        assert (ROOT / "src/tachk" / path).is_file() or (ROOT / path).is_file(), path


def test_it_is_short() -> None:
    assert len(PAGE.splitlines()) <= 150
