"""The tools of `tachk mcp`, called by a client of the official SDK over the standard streams of one server."""

from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from time import monotonic
from typing import Any

import jsonschema
import pytest

import tachk
from tachk.api.tools.catalogue import TOOLS, call
from tachk.api.tools.instructions import EXAMPLE
from tachk.api.tools.limits import DEFAULT_CEILINGS, ToolLimits
from tachk.base.job import limited
from tachk.base.optional_packages import MissingPackageError

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).parents[3]
FISCHER, GATE = (str(ROOT / f"models/classics/{name}.ta") for name in ("fischer", "train_gate"))
NEEDS_MCP = pytest.mark.skipif(find_spec("mcp") is None, reason='needs pip install "tachk[mcp]"')
BELL = """
broadcast chan call, on;
process Caller() { clock x; init location idle { to called { guard x >= 10; sync call!; } } location called; }
process Bell() { init location off { to ringing { sync on!; } } location ringing; }
system Caller, Bell;
recording { visible call as call(); visible on as on(); tolerance 1; }
"""
WRONG = "process P() {\n    init location a { to b; }\n}\nsystem P;\n"
TRACE = "time,p,q\n0,0,0\n1,1,0\n5,0,0\n9,0,1\n"
TWO = {"N": 2}

Found = dict[str, Any]


def answers(found: Found) -> dict[str, str]:
    return {each["name"]: each["answer"] for each in found["result"]["results"]}


def evidence(found: Found) -> list[tuple[str, str, bool]]:
    return [(each["about"], each["kind"], each["checked"]) for each in found["evidence"]]


STATISTICAL = "process P() { init location A; } system P; property a: E<> P.A; property b: Pr[<=10](<> P.A);"

# What is called with which arguments, and what is true of the answer; a text is part of that of a call that failed.
CALLS: list[tuple[str, Found, Callable[[Found], bool] | str]] = [
    ("check", {"model": FISCHER}, lambda a: a["result"]["size"]["processes"] == 4 and a["result"]["deep"] is None),
    ("check", {"model": EXAMPLE}, lambda a: a["result"]["model"] == "<model>" and a["result"]["findings"] == []),
    ("check", {"model": STATISTICAL}, lambda a: a["result"]["size"]["properties"] == 2),
    ("check", {"model": WRONG}, lambda a: a["result"]["findings"][0]["place"]["line"] == 2),
    ("check", {"model": FISCHER, "constants": TWO, "deep": True}, lambda a: a["result"]["deep"]["complete"]),
    ("check", {"model": "none.ta"}, "there is no file none.ta"),
    (
        "check",
        {"model": WRONG, "depth": 3},
        "Additional properties are not allowed ('depth' was unexpected); allowed: model, ",
    ),
    ("check", {}, "'model' is a required property"),
    (
        "verify",
        {"model": FISCHER, "constants": {"N": 2, "WAIT": 9}, "properties": ["mutual_exclusion", "deadlock_free"]},
        lambda a: (
            answers(a) == {"mutual_exclusion": "fails", "deadlock_free": "holds"}
            and evidence(a) == [("mutual_exclusion", "run", True), ("deadlock_free", "certificate", True)]
            and a["result"]["results"][0]["trace"] is None
            and "left out" in a["notes"][0]
        ),
    ),
    (
        "verify",
        {"model": FISCHER, "constants": {"N": 2, "WAIT": 9}, "properties": ["mutual_exclusion"], "runs": "all"},
        lambda a: len(a["result"]["results"][0]["trace"]) == 7,
    ),
    ("verify", {"model": EXAMPLE}, lambda a: set(answers(a).values()) == {"holds"} and len(a["evidence"]) == 3),
    ("verify", {"model": EXAMPLE, "certificates": "never"}, lambda a: ("goes_out", "none", False) in evidence(a)),
    (
        "verify",
        {"model": EXAMPLE, "queries": ["Whenever Lamp.on, within 20, Lamp.off must be true."]},
        lambda a: answers(a) == {"q1": "fails"} and evidence(a) == [("q1", "run", True)],
    ),
    (
        "verify",
        {"model": EXAMPLE, "queries": ["sup: Lamp.x", "Pr[<=50](<> Lamp.on)"]},
        lambda a: [kind for _, kind, checked in evidence(a) if not checked] == ["none", "samples"],
    ),
    ("verify", {"model": FISCHER, "states": 3}, lambda a: "unknown" in answers(a).values()),
    ("verify", {"model": WRONG}, "<model>:2:26: error[E0209]"),
    ("verify", {"model": FISCHER, "queries": ["A[] nothing"]}, "A[] nothing\n      |     ^^^^^^^"),
    ("verify", {"model": FISCHER, "properties": ["none"]}, "has no property 'none'"),
    ("verify", {"model": FISCHER, "constants": {"M": 2}}, "no constant"),
    ("verify", {"model": FISCHER, "seconds": 100_000}, "seconds: 100000 is greater than the maximum"),
    ("explain", {"what": "E0204"}, lambda a: a["result"]["kind"] == "message" and a["result"]["right"] != ""),
    (
        "explain",
        {"what": "Whenever p, within 5 s, q must be true."},
        lambda a: a["result"]["formulas"][0]["formula"] == "G (p -> F[0, 5 s] q)",
    ),
    ("explain", {"what": "E9999"}, "no message has the code E9999"),
    (
        "simulate",
        {"model": GATE, "constants": TWO, "runs": 5, "until": 50, "formula": "G (Controller.length <= 1)"},
        lambda a: a["result"]["totals"]["formulas"][0]["false"] == 5 and evidence(a) == [("run 0", "run", True)],
    ),
    ("simulate", {"model": GATE, "until": "soon"}, "error"),
    ("step", {"model": FISCHER, "constants": TWO}, lambda a: len(a["result"]["possible"]) == 2),
    (
        "step",
        {"model": FISCHER, "constants": TWO, "run": "0 P(1): idle -> request\n+3 P(1): request -> waiting\n"},
        lambda a: a["result"]["locations"]["P(1)"] == "waiting" and a["result"]["time"] == "3",
    ),
    (
        "step",
        {"model": FISCHER, "constants": TWO, "run": "0 P(1): idle -> request\n+30 P(1): request -> waiting\n"},
        lambda a: not a["result"]["accepted"] and a["result"]["steps_taken"] == 1 and "^" in a["result"]["rejection"],
    ),
    ("step", {"model": FISCHER, "constants": TWO, "random_steps": 4}, lambda a: a["result"]["steps_taken"] == 4),
    ("step", {"model": FISCHER, "run": "P(1) goes"}, "<run>:1:1: error[E0922]"),
    (
        "monitor",
        {"formula": "G (p -> F[0, 2] q)", "trace": TRACE},
        lambda a: a["result"]["trace"] == "trace.csv" and a["result"]["results"][0]["finding"]["deadline"] == "3",
    ),
    ("monitor", {"formula": "G (r -> F[0, 2] q)", "trace": TRACE}, "<formula>:1:4: error[E0901]"),
    ("monitor", {"formula": "F q", "trace": "time,q\n0,0\nlater,1\n"}, "trace.csv:3:1"),
    (
        "conform",
        {"model": BELL, "recording": "time,event\n12,call\n30,on\n"},
        lambda a: a["result"]["answers"][0]["accepted"] is True and [each[2] for each in evidence(a)] == [True, True],
    ),
    (
        "conform",
        {"model": BELL, "recording": "time,event\n2,call\n30,on\n"},
        lambda a: a["result"]["answers"][0]["refusal"]["event"]["place"] == "line 2",
    ),
    (
        "conform",
        {"model": BELL, "recording": "time,event\n8,call\n30,on\n", "late": {"input": "0", "output": "2"}},
        lambda a: [a["result"]["answers"][0][key] for key in ("late", "input_late", "output_late")] == [2, 0, 2],
    ),
    ("conform", {"model": BELL, "recording": "time,event\n8,call\n", "late": {"in": "2"}}, "late"),
    ("conform", {"model": FISCHER, "recording": "time,event\n12,call\n"}, "recording"),
    ("prove", {}, "there is no tool 'prove'"),
]
LONG = {"model": FISCHER, "runs": 100_000, "until": 100_000, "seconds": 200}


def command() -> list[str]:
    return [sys.executable, "-m", "tachk", "mcp"]


@cache
def conversation() -> tuple[Any, list[Any]]:
    """The tools that the server lists and its answers to the calls, one of which is cancelled in between."""
    import anyio
    from mcp.client.client import Client
    from mcp.client.stdio import StdioServerParameters

    async def talk() -> tuple[Any, list[Any]]:
        variables = {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        server = StdioServerParameters(command=command()[0], args=command()[1:], env=variables, cwd=ROOT)
        async with Client(server) as client:
            listed = await client.list_tools()
            found = [await client.call_tool(name, given) for name, given, _ in CALLS[:1]]
            with anyio.move_on_after(0.3) as scope:
                await client.call_tool("simulate", LONG)
            assert scope.cancelled_caught
            return listed.tools, [*found, *[await client.call_tool(name, given) for name, given, _ in CALLS[1:]]]

    return anyio.run(talk)


@NEEDS_MCP
def test_a_client_calls_every_tool() -> None:
    listed, found = conversation()
    assert [tool.name for tool in listed] == [tool.name for tool in TOOLS]
    assert len(CALLS) >= 30 and {name for name, _, _ in CALLS} > {tool.name for tool in listed}
    schemas = {tool.name: tool.output_schema for tool in listed}
    for (name, given, expected), answer in zip(CALLS, found, strict=True):
        (content,) = answer.content
        about = f"{name} {given}: {content.text}"
        if isinstance(expected, str):
            assert answer.is_error and expected in content.text, about
            assert "Traceback" not in content.text, about
            continue
        assert not answer.is_error, about
        jsonschema.Draft202012Validator(schemas[name]).validate(answer.structured_content)
        assert expected(answer.structured_content), about
        assert content.text.startswith(answer.structured_content["summary"]), about
        assert "/tmp" not in content.text.replace(str(ROOT), "")


@NEEDS_MCP
def test_schemas_are_right_and_name_the_bounds_of_the_server() -> None:
    small = ToolLimits(seconds=5, megabytes=100, states=1000)
    for tool in TOOLS:
        jsonschema.Draft202012Validator.check_schema(tool.answers())
        schema = tool.input_schema(small)
        jsonschema.Draft202012Validator.check_schema(schema)
        bounds = {
            name: (each["default"], each["maximum"]) for name, each in schema["properties"].items() if "maximum" in each
        }
        assert bounds["seconds"] == (5, 5) and bounds["megabytes"] == (100, 100) and bounds["states"] == (1000, 1000)
    found = call("verify", {"model": FISCHER, "constants": {"N": 6}}, small)
    assert found.structured is not None and found.structured["limits"]["states"] == 1000
    assert call("verify", {"model": FISCHER, "states": 1001}, small).failed


def test_tools_answer_without_a_server() -> None:
    found = call("verify", {"model": FISCHER, "constants": TWO}, DEFAULT_CEILINGS)
    assert not found.failed and json.dumps(found.structured)
    assert call("verify", {"model": FISCHER, "seconds": 1e-9}, DEFAULT_CEILINGS).text.startswith(
        "error: the time limit"
    )


def test_an_answer_stays_where_no_time_is_left_for_its_evidence(monkeypatch: pytest.MonkeyPatch) -> None:
    late = 0.0
    found_in_time = tachk.Model.verify

    def verify(*arguments: Any, **named: Any) -> tachk.Report:
        nonlocal late
        report = found_in_time(*arguments, **named)
        late = 1e6
        return report

    monkeypatch.setattr(tachk.Model, "verify", verify)
    monkeypatch.setattr("tachk.base.job.monotonic", lambda: monotonic() + late)
    found = call("verify", {"model": FISCHER, "constants": {"N": 2, "WAIT": 9}}, DEFAULT_CEILINGS).structured
    assert found is not None
    assert set(answers(dict(found)).values()) == {"holds", "fails"}
    assert {(kind, checked) for _, kind, checked in evidence(dict(found))} == {("run", False), ("none", False)}
    assert all("time limit" in each["how"] for each in found["evidence"] if not each["checked"])


def test_the_example_of_the_instructions_has_no_finding() -> None:
    model = tachk.loads(EXAMPLE)
    assert model.warnings == () and model.verify().met is True


@NEEDS_MCP
def test_the_server_ends_with_its_input() -> None:
    ended = subprocess.run(command(), input=b"this is no message\n", capture_output=True, cwd=ROOT, timeout=60)
    assert ended.returncode == 0
    assert b"Traceback" not in ended.stderr


@NEEDS_MCP
@pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="needs to wait for a process of another process")
def test_the_server_ends_by_ctrl_c_and_so_does_its_call() -> None:
    def message(number: int, method: str, **params: object) -> bytes:
        return json.dumps({"jsonrpc": "2.0", "id": number, "method": method, "params": params}).encode() + b"\n"

    hello = {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": {"name": "test", "version": "1"}}
    pipe = subprocess.PIPE
    with subprocess.Popen(command(), stdin=pipe, stdout=pipe, stderr=pipe, cwd=ROOT) as server:
        assert server.stdin is not None and server.stdout is not None and server.stderr is not None
        server.stdin.write(message(1, "initialize", **hello))
        server.stdin.write(b'{"jsonrpc": "2.0", "method": "notifications/initialized"}\n')
        server.stdin.write(message(2, "tools/call", name="check", arguments={"model": FISCHER}))
        server.stdin.flush()
        assert [json.loads(server.stdout.readline())["id"] for _ in range(2)] == [1, 2]
        worker = int(Path(f"/proc/{server.pid}/task/{server.pid}/children").read_text(encoding="ascii"))
        ended = os.pidfd_open(worker)
        server.stdin.write(message(3, "tools/call", name="simulate", arguments=LONG))
        server.stdin.flush()
        server.send_signal(signal.SIGINT)
        assert server.stderr.read() == b""
        assert server.wait() == -signal.SIGINT
        assert select.select([ended], [], [], 30)[0] == [ended]
        os.close(ended)


def test_without_the_package_the_command_names_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from tachk.cli.commands.mcp import run_mcp

    monkeypatch.delitem(sys.modules, "tachk.api.tools.server", raising=False)
    monkeypatch.setitem(sys.modules, "mcp_types", None)
    with pytest.raises(MissingPackageError) as error:
        run_mcp(None, None, None)
    assert error.value.help == 'pip install "tachk[mcp]"'


def test_searches_leave_time_to_judge_what_they_find() -> None:
    limits = ToolLimits(seconds=100, megabytes=1000, states=10)
    assert limits.before_evidence().seconds == 95
    with limited(5):
        assert 3.9 < (limits.before_evidence().seconds or 0) <= 4
