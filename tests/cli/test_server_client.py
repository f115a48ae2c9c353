"""`tachkc`, the client of `tachk serve` that is no Python."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import sysconfig
import venv
from collections.abc import Iterator
from pathlib import Path

import pytest

import tachk
from tachk.cli.server import client, identity

CHECKOUT = Path(__file__).parents[2]
SOURCE = CHECKOUT / "src/client/tachkc.cpp"
COMPILER = shutil.which(os.environ.get("CXX") or "c++")

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux" or COMPILER is None, reason="needs Linux and a compiler"),
    pytest.mark.drawn,
]

MODEL = """process P() { clock x; init location a { to b { guard x >= 1; } } location b; }
system P;
property p : A[] not P.b;
"""


def test_it_has_the_lists_of_the_other_client() -> None:
    text = SOURCE.read_text(encoding="utf-8")
    for name, expected in (
        ("inherited", identity._INHERITED),
        ("not_for_server", client._ITSELF),
        ("of_a_process", client._OF_A_PROCESS),
    ):
        found = re.search(rf"{name}\[\] = \{{(.*?)\}};", text, re.DOTALL)
        assert found is not None
        assert set(re.findall(r'"(.*?)"', found[1])) == set(expected)


@pytest.fixture(scope="module")
def scripts(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of scripts of an environment whose packages are those of the tests."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, with_pip=False, symlinks=True)
    packages = folder / f"lib/python3.{sys.version_info[1]}/site-packages"
    (packages / "tachk").symlink_to(Path(tachk.__file__).parent)
    (packages / "others.pth").write_text(sysconfig.get_path("purelib"))
    script = folder / "bin/tachk"
    script.write_text(f"#!{folder}/bin/python\nfrom tachk.cli.start import run\nrun()\n")
    script.chmod(0o755)
    assert COMPILER is not None
    version = f'-DTACHK_VERSION="{tachk.__version__}"'
    subprocess.run([COMPILER, "-std=c++20", version, "-o", folder / "bin/tachkc", SOURCE], check=True, timeout=120)
    return folder / "bin"


@pytest.fixture
def variables(scripts: Path, tmp_path: Path) -> Iterator[dict[str, str]]:
    """The variables of a program that has a server; it is ended behind the test."""
    (tmp_path / "run").mkdir(mode=0o700)
    (tmp_path / "m.ta").write_text(MODEL, encoding="utf-8")
    left_out = ("PYTHONPATH", "TACHK_SERVER")
    found = {name: value for name, value in os.environ.items() if name not in left_out}
    found |= {"XDG_RUNTIME_DIR": str(tmp_path / "run")}
    yield found
    subprocess.run([scripts / "tachk", "serve", "--stop"], env=found, check=True, timeout=60, capture_output=True)


def run(*words: str | Path, cwd: Path, variables: dict[str, str]) -> tuple[int, bytes, bytes]:
    done = subprocess.run(words, cwd=cwd, env=variables, capture_output=True, check=False, timeout=60)
    return done.returncode, re.sub(rb"[\d.]+ +([kM]B|m?s)\b", rb"? \1", done.stdout), done.stderr


def served(scripts: Path, variables: dict[str, str]) -> int:
    """The number of requests that the server has carried out."""
    _, said, _ = run(scripts / "tachk", "serve", "--status", cwd=scripts, variables=variables)
    found = re.search(rb"(\d+) carried out", said)
    return 0 if found is None else int(found[1])


def test_it_uses_the_server_and_starts_it(scripts: Path, variables: dict[str, str], tmp_path: Path) -> None:
    lines: list[list[str]] = [
        ["verify", "m.ta"],
        ["verify", os.fsdecode(b"\xff\xed\xa0\x80.ta"), 'E<> "\\\n\u20ac\U0001f600'],
        ["nonsense"],
        ["verify", "m.ta", "--format", "json", "--quiet"],
    ]
    run(scripts / "tachkc", *lines[0], cwd=tmp_path, variables=variables)
    for count, words in enumerate(lines):
        assert served(scripts, variables) == count
        alone = run(scripts / "tachk", *words, cwd=tmp_path, variables=variables)
        assert run(scripts / "tachkc", *words, cwd=tmp_path, variables=variables) == alone


def test_without_a_language_it_is_python_with_utf_8(scripts: Path, variables: dict[str, str], tmp_path: Path) -> None:
    bare = {name: value for name, value in variables.items() if not name.startswith(("LC_", "LANG"))}
    for count in range(2):
        assert run(scripts / "tachkc", "verify", "m.ta", cwd=tmp_path, variables=bare)[0] == 10
        assert served(scripts, bare) == count
    run(scripts / "tachk", "serve", "--stop", cwd=tmp_path, variables=bare)


def test_it_becomes_the_program_where_no_server_fits(scripts: Path, variables: dict[str, str], tmp_path: Path) -> None:
    off = variables | {"TACHK_SERVER": "off"}
    assert run(scripts / "tachkc", "verify", "m.ta", cwd=tmp_path, variables=off)[0] == 10
    assert [*(tmp_path / "run").iterdir()] == []
    other = variables | {"TACHK_SERVER": str(tmp_path / "none.sock")}
    status, _, said = run(scripts / "tachkc", "verify", "m.ta", cwd=tmp_path, variables=other)
    assert (status, b"none.sock" in said) == (2, True)


def test_ctrl_c_and_ctrl_z_reach_the_request(scripts: Path, variables: dict[str, str], tmp_path: Path) -> None:
    run(scripts / "tachkc", "verify", "m.ta", cwd=tmp_path, variables=variables)
    os.mkfifo(tmp_path / "pipe.ta")
    with (
        subprocess.Popen(
            [scripts / "tachkc", "verify", "pipe.ta"], cwd=tmp_path, env=variables, stderr=subprocess.PIPE
        ) as process,
        (tmp_path / "pipe.ta").open("w"),
    ):
        process.send_signal(signal.SIGTSTP)
        assert os.WIFSTOPPED(os.waitpid(process.pid, os.WUNTRACED)[1])
        process.send_signal(signal.SIGCONT)
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == -signal.SIGINT
    assert served(scripts, variables) == 1
