"""The parts of a server, each by itself."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest

if os.name != "posix":
    pytest.skip("needs Unix sockets", allow_module_level=True)

import resource
from types import SimpleNamespace

from click.testing import CliRunner

from tachk.cli import start
from tachk.cli.commands import serve
from tachk.cli.server import identity
from tachk.cli.server.binding import UnusableSocketError, bound
from tachk.cli.server.loop import Server
from tachk.cli.server.sources import Sources, loaded_files
from tachk.cli.server.worker import ProcessLimits, may_become


@pytest.fixture
def path(tmp_path: Path) -> Path:
    tmp_path.chmod(0o700)
    return tmp_path / "s"


def listening(path: Path) -> socket.socket:
    found = bound(str(path))
    assert found is not None
    return socket.socket(fileno=found.detach())


def test_an_idle_server_ends(path: Path) -> None:
    now = [100.0]
    server = Server(listening(path), str(path), 600, lambda: now[0])
    now[0] += 599
    assert (server.patience(), server.is_over()) == (1, False)
    with socket.socket(socket.AF_UNIX) as client:
        client.connect(str(path))
        client.sendall(b'{"id": 1, "server": "status"}\n')
        server.step(None, 0)
        server.step(None, 0)
        assert b'"under_way":0' in client.recv(4096)
        now[0] += 1
        assert server.is_over()  # a question about the server is no work
    server.serve()
    assert not path.exists()


def test_a_client_for_which_there_is_no_room_waits_until_another_has_gone(path: Path) -> None:
    server = Server(listening(path), str(path), 600)
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    with socket.socket(socket.AF_UNIX) as first, socket.socket(socket.AF_UNIX) as second:
        first.connect(str(path))
        server.step(None, 0)
        second.connect(str(path))
        second.sendall(b'{"id": 1, "server": "status"}\n')
        lowest = os.dup(first.fileno())
        os.close(lowest)
        try:
            resource.setrlimit(resource.RLIMIT_NOFILE, (lowest, before[1]))
            server.step(None, 0)
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, before)
        server.step(None, 0)
        with pytest.raises(BlockingIOError):
            second.recv(1, socket.MSG_DONTWAIT)
        first.close()
        for _ in range(4):
            server.step(None, 0)
        assert b'"status":0' in second.recv(4096)
    server.step(None, 0)
    server.leave()


def test_a_socket_that_is_not_the_servers_own_stays(path: Path) -> None:
    server = Server(listening(path), str(path), 0)
    path.unlink()
    other = listening(path)
    server.serve()
    assert path.exists()
    other.close()


def test_a_socket_of_a_killed_server_is_replaced(path: Path) -> None:
    listening(path).close()
    assert path.exists()
    found = listening(path)
    assert bound(str(path)) is None
    found.close()


def test_no_file_is_taken_for_a_socket(path: Path) -> None:
    path.write_text("mine")
    with pytest.raises(UnusableSocketError, match="is no socket"):
        bound(str(path))
    assert path.read_text() == "mine"


def test_a_folder_of_another_user_is_not_private(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert identity.mistake_of_folder(str(path.parent)) == ""
    monkeypatch.setattr(os, "getuid", lambda: 12345)
    assert identity.mistake_of_folder(str(path.parent)) == "it belongs to another user"


def test_programs_that_start_otherwise_have_other_servers(monkeypatch: pytest.MonkeyPatch) -> None:
    usual = identity.key()
    monkeypatch.setenv("TERM", "other")
    assert identity.key() == usual
    monkeypatch.setenv("LC_ALL", "C")
    assert identity.key() != usual


@pytest.mark.parametrize(
    ("words", "options"),
    [
        ("-W error -m tachk -X", "-W error"),
        ("-mtachk -X dev", ""),
        ("-Im tachk", "-I"),
        ("-Xdev -sP /bin/tachk -I", "-Xdev -sP"),
        ("-Wmodule -c pass", "-Wmodule"),
        ("/bin/tachk", ""),
    ],
)
def test_options_of_python_end_before_the_program(words: str, options: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.orig_argv", ["python", *words.split()])
    assert identity.interpreter_options() == options.split()


def test_the_folder_of_another_user_is_not_touched(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    assert identity.private_folder() == str(tmp_path / "tachk")
    monkeypatch.setenv("TMPDIR", "/elsewhere")
    monkeypatch.setattr(os, "getuid", lambda: 12345)
    assert identity.private_folder() == "/elsewhere/tachk-12345"


def test_a_system_without_such_sockets_has_no_server(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    windows = SimpleNamespace(name="nt")
    monkeypatch.setattr(start, "os", windows)
    start._use_server("auto")
    with pytest.raises(SystemExit) as ended:
        start._use_server("C:\\s")
    assert (ended.value.code, "there are no servers on this system" in capsys.readouterr().err) == (2, True)
    monkeypatch.setattr(serve, "os", windows)
    done = CliRunner().invoke(serve.command, [])
    assert (done.exit_code, "needs Unix sockets" in done.stderr) == (2, True)


def test_changed_sources_are_noticed(tmp_path: Path) -> None:
    assert not Sources(loaded_files()).changed()
    file = tmp_path / "a.py"
    for change in (lambda: file.write_text("1"), lambda: file.write_text("12"), file.unlink):
        sources = Sources([str(file)])
        assert not sources.changed()
        change()
        assert sources.changed()


def test_a_process_can_only_have_less() -> None:
    unlimited = resource.RLIM_INFINITY
    own = ProcessLimits(((10, 20), (unlimited, unlimited)), frozenset({0}), 0)
    for resources, niceness, possible in (
        (own.resources, 0, True),
        (((5, 20), (1, 2)), 3, True),
        (((10, 21), (unlimited, unlimited)), 0, False),
        (((10, unlimited), (unlimited, unlimited)), 0, False),
        (own.resources, -1, False),
    ):
        assert may_become(own, ProcessLimits(resources, frozenset({1}), niceness)) is possible
    assert may_become(None, None)
