"""Files are written whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tachk.base.whole_files import whole_file, whole_text, write_whole


def write_half(path: Path) -> None:
    with whole_text(path) as file:
        file.write("half")
        file.flush()
        raise KeyboardInterrupt


def test_what_is_broken_off_leaves_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "report.txt"
    for before in (None, "old"):
        if before is not None:
            path.write_text(before)
        with pytest.raises(KeyboardInterrupt):
            write_half(path)
        assert (path.read_text() if path.exists() else None) == before
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_keeps_its_permissions_and_its_links(tmp_path: Path) -> None:
    path, link = tmp_path / "report.txt", tmp_path / "link"
    path.write_text("old")
    path.chmod(0o640)
    link.symlink_to(path)
    write_whole(link, "new")
    assert link.is_symlink()
    assert path.read_text() == "new"
    assert path.stat().st_mode & 0o777 == 0o640
    write_whole(path, b"\r\n")
    assert path.read_bytes() == b"\r\n"


def test_a_new_file_has_the_permissions_of_other_new_files(tmp_path: Path) -> None:
    (tmp_path / "other").write_text("")
    write_whole(tmp_path / "report.txt", "new")
    assert (tmp_path / "report.txt").stat().st_mode == (tmp_path / "other").stat().st_mode


def test_a_file_that_is_not_made_is_not_there(tmp_path: Path) -> None:
    with whole_file(tmp_path / "report.txt") as part:
        part.unlink()
    assert list(tmp_path.iterdir()) == []


def test_errors_name_the_file(tmp_path: Path) -> None:
    path = tmp_path / "none" / "report.txt"
    with pytest.raises(FileNotFoundError) as caught:
        write_whole(path, "text")
    assert caught.value.filename == str(path)
    with pytest.raises(IsADirectoryError):
        write_whole(tmp_path, "text")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no named pipes")
def test_a_pipe_is_written_to(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reading = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_whole(pipe, "text")
    assert os.read(reading, 10) == b"text"
    os.close(reading)
    write_whole(Path(os.devnull), "text")
