"""Every setting that a model or a page tells one to try is as the model expects."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

import tachk
from tachk.base.resources import data_root

pytestmark = pytest.mark.drawn(8)

ROOT = Path(__file__).parents[2]
MODELS = data_root() / "models"
COMMAND = re.compile(r"tachk verify (?P<path>[\w/]+\.ta)(?P<options>(?: (?:-D|--property|--search|--trace) [^\s`]+)+)")
OPTION = re.compile(r"`(-D [^`]*)`")
STATES = 300_000


def tried_in_models() -> list[str]:
    """The commands behind ``Try it:`` in the comments of models: path and options."""
    return [
        f"{model.parent.relative_to(MODELS) / match['path']}{match['options']}"
        for model in sorted(MODELS.rglob("*.ta"))
        for match in COMMAND.finditer(model.read_text(encoding="utf-8"))
    ]


def named_in_documents() -> list[str]:
    """The commands about shipped models in the pages, and the table of settings that are worth trying."""
    found = []
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))):
        found += [
            f"{match['path'].removeprefix('models/')}{match['options']}"
            for match in COMMAND.finditer(page.read_text(encoding="utf-8"))
            if match["path"].startswith("models/")
        ]
    table = re.findall(
        r"^\| `([\w/]+\.ta)` (\|.*)$", (ROOT / "docs/models.md").read_text(encoding="utf-8"), re.MULTILINE
    )
    tried = [(name if "/" in name else f"classics/{name}", row) for name, row in table if not name.startswith("lib/")]
    return found + [f"{name} {options}" for name, row in tried for options in OPTION.findall(row)]


TOO_LARGE = {"micro_xrce_dds/client_3_0.ta -D LOSSES=5 --property NIWS_weak --trace none"}
"""The search through 110 million states that docs/performance.md measures."""

SETTINGS = sorted({*tried_in_models(), *named_in_documents()} - TOO_LARGE)


@pytest.mark.parametrize("setting", SETTINGS)
def test_a_setting_is_as_the_model_expects(setting: str) -> None:
    model, *words = shlex.split(setting)
    options = list(zip(words[::2], words[1::2], strict=True))
    constants = dict(value.split("=", 1) for option, value in options if option == "-D")
    report = tachk.load(MODELS / model, **constants).verify(
        property=[value for option, value in options if option == "--property"],
        trace=False,
        limits=tachk.Limits(states=STATES),
        options=tachk.Options(order=tachk.SearchOrder(dict(options).get("--search", "bfs"))),
    )
    assert {verdict.query.name: verdict.answer.value for verdict in report if verdict.met is not True} == {}


def test_there_are_settings() -> None:
    assert len(tried_in_models()) >= 15
    assert len(named_in_documents()) >= 10
