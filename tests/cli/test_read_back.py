"""What tachk writes, it reads: each row of the table in docs/monitoring.md is written, read back, and says the same."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner

from tachk.cli.main import app

ROOT = Path(__file__).parents[2]
CAPTURE = str(ROOT / "tests/data/captures/created_again.pcap")
MODEL = """time_unit = 1 ms;
const int LOSSES = 3;
int n = 0; bool b; double level = 0.1;
broadcast chan go;
process P() {
    clock x;
    init location A { invariant x <= 3; to B { guard x >= 1; sync go!; assign x = 0, b = !b, level = level * 1.7; } }
    location B { invariant x <= 2; to A { guard x >= 1; assign x = 0, n = n < 4 ? n + 1 : 0; } }
}
process Only() { init location Here; }
system P, Only;
property low : A[] n <= LOSSES + 1;
property reached : E<> P.B && n == 2;
"""
FORMULAS = (
    "G (P.B -> F[0, 2 ms] P.A)",
    "G (n < 3)",
    "F[0, 15 ms] (level > 3)",
    "G Only.Here",
    "G (b -> O[0, 4 ms] rise(b))",
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "m.ta").write_text(MODEL)
    return tmp_path


def tachk(command: str, *more: str, status: int = 0) -> str:
    result = CliRunner().invoke(app, [*command.split(), *more], catch_exceptions=False)
    assert result.exit_code == status, (command, result.output)
    return result.stdout


def verdicts(file: str, formulas: tuple[str, ...] = FORMULAS) -> list[tuple[str, object]]:
    """What formulas are worth on a file."""
    found = []
    for formula in formulas:
        command = ["monitor", formula, file, "--format", "json"]
        answer = json.loads(CliRunner().invoke(app, command).stdout)["results"][0]
        found.append((answer["verdict"], answer.get("robustness")))
    return found


def signals_of_runs() -> None:
    tachk("simulate m.ta --until 20 --seed 3 -o a.run")
    words = []
    for formula in FORMULAS:
        told = CliRunner().invoke(app, ["replay", "m.ta", "a.run", "--quiet", "--monitor", formula]).output
        words.append(re.findall(r"p1: (\w+)", told)[0])
    forms = []
    for ending in ("csv", "jsonl", "parquet", "vcd"):
        if ending == "parquet":
            pytest.importorskip("pyarrow")
        tachk(f"simulate m.ta --until 20 --seed 3 -o a.{ending}")
        tachk(f"replay m.ta a.run -o b.{ending}")
        forms += [verdicts(f"a.{ending}"), verdicts(f"b.{ending}")]
    assert all(form == forms[0] for form in forms)
    assert [word for word, _ in forms[0]] == words
    assert {"true", "false"} <= set(words)


def steps_of_runs() -> None:
    tachk("simulate m.ta --until 20 --seed 3 -o a.run")
    tachk("replay m.ta a.run -o b.run")
    tachk("simulate m.ta a.run --policy script --until 20 -o c.csv")
    tachk("simulate m.ta --until 20 --seed 3 -o a.csv")
    steps = [Path(name).read_text().partition("\n")[2] for name in ("a.run", "b.run")]
    assert steps[0] == steps[1]
    assert Path("c.csv").read_text() == Path("a.csv").read_text()
    refusal = CliRunner().invoke(app, ["monitor", "G (n < 3)", "a.run"])
    assert refusal.exit_code == 2
    assert "tachk replay MODEL a.run --monitor FORMULA" in refusal.output


def signals_of_formulas() -> None:
    tachk("simulate m.ta --until 20 --seed 3 -o a.csv")
    tachk("monitor", "G (n < 3)", "a.csv", "--signals", "s.csv", "--quiet", status=10)
    (worth,) = verdicts("a.csv", ("F (n >= 3)",))
    assert verdicts("s.csv", ("F !p1", "F (p1.low < 1)")) == [("true", ["inf", "inf"]), (worth[0], [2.0, 2.0])]


def signals_of_captures() -> None:
    formulas = ("G !lost", "F (client_AAAABBBB_at_19401.to_agent.sent > 1)")
    for ending in ("csv", "parquet"):
        if ending == "parquet":
            pytest.importorskip("pyarrow")
        tachk(f"decode --signals d.{ending} {CAPTURE}")
        assert verdicts(f"d.{ending}", formulas) == verdicts(CAPTURE, formulas)


def captures() -> None:
    from tachk.xrce.messages import Endpoint
    from tachk.xrce.proxy.recording import CaptureWriter

    client, agent = Endpoint("127.0.0.1", 4000), Endpoint("127.0.0.1", 8888)
    with Path("c.pcap").open("wb") as file:
        writer = CaptureWriter(file)
        for number in range(2):
            writer.packet(10**18 + number * 10**9, client, agent, bytes.fromhex("80010000"))
    assert len(tachk("decode c.pcap --format jsonl").splitlines()) == 2
    tachk("monitor", "G[1 s, 1 s] (time == 1)", "c.pcap")


def reports() -> None:
    tachk("verify m.ta --trace some --format json -o r.json")
    tachk("replay m.ta r.json --property reached --quiet")
    tachk("chart r.json -o c.svg")
    tachk("report m.ta r.json -o page.html")
    assert "P.B" in Path("page.html").read_text(encoding="utf-8")


def other_reports() -> None:
    tachk("simulate m.ta --until 20 --seed 3 -o a.csv")
    tachk("monitor", "G (n < 3)", "a.csv", "--format", "json", "-o", "m.json", status=10)
    tachk("simulate m.ta --until 5 --format json -o s.json")
    tachk("sweep m.ta -D LOSSES=1..3 --property low --format json -o w.json")
    tachk("report m.json s.json w.json -o page.html")


def settings() -> None:
    options = tachk(f"measure {CAPTURE} --for m.ta --format settings").split()
    assert "LOSSES=0" in options
    tachk("verify m.ta --property low", *options, status=10)


def certificates() -> None:
    tachk("verify m.ta --property low --certificate proof")
    assert "low" in tachk("certify m.ta proof")


def stores() -> None:
    tachk("sweep m.ta -D LOSSES=1..2 --property low --store s.sqlite")
    again = json.loads(tachk("sweep m.ta -D LOSSES=1..2 --property low --store s.sqlite --format json"))
    tachk("sweep m.ta -D LOSSES=1..2 --property low --store t.sqlite --merge s.sqlite")
    assert again


def models() -> None:
    for ending in ("ta", "xta", "xml", "tck"):
        tachk(f"convert m.ta o.{ending}")
        assert "2 processes, 3 locations" in tachk(f"check o.{ending}")
    Path("q.q").write_text("E<> P.B\n")
    tachk("convert q.q p.q")
    assert "holds" in tachk("verify m.ta -q p.q")


def pictures() -> None:
    tachk("draw m.ta -o d.svg")
    tachk("report m.ta d.svg -o page.html")
    assert "<svg" in Path("page.html").read_text(encoding="utf-8")


ELSEWHERE = {"`conform --coverage --format json`"}
"""Rows that other tests read back: tests/unit/recordings/conformance/test_exercised_edges.py."""

ROWS: dict[str, Callable[[], None]] = {
    "`simulate -o`, `replay -o`": signals_of_runs,
    "`simulate -o`, `replay -o`, `step -o`, `save` in `step`": steps_of_runs,
    "`monitor --signals`": signals_of_formulas,
    "`xrce decode --signals`": signals_of_captures,
    "`xrce proxy --record`, `xrce bridge --record`": captures,
    "`verify --format json`": reports,
    "`monitor`, `simulate`, `sweep --format json`": other_reports,
    "`xrce measure --format settings`": settings,
    "`verify --certificate`, `synthesize --certificates`": certificates,
    "`sweep --store`": stores,
    "`convert`, `fmt`": models,
    "`draw`, `plot`, `chart`": pictures,
}


@pytest.mark.parametrize("row", ROWS)
def test_what_a_command_writes_is_read_back(row: str, folder: Path) -> None:
    ROWS[row]()


def test_the_table_has_these_rows() -> None:
    page = (ROOT / "docs/monitoring.md").read_text(encoding="utf-8")
    table = page.partition("| written by |")[2].partition("\n\n")[0].splitlines()[2:]
    assert [line.split("|")[1].strip() for line in table if line.split("|")[1].strip() not in ELSEWHERE] == list(ROWS)
