"""Files that are texts, nearly texts, and no texts."""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.syntax.source_files import LARGEST_FILE, read_source


@pytest.mark.parametrize(
    ("data", "text"),
    [
        (b"int a;\r\n", "int a;\r\n"),
        (b"\xef\xbb\xbfint a;", "int a;"),
        ("int a; // größer".encode(), "int a; // größer"),
        ("int a; // größer".encode("latin-1"), "int a; // größer"),
    ],
)
def test_texts(tmp_path: Path, data: bytes, text: str) -> None:
    path = tmp_path / "m.ta"
    path.write_bytes(data)
    assert read_source(path).text == text


@pytest.mark.parametrize(
    ("data", "code"),
    [
        (b"", "E0006"),
        (b" \n\t", "E0006"),
        (b"int a;\0", "E0001"),
        ("int a;".encode("utf-16"), "E0001"),
        (b"\x7fELF\x02\x01\x01" + bytes(range(1, 32)) * 9, "E0001"),
        (Random(1).randbytes(200_000), "E0001"),
        (bytes(range(0x80, 0xA0)) * 1000, "E0001"),
    ],
)
def test_no_texts(tmp_path: Path, data: bytes, code: str) -> None:
    path = tmp_path / "m.ta"
    path.write_bytes(data)
    with pytest.raises(InputError) as caught:
        read_source(path)
    assert [diagnostic.code for diagnostic in caught.value.diagnostics] == [code]


def test_what_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="there is no file"):
        read_source(tmp_path / "none.ta")
    with pytest.raises(UsageError, match="is a directory"):
        read_source(tmp_path)
    with pytest.raises(UsageError, match="not a file name"):
        read_source("a\0b")


def test_a_file_that_is_too_large(tmp_path: Path) -> None:
    path = tmp_path / "m.ta"
    with path.open("wb") as stream:
        stream.write(b"int a;\n" * 10_000)
        stream.truncate(LARGEST_FILE + 1)
    with pytest.raises(UsageError, match="too large"):
        read_source(path)
