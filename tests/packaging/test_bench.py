"""`python -m bench` measures, remembers and compares."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

if not (ROOT / "bench").is_dir():
    pytest.skip("needs a checkout", allow_module_level=True)

sys.path.append(str(ROOT))

from bench.families import OWN, TARZAN, TCHECKER, UPPAAL  # noqa: E402
from bench.tarzan_files import written  # noqa: E402


def test_a_run_is_measured_remembered_and_compared_with_the_one_before(tmp_path: Path) -> None:
    history = tmp_path / "history.json"
    command = [sys.executable, "-m", "bench", "run", "--only", "train_gate=2", "--repeat", "1", "--history", history]
    first = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    (line,) = [line for line in first.stdout.splitlines() if line.startswith("| train_gate")]
    assert line.startswith("| train_gate | 2 | tachk | not reached | 11 | 11 |")
    (entry,) = json.loads(history.read_text(encoding="utf-8"))
    entry["rows"][0] |= {"stored": 70, "cpu_seconds": 1000.0}
    history.write_text(json.dumps([entry]), encoding="utf-8")
    second = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    (compared,) = [line for line in second.stdout.splitlines() if "| 1000.00 |" in line]
    assert compared.startswith("| train_gate | 2 | tachk | 1000.00 |") and compared.endswith("| 70 | 11 |")
    assert len(json.loads(history.read_text(encoding="utf-8"))) == 2


def test_every_program_can_be_imported() -> None:
    names = sorted(path.stem for path in (ROOT / "bench").glob("*.py") if path.stem != "__main__")
    program = f"""
import sys
sys.path[:0] = [".", "bench"]
for name in {names}:
    try:
        __import__(name)
    except ModuleNotFoundError as missing:
        if missing.name != "rtamt":
            raise
"""
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_there_are_the_82_networks_of_20_families_of_tarzan_and_20_families_of_tchecker() -> None:
    assert len(TARZAN) == 20 and sum(len(family.sizes) for family in TARZAN.values()) == 82
    assert len(TCHECKER) == 20 and len(UPPAAL) == 5


@pytest.mark.drawn(2)
@pytest.mark.parametrize("name", [*TARZAN])
def test_each_network_of_tarzan_is_written_for_the_others(name: str, tmp_path: Path) -> None:
    instance = TARZAN[name].instance(TARZAN[name].sizes[0], tmp_path, exported=True)
    assert instance.network is not None and instance.regions is not None
    assert len(instance.goals) == len(instance.labels.split(",") if instance.labels else ())


def test_a_network_is_written_as_tarzan_reads_it(tmp_path: Path) -> None:
    instance = TARZAN["tz_gates"].instance(2, tmp_path, exported=True)
    assert instance.regions is not None and instance.goals == ("2=open",)
    assert (instance.regions / "0001_Key2.txt").read_text(encoding="utf-8") == (
        "create automaton Key2\n{\n    clocks { x; }\n    actions { tau; }\n    integers { turned; }\n"
        "    locations {\n        L0 <ini: T>,\n        L1 <ini: F>,\n        L2 <ini: F>;\n    }\n"
        "    transitions {\n        (L0, tau, [(x, ==, 2)], [x], L1),\n"
        "        (L1, tau, [(x, ==, 2)], [], [turned = (turned + 1)], L2);\n    }\n}\n"
    )
    lock = (instance.regions / "0002_Lock.txt").read_text(encoding="utf-8")
    assert "(G2, tau, [(x, ==, 2)], turned == 2, [x], open)" in lock


def test_a_remainder_is_written_without_the_sign_that_tarzan_cannot_read(tmp_path: Path) -> None:
    instance = OWN["fddi"].instance(3, tmp_path, exported=True)
    assert instance.regions is not None
    token = (instance.regions / "0003_Token.txt").read_text(encoding="utf-8")
    assert "[Token_at = ((Token_at + 1) - (3 * ((Token_at + 1) / 3)))]" in token and "%" not in token


@pytest.mark.parametrize(
    "line",
    [
        "location:P:a{initial: : committed:}",
        "int:1:0:5:3:n",
        "edge:P:a:a:tau{do: x = 1}",
        "edge:P:a:a:tau{do: m = 7 % m}",
        "edge:P:a:a:tau{provided: x - y < 1}",
        "sync:P@c_send:Q@c_receive?",
    ],
)
def test_what_tarzan_has_no_words_for_is_left_out(line: str, tmp_path: Path) -> None:
    network = tmp_path / "network.tck"
    text = "system:s\nclock:1:x\nclock:1:y\nint:1:0:5:0:m\nprocess:P\nlocation:P:a{initial:}\nedge:P:a:a:tau{}\n"
    network.write_text(text, encoding="utf-8")
    assert written(network, None, tmp_path / "said") == ()
    network.write_text(text + line + "\n", encoding="utf-8")
    assert written(network, None, tmp_path / "not_said") is None
