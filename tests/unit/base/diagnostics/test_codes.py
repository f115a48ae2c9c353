"""Every code has one explanation."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import tachk.base.diagnostics
from tachk.base.diagnostics.codes.all_codes import CODES

FOLDER = Path(tachk.base.diagnostics.__file__).parent


def test_no_code_is_explained_twice() -> None:
    texts = [path.read_text(encoding="utf-8") for path in FOLDER.rglob("*_codes.py")]
    explained = Counter(code for text in texts for code in re.findall(r'"([EW]\d{4})": Explanation\(', text))
    assert [code for code, times in explained.items() if times > 1] == []
    assert set(explained) == set(CODES)
