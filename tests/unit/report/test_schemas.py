"""What each command writes for programs follows its schema, from a shell to the last field."""

from __future__ import annotations

import json
import shlex
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from tachk.base.resources import data_root
from tachk.cli.main import app
from tachk.formats.written_reports import validator

CAPTURE = Path(__file__).parents[2] / "data/captures/losses_and_delays.pcap"
SCHEMAS = sorted(path.name.removesuffix(".schema.json") for path in (data_root() / "docs/schema").glob("*.json"))

LAMP = """
const int LATE = 5;
int[0, 3] n;
chan press;
process Lamp() {
    clock x;
    init location off { to low { sync press?; assign x = 0, n = n + 1; } }
    /** Pressed in time. */
    location low { to bright { guard x < LATE; sync press?; } to off { guard x >= LATE; sync press?; } }
    location bright { to bright { sync press?; } }
}
process User() {
    clock y;
    init location idle { to idle { select k : int[1, 2]; guard y >= k; sync press!; assign y = 0; } }
}
system Lamp, User;
property can "bright" : E<> Lamp.bright;
property few : A[] n <= 1 expect fails;
property led : Lamp.low --> Lamp.bright;
property late : sup{Lamp.low}: Lamp.x, n;
property soon : G (Lamp.low -> F[0, 5] Lamp.bright);
property game : control: A<> Lamp.bright;
"""
DRAWN = """
clock age;
process P() {
    clock x;
    init location a { invariant x <= 4; to b { guard x >= 1; } to c { guard x >= 2; } }
    location b;
    location c;
}
system P;
property pr : Pr[<=10](<> P.b);
property test : Pr[<=10](<> P.b) >= 0.2;
property mean : E[<=10; 50](max: age);
property runs : simulate [<=5; 2] {age};
"""
BELL = """
broadcast chan call, on;
process Caller() { clock x; init location idle { to called { guard x >= 10; sync call!; } } location called; }
process Bell() { init location off { to ringing { sync on!; } } location ringing; }
system Caller, Bell;
recording { visible call as call(); visible on as on(); tolerance 1; }
"""
RING = BELL.replace("visible call", "replaces Caller; visible call").replace("sync on!", "sync call?")
FILES = {
    "ring.ta": RING.replace("visible on as on();", ""),
    "bell.ta": BELL,
    "calls.csv": "time,event\\n12,call\\n30,on\\n",
    "early.csv": "time,event\\n2,call\\n30,on\\n",
    "lamp.ta": LAMP,
    "drawn.ta": DRAWN,
    "rare.ta": DRAWN.split("property test")[0],
    "wait.ta": "const int LONG = 5; clock x; process P() { init location a { invariant x <= LONG; } } system P; "
    "property short : A[] x <= LONG;",
    "wrong.ta": "int a b; process P() { init location a { to nowhere; } } system P;",
    "t.csv": "time,p,q,v\n0,0,0,1\n2,1,0,2.5\n5,1,1,3\n9,0,0,inf\n20,0,0,1\n",
    "runs.csv": "run,time,p\n1,0,1\n1,2,1\n2,0,0\n2,3,1\n",
    "f.stl": "a: G (p -> F[0, 2] q)\nb: F q\nc: G (v <= 2)\nd: G (p -> F[0, 100] q)\n",
    "r.stl": "r1: G (a -> F[0, 5] b)\nr2: G (a -> G[0, 5] !b)\nr3: G (b -> b)\n",
}
COMMANDS = (
    ("verify", "verify lamp.ta drawn.ta wrong.ta absent.ta --format json"),
    ("verify", "verify lamp.ta --format json --trace fastest --every-step"),
    ("check", "check lamp.ta drawn.ta wrong.ta absent.ta --format json"),
    ("check", "check lamp.ta --deep --for uppaal-4.1 --format json"),
    ("diff", "diff lamp.ta drawn.ta --format json"),
    ("certify", "certify wait.ta wait.cert --format json"),
    ("certify", "certify wait.ta wait.cert -D LONG=6 --format json"),
    ("estimate", "estimate drawn.ta --format json"),
    ("estimate", "estimate rare.ta --splitting --format json"),
    ("sweep", "sweep lamp.ta --over LATE=4..5 --property few -j 1 --format json"),
    ("synthesize", "synthesize lamp.ta --over LATE=1..3 --property can --format json"),
    ("time", "time lamp.ta --from Lamp.low --to Lamp.bright --over LATE=4,6 --traces --format json"),
    ("simulate", "simulate drawn.ta --until 10 --runs 3 --format json"),
    ("monitor", "monitor f.stl t.csv --all-violations --format json"),
    ("monitor", "monitor f.stl t.csv --online --all-violations --format json"),
    ("monitor_event", "monitor f.stl t.csv --all-violations --format jsonl"),
    ("monitor_event", "monitor f.stl t.csv --online --all-violations --format jsonl"),
    ("monitor_runs", "monitor 'G p' runs.csv --format json"),
    ("mine", "monitor 'G (p -> F[0, K] q)' t.csv --find K=0..20 --format json"),
    ("mine", "monitor 'G (v <= K)' t.csv --find K=0..2 --format json"),
    ("requirements", "requirements r.stl --format json"),
    ("decode", f"xrce decode {shlex.quote(str(CAPTURE))} --port 19701 --format jsonl"),
    ("measure", f"xrce measure {shlex.quote(str(CAPTURE))} --port 19701 --format json"),
    ("test", "test ring.ta --simulate ring.ta --for 30 --format json"),
    ("tests", "tests bell.ta -o suite --format json"),
    ("mutant_tests", "tests ring.ta --cover mutants -o suite --format json"),
    ("conform", "conform bell.ta calls.csv early.csv --coverage --format json"),
    ("network", "convert lamp.ta --format json"),
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("reports")
    for name, text in FILES.items():
        (made / name).write_text(text, encoding="utf-8")
    return made


def printed(command: str) -> str:
    out = StringIO()
    with redirect_stdout(out), pytest.raises(SystemExit) as end:
        app(shlex.split(command), prog_name="tachk")
    assert end.value.code in (0, 1, 10, 20, 2), command
    return out.getvalue()


@pytest.mark.parametrize(("schema", "command"), COMMANDS, ids=[command.split(" /")[0] for _, command in COMMANDS])
def test_a_command_follows_its_schema(schema: str, command: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    if command.startswith("certify"):
        printed("verify wait.ta --certificate wait.cert --quiet")
    text = printed(command)
    documents: list[Any] = [*map(json.loads, text.splitlines())] if command.endswith("jsonl") else [json.loads(text)]
    assert documents
    for document in documents:
        validator(schema).validate(document)


def test_every_schema_is_one_of_a_command() -> None:
    assert sorted({schema for schema, _ in COMMANDS}) == SCHEMAS
    for schema in SCHEMAS:
        jsonschema.Draft202012Validator.check_schema(validator(schema).schema)
