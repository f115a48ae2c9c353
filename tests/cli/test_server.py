"""`tachk serve`: a command means with a server what it means without one."""

from __future__ import annotations

import json
import os
import re
import select
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

from tests.support.seeds import some

pytestmark = pytest.mark.skipif(os.name != "posix", reason="needs Unix sockets")

TACHK = (sys.executable, "-m", "tachk")
MODEL = """process P() { clock x; init location a { to b { guard x >= 1; } } location b; }
system P;
property p : A[] not P.b;
"""
LONG = """int[0, 100000000] n;
process P() { init location a { to a { guard n < 100000000; assign n = n + 1; } } }
system P;
property p : A[] n <= 100000000;
"""
FILES = {
    "m.ta": MODEL,
    "long.ta": LONG,
    "wrong.ta": "process P() { init location a {} } system Q;",
    "t.csv": "t,x\n0,1\n1,2\n2,9\n",
    "other/m.ta": MODEL.replace("A[] not P.b", "E<> P.b"),
}

COMMAND_LINES = [
    "verify m.ta",
    "verify m.ta --format json",
    "verify m.ta no.ta",
    "verify wrong.ta",
    "verify m.ta 'E<> P.c'",
    "verify m.ta --no-such-option",
    "verify long.ta --max-states 1000",
    "verify long.ta --max-seconds 0",
    "verify m.ta -j 2 'E<> P.b' 'A[] P.x >= 0'",
    "check m.ta wrong.ta",
    "fmt m.ta --check",
    "explain - < m.ta",
    "explain E0101",
    "simulate m.ta --runs 3",
    "monitor 'G (x < 9)' t.csv",
    "monitor 'G (x < 9)' <(cat t.csv)",
    "monitor 'G (x < 9)' - < t.csv",
    "sweep m.ta -j 2 -D N=1..2",
    "step m.ta < /dev/null",
    "draw m.ta -o picture.svg; cat picture.svg",
    "cd other; tachk verify m.ta",
    "export FORCE_COLOR=1; tachk verify m.ta; tachk verify wrong.ta",
    "export COLUMNS=30; tachk --help",
    "umask 077; tachk verify m.ta -o private.txt; stat -c %a private.txt",
    "umask 002; tachk verify m.ta -o shared.txt; stat -c %a shared.txt",
    "ulimit -f 0; tachk verify m.ta -o out.txt",
    "verify m.ta | cat",
    "verify m.ta >&-",
    "verify m.ta > /dev/full",
    "nonsense",
    "--version",
    "",
    "export _TACHK_COMPLETE=bash_complete COMP_WORDS='tachk ver' COMP_CWORD=1; tachk",
    "export LC_ALL=C PYTHONUTF8=0 PYTHONCOERCECLOCALE=0; tachk verify m.ta",
    "export PYTHONIOENCODING=latin-1; tachk verify m.ta",
]


def environment(folder: Path, setting: str = "off", **more: str) -> dict[str, str]:
    return {**os.environ, "XDG_RUNTIME_DIR": str(folder), "TACHK_SERVER": setting, **more}


def run(line: str, cwd: Path, variables: Mapping[str, str]) -> tuple[int, str, str]:
    """What a shell does with a command line, in which `tachk` stands first where it is not named."""
    script = f'tachk() {{ "{sys.executable}" -m tachk "$@"; }}\n{line if "tachk" in line else f"tachk {line}"}'
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", script], cwd=cwd, env=variables, capture_output=True, check=False, timeout=60
    )
    output = re.sub(rb"[\d.]+ ([kM]i?B|m?s)\b", rb"? \1", done.stdout, flags=re.IGNORECASE)
    output = re.sub(rb'"(seconds|bytes)":\s*[\d.e-]+', rb'"\1": ?', output)
    return done.returncode, re.sub(r"  +", "  ", output.decode("latin-1")), done.stderr.decode("latin-1")


def call(*words: str, cwd: Path, variables: Mapping[str, str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*TACHK, *words], cwd=cwd, env=variables, capture_output=True, text=True, check=False, timeout=60
    )


@pytest.fixture
def models(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        path = tmp_path / "models" / name
        path.parent.mkdir(exist_ok=True, parents=True)
        path.write_text(text, encoding="utf-8")
    return tmp_path / "models"


def sockets(folder: Path) -> list[Path]:
    """The sockets in a folder for sockets, without the links by which `tachkc` finds them."""
    return [path for path in (folder / "tachk").glob("*.sock") if not path.is_symlink()]


@pytest.fixture(scope="module")
def runtime(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A folder for sockets; whatever serves one of them is ended behind the tests."""
    folder = tmp_path_factory.mktemp("run")
    folder.chmod(0o700)
    yield folder
    for path in sockets(folder):
        inquire(path, "stop")


class Client:
    """A connection that speaks the documented protocol."""

    def __init__(self, path: Path | str) -> None:
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(60)
        self.socket.connect(str(path))
        self.lines = self.socket.makefile("rb")

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self.lines.close()
        self.socket.close()

    def send(self, message: Mapping[str, Any]) -> None:
        self.socket.sendall(json.dumps(message).encode() + b"\n")

    def receive(self) -> dict[str, Any]:
        reply = json.loads(self.lines.readline())
        assert isinstance(reply, dict)
        return reply

    def ask(self, message: Mapping[str, Any]) -> dict[str, Any]:
        self.send(message)
        return self.receive()

    def replies(self) -> dict[str, Any]:
        """The replies to a request together, up to the last one."""
        texts = {"stdout": "", "stderr": ""}
        while "status" not in (reply := self.receive()):
            if "stream" in reply:
                texts[reply["stream"]] += reply["text"]
        return texts | reply


@pytest.fixture(scope="module")
def server(runtime: Path) -> Iterator[Path]:
    path = runtime / "tachk" / "test.sock"
    command = [*TACHK, "serve", "--socket", str(path)]
    with subprocess.Popen(command, env=environment(runtime), stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == f"serving {path}\n"
        yield path
        process.terminate()
        assert process.wait(60) == 0
    assert not path.exists()


@pytest.fixture
def client(server: Path) -> Iterator[Client]:
    with Client(server) as connected:
        yield connected


def inquire(path: Path, question: str = "status") -> dict[str, int]:
    """What a server says of itself."""
    with Client(path) as client:
        about = client.ask({"id": 1, "server": question})["server"]
    assert isinstance(about, dict)
    return about


def test_a_command_does_the_same_with_and_without_a_server(server: Path, runtime: Path, models: Path) -> None:
    different = []
    for line in some(COMMAND_LINES, 8):
        # Settings of Python itself, and of languages, have a server of their own.
        setting = "auto" if "PYTHON" in line else str(server)
        alone = run(line, models, environment(runtime))
        served = run(line, models, environment(runtime, setting))
        if served != alone:
            different.append((line, alone, served))
    assert different == []


def test_a_plain_command_is_carried_out_by_the_server(server: Path, runtime: Path, models: Path) -> None:
    before = inquire(server)["carried_out"]
    assert call("verify", "m.ta", cwd=models, variables=environment(runtime, str(server))).returncode == 10
    assert call("verify", "m.ta", cwd=models / "other", variables=environment(runtime, str(server))).returncode == 0
    assert inquire(server)["carried_out"] == before + 2


def test_a_closed_pipe_ends_the_program_by_its_signal(server: Path, runtime: Path, models: Path) -> None:
    for setting in ("off", str(server)):
        reader, writer = os.pipe()
        os.close(reader)
        done = subprocess.run(
            [*TACHK, "verify", "m.ta"],
            cwd=models,
            env=environment(runtime, setting),
            stdout=writer,
            check=False,
            timeout=60,
        )
        os.close(writer)
        assert done.returncode == -signal.SIGPIPE


def test_a_file_that_has_changed_is_read_again(server: Path, runtime: Path, models: Path) -> None:
    served = environment(runtime, str(server))
    assert call("verify", "m.ta", cwd=models, variables=served).returncode == 10
    (models / "m.ta").write_text(MODEL.replace(">= 1", ">= 1 && false"), encoding="utf-8")
    assert call("verify", "m.ta", cwd=models, variables=served).returncode == 0


def request(models: Path, *words: str, **more: Any) -> dict[str, Any]:
    return {"id": 1, "argv": words, "cwd": str(models), **more}


def test_a_client_that_sends_no_descriptors_gets_texts(client: Client, models: Path) -> None:
    client.send(request(models, "monitor", "G (x < 9)", "-", stdin="t,x\n0,1\n"))
    found = client.replies()
    assert (found["status"], found["stderr"]) == (0, "")
    assert "p1  true  G (x < 9)" in found["stdout"]
    client.send(request(models, "verify", "wrong.ta", id="again"))
    found = client.replies()
    assert (found["id"], found["status"], found["stdout"]) == ("again", 2, "")
    assert "wrong.ta:1:43: error" in found["stderr"]
    client.send(request(models, "verify", "m.ta", environment={**os.environ, "FORCE_COLOR": "1"}))
    assert "\x1b[" in client.replies()["stdout"]
    client.send(request(models, "verify", "m.ta"))
    assert "\x1b[" not in client.replies()["stdout"]
    client.send(request(models / "nowhere", "verify", "m.ta"))
    assert client.replies()["stderr"] == f"error: {models}/nowhere: No such file or directory\n"


def test_a_client_may_end_its_side_and_wait(client: Client, models: Path) -> None:
    client.send(request(models, "--version"))
    client.socket.shutdown(socket.SHUT_WR)
    assert client.replies()["stdout"].startswith("tachk ")
    assert client.lines.read() == b""


@pytest.mark.parametrize(
    ("line", "identifier", "wrong"),
    [
        (b"verify m.ta", None, "no JSON"),
        (b"[" * 100000, None, "no JSON"),
        (b"\xff\xfe", None, "no JSON"),
        (b"[]", None, "object"),
        (b"{}", None, "`id`"),
        (b'{"id": 1}', 1, "`argv`"),
        (b'{"id": 1, "argv": [], "server": "stop"}', 1, "one of"),
        (b'{"id": 1, "argv": "verify", "cwd": "/"}', 1, "`argv`"),
        (b'{"id": 1, "argv": [1], "cwd": "/"}', 1, "`argv`"),
        (b'{"id": "a", "argv": ["\\u0000"], "cwd": "/"}', "a", "`argv`"),
        (b'{"id": 1, "argv": []}', 1, "`cwd`"),
        (b'{"id": 1, "argv": [], "cwd": "."}', 1, "`cwd`"),
        (b'{"id": 1, "argv": [], "cwd": "/", "enviroment": {}}', 1, "no field `enviroment`"),
        (b'{"id": 1, "argv": [], "cwd": "/", "environment": {"A=": "b"}}', 1, "`environment`"),
        (b'{"id": 1, "argv": [], "cwd": "/", "environment": {"A": 1}}', 1, "`environment`"),
        (b'{"id": 1, "argv": [], "cwd": "/", "umask": true}', 1, "`umask`"),
        (b'{"id": 1, "argv": [], "cwd": "/", "ignored": ["SIGKILL"]}', 1, "`ignored`"),
        (b'{"id": 1, "argv": [], "cwd": "/", "descriptors": true}', 1, "three descriptors"),
        (b'{"id": 1, "argv": [], "cwd": "/", "key": "another"}', 1, "another installation"),
        (b'{"id": 1, "signal": "SIGKILL"}', 1, "`signal`"),
        (b'{"id": 1, "signal": "SIGINT"}', 1, "no such request"),
        (b'{"id": 1, "server": "exec"}', 1, "`server`"),
    ],
)
def test_a_wrong_line_is_answered(client: Client, line: bytes, identifier: object, wrong: str) -> None:
    client.socket.sendall(line + b"\n\n")
    found = client.receive()
    assert (found["id"], wrong in found["error"]) == (identifier, True), found
    assert "server" in client.ask({"id": 2, "server": "status"})


def waiting(client: Client, models: Path, identifier: int = 1) -> tuple[int, int]:
    """A request that waits for its input: its process, and the descriptor of the other end of the input."""
    reader, writer = os.pipe()
    with open(os.devnull, "w") as nothing:
        line = json.dumps(request(models, "monitor", "G (x < 9)", "-", id=identifier, descriptors=True)).encode()
        socket.send_fds(client.socket, [line + b"\n"], [reader, nothing.fileno(), nothing.fileno()])
    os.close(reader)
    return client.receive()["process"], writer


def test_a_killed_request_says_so_and_the_server_goes_on(client: Client, models: Path) -> None:
    process, writer = waiting(client, models)
    os.kill(process, signal.SIGKILL)
    assert client.receive() == {"id": 1, "status": 137, "signal": 9}
    os.close(writer)
    client.send(request(models, "verify", "m.ta"))
    assert client.replies()["status"] == 10


def test_requests_are_carried_out_side_by_side(client: Client, models: Path) -> None:
    _, first = waiting(client, models, 1)
    _, second = waiting(client, models, 2)
    assert "under way" in client.ask(request(models, "--version", id=2))["error"]
    for writer, identifier, row, status in ((second, 2, b"9", 10), (first, 1, b"8", 0)):
        os.write(writer, b"t,x\n0,1\n1," + row + b"\n")
        os.close(writer)
        assert client.receive() == {"id": identifier, "status": status}


def test_a_request_ends_with_its_client(client: Client, models: Path) -> None:
    _, writer = waiting(client, models)
    client.close()
    poll = select.poll()
    poll.register(writer, 0)
    assert poll.poll(60_000) == [(writer, select.POLLERR)]  # nobody has the other end any more
    os.close(writer)


@pytest.mark.parametrize(("number", "status"), [("SIGINT", 130), ("SIGTERM", 143)])
def test_a_signal_is_for_its_request_alone(client: Client, models: Path, number: str, status: int) -> None:
    _, writer = waiting(client, models, 2)
    client.send(request(models, "verify", "long.ta", "--quiet"))
    assert "process" in client.receive()
    client.send({"id": 1, "signal": number})
    found = client.replies()
    assert (found["id"], found["status"]) == (1, status)
    os.write(writer, b"t,x\n0,1\n")
    os.close(writer)
    assert client.receive() == {"id": 2, "status": 0}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_ends_the_program_and_its_request(
    server: Path, runtime: Path, models: Path, number: signal.Signals
) -> None:
    model = models / "pipe.ta"
    os.mkfifo(model)
    served = environment(runtime, str(server))
    with subprocess.Popen(
        [*TACHK, "verify", "pipe.ta"],
        cwd=models,
        env=served,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    ) as process:
        assert process.stdout is not None
        with model.open("w") as pipe:  # once it is read
            pipe.write(LONG)
        process.send_signal(number)
        assert "interrupted" in process.stdout.read()
        assert process.wait(60) == -number
    assert inquire(server)["under_way"] == 0


def test_a_program_that_is_stopped_and_goes_on(server: Path, runtime: Path, models: Path) -> None:
    model = models / "pipe.ta"
    os.mkfifo(model)
    served = environment(runtime, str(server))
    with subprocess.Popen([*TACHK, "verify", "pipe.ta", "--quiet"], cwd=models, env=served) as process:
        with model.open("w") as pipe:
            process.send_signal(signal.SIGTSTP)
            assert os.WIFSTOPPED(os.waitpid(process.pid, os.WUNTRACED)[1])
            process.send_signal(signal.SIGCONT)
            pipe.write(MODEL)
        assert process.wait(60) == 10


def test_without_a_server_its_path_is_wrong(runtime: Path, models: Path, tmp_path: Path) -> None:
    done = call("verify", "m.ta", cwd=models, variables=environment(runtime, str(runtime / "tachk" / "none.sock")))
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"error: {runtime}/tachk/none.sock: ")


def test_the_first_call_starts_a_server_for_the_next_ones(tmp_path: Path, models: Path) -> None:
    folder = tmp_path / "run"
    folder.mkdir(mode=0o700)
    auto = environment(folder, "auto")
    assert call("serve", "--status", cwd=models, variables=auto).returncode == 10
    alone = call("fmt", "m.ta", "--check", cwd=models, variables=auto)
    (path,) = sockets(folder)
    assert path.stat().st_mode & 0o777 == 0o600
    assert path.parent.stat().st_mode & 0o777 == 0o700
    assert inquire(path)["carried_out"] == 0
    served = call("fmt", "m.ta", "--check", cwd=models, variables=auto)
    assert (served.returncode, served.stdout, served.stderr) == (alone.returncode, alone.stdout, alone.stderr)
    assert inquire(path)["carried_out"] == 1
    status = call("serve", "--status", cwd=models, variables=auto)
    assert (status.returncode, "0 under way, 1 carried out" in status.stdout) == (0, True)
    again = call("serve", cwd=models, variables=auto)
    assert (again.returncode, f"a server has {path} already" in again.stderr) == (2, True)
    assert call("serve", "--stop", cwd=models, variables=auto).stdout == "the server has ended\n"
    assert not path.exists()
    assert call("serve", "--stop", cwd=models, variables=auto).stdout == f"no server at {path}\n"


def test_a_server_that_may_do_less_than_a_caller_makes_room(tmp_path: Path, models: Path) -> None:
    folder = tmp_path / "run"
    folder.mkdir(mode=0o700)
    auto = environment(folder, "auto")
    assert run("ulimit -n 256; tachk verify m.ta --quiet", models, auto)[0] == 10
    (path,) = sockets(folder)
    limited = inquire(path)["process"]
    assert run("verify m.ta --quiet", models, auto)[0] == 10
    assert inquire(path)["process"] != limited
    assert run("ulimit -n 256; tachk verify m.ta --quiet", models, auto)[0] == 10
    assert inquire(path, "stop")["carried_out"] == 1


def test_a_folder_that_others_may_open_has_no_server(tmp_path: Path, models: Path) -> None:
    folder = tmp_path / "run"
    (folder / "tachk").mkdir(parents=True)
    (folder / "tachk").chmod(0o755)
    done = call("serve", cwd=models, variables=environment(folder))
    assert (done.returncode, "others may open it: its mode is 755" in done.stderr) == (2, True)
    assert call("verify", "m.ta", cwd=models, variables=environment(folder, "auto")).returncode == 10
    assert [*(folder / "tachk").iterdir()] == []
    (folder / "tachk").rmdir()
    (folder / "tachk").symlink_to(models)
    assert "it is not a folder" in call("serve", cwd=models, variables=environment(folder)).stderr


@pytest.mark.parametrize(
    "words", [["--idle", "soon"], ["--idle", "-1"], ["--status", "--stop"], ["--socket", "x" * 200]]
)
def test_wrong_options(words: Sequence[str], runtime: Path, tmp_path: Path) -> None:
    tmp_path.chmod(0o700)
    done = call("serve", *words, cwd=tmp_path, variables=environment(runtime))
    assert (done.returncode, done.stderr.startswith(("error: ", "Usage: "))) == (2, True), done.stderr
    assert "Traceback" not in done.stderr
