"""The command line of verifyta: whatever it lists is read."""

from __future__ import annotations

import pytest

from tachk.cli.verifyta_options import _BY_NAME, _STATISTICAL, parse_arguments


@pytest.mark.parametrize("name", sorted(_BY_NAME))
def test_every_option_is_read(name: str) -> None:
    value = (
        ["std" if name == "output" else "1" if name not in _STATISTICAL else "0.1"]
        if _BY_NAME[name].takes_value
        else []
    )
    assert parse_arguments([f"--{name}", *value, "m.xml"]).model == "m.xml"
