"""What events of the model tell is what variables hold, and where processes are, at the end of the step."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.report.conformance.json import conformance_to_json
from tachk.report.conformance.text import conformance_to_text
from tests.support.seeds import seeds

LAMP = (Path(__file__).parents[4] / "examples/dimmer/dimmer.ta").read_text(encoding="utf-8")
OLD = "as light(on, level);"
HEADER = "time [ms],event,on,level"


def lamp(column: str) -> tachk.Model:
    assert OLD in LAMP
    return tachk.loads(LAMP.replace(OLD, f"as light(on, level, {column});"))


def answer(tmp_path: Path, model: tachk.Model, column: str, on: str, off: str) -> tachk.Conformance:
    file = tmp_path / "events.csv"
    file.write_text(f"{HEADER},{column}\n2,press,,,\n6.2,light,1,7,{on}\n60,light,0,0,{off}\n", encoding="utf-8")
    return tachk.conform(model, file)


@pytest.mark.parametrize(
    ("column", "name", "on", "off"),
    [
        ("lit = Lamp.On", "lit", "true", "false"),
        ("lit = !Lamp.Off + 2 * Lamp.On", "lit", "3", "0"),
        ("Lamp", "Lamp", "On", "Off"),
        ("where = Lamp", "where", "On", "Off"),
    ],
)
def test_location_in_a_column(tmp_path: Path, column: str, name: str, on: str, off: str) -> None:
    model = lamp(column)
    assert answer(tmp_path, model, name, on, off).accepted
    assert answer(tmp_path, model, name, "", off).accepted
    assert answer(tmp_path, model, name, off, off).accepted is False
    assert answer(tmp_path, model, name, on, on).accepted is False


def test_locations_are_named_in_answers(tmp_path: Path) -> None:
    model = lamp("Lamp")
    found = answer(tmp_path, model, "Lamp", "On", "On")
    text = conformance_to_text(found, "lamp.ta")
    assert "the model allows light(on=0, level=0, Lamp=Off), from 55 to 108" in text
    written = json.loads(json.dumps(conformance_to_json([found], "lamp.ta")))
    assert written["answers"][0]["refusal"]["allowed"][0]["cells"] == {"on": 0, "level": 0, "Lamp": "Off"}
    wrong = answer(tmp_path, model, "Lamp", "Waking", "Off")
    assert wrong.edit is not None and wrong.edit.cells[-1] == ("Lamp", "On")
    with pytest.raises(UsageError, match=r"line 4: Lamp is `Of`, which is not a location of the process"):
        answer(tmp_path, model, "Lamp", "On", "Of")
    file = tmp_path / "events.jsonl"
    file.write_text('{"time": 2, "event": "press"}\n{"time": 6, "event": "light", "on": 1, "level": 7, "Lamp": true}\n')
    with pytest.raises(UsageError, match=r"line 2: Lamp is `1`, which is not a location"):
        tachk.conform(model, file)


def test_process_that_is_chosen_by_an_index(tmp_path: Path) -> None:
    model = tachk.loads("""
        broadcast chan done[2];
        process P(int[0, 1] i) { init location A { to B { sync done[i]!; } } location B { to A; } }
        system P;
        recording { visible done[i] as done(i, there = P(i).B, other = P(1 - i).B); }
    """)
    file = tmp_path / "events.csv"
    for other, expected in (("true", True), ("false", True), ("", True)):
        file.write_text(f"time,event,i,there,other\n1,done,0,true,false\n2,done,1,true,{other}\n", encoding="utf-8")
        assert tachk.conform(model, file).accepted is expected  # P(0) may have gone back, or not
    file.write_text("time,event,i,there,other\n1,done,0,false,false\n", encoding="utf-8")
    assert tachk.conform(model, file).accepted is False


@pytest.mark.parametrize("column", ["at = P.A", "P", "held = P.v"])
def test_process_that_is_replaced(column: str) -> None:
    text = """
        chan a; process P() { int v; init location A { to A { sync a!; } } }
        process Q() { init location A { to A { sync a?; } } } system P, Q;
    """
    with pytest.raises(tachk.InputError, match="E0456"):
        tachk.loads(f"{text} recording {{ visible a as a({column}); replaces P; }}")


JOINED = """
    chan a; process P() { init location A { to A { sync a!; } } }
    process Q() { init location A { to A { sync a?; } } } system P, Q; broadcast chan b;
"""


@pytest.mark.parametrize(
    ("clauses", "place"),
    [
        ("visible a as a();", "visible a as a();"),
        ("visible a! as a();", "visible a! as a();"),
        ("visible b as b(); hidden a;", "a"),
    ],
)
def test_a_channel_that_joins_processes_that_are_left_has_a_place(clauses: str, place: str) -> None:
    with pytest.raises(tachk.InputError, match="E0457") as caught:
        tachk.loads(f"{JOINED} recording {{ {clauses} }}")
    assert [found.span.text for found in caught.value.diagnostics] == [place]


@pytest.mark.parametrize(
    "clauses", ["visible a as a(); replaces Q;", "visible a? as a();", "visible a as a(); replaces P;"]
)
def test_a_channel_on_which_the_recording_takes_part(clauses: str) -> None:
    assert tachk.loads(f"{JOINED} recording {{ {clauses} }}").network.processes
    assert tachk.loads(f"broadcast {JOINED.strip()} recording {{ visible a as a(); }}").network.processes


def test_local_variable_in_a_column(tmp_path: Path) -> None:
    model = tachk.loads("""
        broadcast chan c;
        process P() { int[0, 9] v; init location A { to A { sync c!; assign v = v + 1; } } }
        system P;
        recording { visible c as c(v = P.v); }
    """)
    file = tmp_path / "events.csv"
    for values, expected in (((1, 2), True), ((1, 1), False)):
        file.write_text(f"time,event,v\n1,c,{values[0]}\n1,c,{values[1]}\n", encoding="utf-8")
        assert tachk.conform(model, file).accepted is expected


@pytest.mark.parametrize("seed", seeds(range(8)))
def test_receivers_have_done_their_part(seed: int, tmp_path: Path) -> None:
    """Receivers change what the event tells, whether they stand before or behind the sender in the system line."""
    random = Random(seed)
    names = ["S", *(f"R{n}" for n in range(random.randint(1, 3)))]
    steps = {name: (random.randint(1, 5), random.randint(0, 5), random.randrange(3)) for name in names}
    processes = [
        f"process {name}() {{ init location L0 {{ to L{there} {{ sync c{'!' if name == 'S' else '?'}; "
        f"assign n = {factor} * n + {summand}; }} }} location L1 {{}} location L2 {{}} }}"
        for name, (factor, summand, there) in steps.items()
    ]
    order = random.sample(names, len(names))
    number = random.randint(0, 3)
    columns = ", ".join(["n", *names, *(f"{name}_first = {name}.L0" for name in names)])
    model = tachk.loads(
        f"broadcast chan c; int n = {number}; {' '.join(processes)} system {', '.join(order)};"
        f"recording {{ visible c as c({columns}); }}"
    )
    for name in ["S", *(name for name in order if name != "S")]:
        factor, summand, _ = steps[name]
        number = factor * number + summand
    cells = {"n": str(number)}
    cells |= {name: f"L{there}" for name, (_, _, there) in steps.items()}
    cells |= {f"{name}_first": str(there == 0).lower() for name, (_, _, there) in steps.items()}
    file = tmp_path / "events.csv"

    def accepted(own: dict[str, str]) -> bool | None:
        file.write_text(f"time,event,{','.join(own)}\n3,c,{','.join(own.values())}\n", encoding="utf-8")
        return tachk.conform(model, file).accepted

    assert accepted(cells) is True
    changed = random.choice(list(cells))
    wrong = {"n": str(number + 1), "S": "L1" if cells["S"] != "L1" else "L2"}.get(changed)
    if wrong is not None:
        assert accepted({**cells, changed: wrong}) is False
