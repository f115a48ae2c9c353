"""Pipes are read without waiting for long."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator

import pytest

from tachk.base import awaited_pipe as module
from tachk.base.awaited_pipe import AwaitedPipe, PipeBySelect, PipeByThread


@pytest.fixture
def ends() -> Iterator[tuple[int, int]]:
    reading, writing = os.pipe()
    yield reading, writing
    os.close(reading)


@pytest.mark.parametrize("opened", [PipeBySelect, PipeByThread])
def test_a_pipe_gives_what_comes(
    ends: tuple[int, int], opened: Callable[[int], AwaitedPipe], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "PATIENCE", 0.001)
    reading, writing = ends
    pipe = opened(reading)
    assert pipe.read1(10) is None
    os.write(writing, b"time,p\n0,1\n")
    os.close(writing)
    got = b""
    while (piece := pipe.read1(4)) != b"":
        assert piece is None or len(piece) <= 4
        got += piece or b""
    assert got == b"time,p\n0,1\n"
    assert pipe.read1(4) == b""
