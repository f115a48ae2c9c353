"""`tachk conform --repair` finds what was taken out of models, and every change that it proposes is one."""

from __future__ import annotations

import re
from pathlib import Path
from random import Random

import pytest

import tachk
from tachk.api.repairing import repair
from tests.support.seeds import seeds
from tests.unit.recordings.conformance.small_models import csv_of, random_machine, random_run, text_of

ROOT = Path(__file__).parents[4]
DIMMER = ROOT / "examples/dimmer/dimmer.ta"
PRESSED = ROOT / "examples/dimmer/pressed.csv"
EDGES = (
    "to Waking { sync press?; assign since = 0; }",
    "to On { guard since >= 3; sync light[1]!; assign level = 7, since = 0; }",
    "to Off { guard since >= 50; sync light[0]!; assign level = 0; }",
)


def with_edge(text: str, template: str, source: str, edge: str) -> str:
    """The text of a model with an edge more in the block of a location."""
    start = text.index(f"process {template}(")
    head = re.compile(rf"location {source}( *\{{| *;)").search(text, start)
    assert head is not None
    if head[1].endswith(";"):
        return text[: head.start(1)] + f" {{ {edge} }}" + text[head.end(1) :]
    invariant = re.compile(r"\s*invariant [^;]*;").match(text, head.end())
    place = head.end() if invariant is None else invariant.end()
    return f"{text[:place]}\n{edge}\n{text[place:]}"


@pytest.mark.parametrize("edge", [EDGES[0], EDGES[2]])
def test_deleted_edge_is_among_the_first_three(edge: str, tmp_path: Path) -> None:
    model = tmp_path / "model.ta"
    model.write_text(DIMMER.read_text(encoding="utf-8").replace(edge, ""), encoding="utf-8")
    found = repair(model, [PRESSED])
    assert found.repair.rejected == (0,)

    def plain(edge: str) -> str:
        """Without the guard, and the update that a meta variable does not need."""
        return re.sub(r"guard [^;]*; |assign level = 0; ", "", edge)

    assert plain(edge) in [plain(each.proposal.text) for each in found.repair.edges]


def test_numbers_that_nothing_says_are_not_invented(tmp_path: Path) -> None:
    """No other edge says how bright the light is: there is no proposal, and the report says so."""
    model = tmp_path / "model.ta"
    model.write_text(DIMMER.read_text(encoding="utf-8").replace(EDGES[1], ""), encoding="utf-8")
    found = repair(model, [PRESSED])
    assert found.repair.rejected == (0,) and not found.repair.edges
    assert "no change was found that makes the recording a run of the model" in found.to_text()


def test_other_number() -> None:
    found = repair(DIMMER, [PRESSED, DIMMER.with_name("too_soon.csv")])
    assert found.repair.rejected == (1,)
    (number,) = found.repair.constants
    # At 40 the light is off, which is 33.8 ms after it was on; each is recorded up to 1 ms late.
    assert (number.before, number.after, number.far) == (50, 36, 0)
    assert number.name == f"50 at {DIMMER}:25:33"


def test_other_constant(tmp_path: Path) -> None:
    model = tmp_path / "model.ta"
    text = DIMMER.read_text(encoding="utf-8")
    model.write_text("const int LONG = 50;\n" + text.replace("since >= 50", "since >= LONG"), encoding="utf-8")
    found = repair(model, [DIMMER.with_name("too_soon.csv")])
    assert [(each.name, each.after) for each in found.repair.constants] == [("LONG", 36)]
    assert "LONG = 36 to 0 in place of 50" in found.to_text()


def test_runs_need_no_repair() -> None:
    found = repair(DIMMER, [PRESSED])
    assert not found.repair.rejected and not found.repair.edges and not found.repair.constants
    assert "nothing to change" in found.to_text()


def test_changed_verdicts_are_named(tmp_path: Path) -> None:
    model = tmp_path / "model.ta"
    text = DIMMER.read_text(encoding="utf-8").replace(EDGES[2], "")
    model.write_text(text + "property goes_off : Lamp.On --> Lamp.Off;\n", encoding="utf-8")
    found = repair(model, [PRESSED])
    assert found.repair.edges[0].proposal.target == "Off"
    (changed,) = found.verdicts[len(found.repair.constants)] or ()
    assert (changed.name, changed.before, changed.after) == ("goes_off", tachk.Answer.FAILS, tachk.Answer.HOLDS)
    assert "goes_off: fails becomes holds" in found.to_text()


def test_verdicts_that_a_number_changes_are_named(tmp_path: Path) -> None:
    model = tmp_path / "model.ta"
    text = DIMMER.read_text(encoding="utf-8").replace("int level = 0;", "int level = 0;\nint went_off = 0;")
    text = text.replace("assign level = 0;", "assign level = 0, went_off = 1;")
    text += "property slow : A[] Lamp.Off && went_off == 1 imply Lamp.since >= 50;\n"
    model.write_text(text, encoding="utf-8")
    found = repair(model, [DIMMER.with_name("too_soon.csv")])
    (number,) = found.repair.constants
    assert number.is_number and number.after == 36
    (changed,) = found.verdicts[0] or ()
    assert (changed.name, changed.before, changed.after) == ("slow", tachk.Answer.HOLDS, tachk.Answer.FAILS)


@pytest.mark.drawn
@pytest.mark.parametrize("seed", seeds(range(24)))
def test_every_change_is_one(seed: int, tmp_path: Path) -> None:
    """An edge is taken out of a random model; with each proposal written into its text its runs are runs again."""
    random = Random(seed)
    machines = tuple(random_machine(random) for _ in range(random.randint(1, 2)))
    files = []
    for number in range(3):
        events, end = random_run(random, machines, 14, False)
        files.append(tmp_path / f"{number}.csv")
        files[-1].write_text(csv_of(events, end), encoding="utf-8")
    lines = text_of(machines, False).splitlines(keepends=True)
    edges = [number for number, line in enumerate(lines) if re.match(r"\s*(to \w+|\w+ -> \w+) ", line)]
    del lines[random.choice(edges)]
    model = tmp_path / "model.ta"
    model.write_text("".join(lines), encoding="utf-8")
    found = repair(model, files, "0", "0")
    expected = [number for number, file in enumerate(files) if not tachk.conform(model, file, "0", "0").accepted]
    assert list(found.repair.rejected) == expected
    for each in found.repair.edges:
        text = with_edge("".join(lines), each.proposal.template, each.proposal.source, each.proposal.text)
        changed = tachk.loads(text)
        assert all(tachk.conform(changed, file, "0", "0").accepted for file in files), each.proposal.text
    for constant in found.repair.constants:
        for value in (constant.after, constant.far):
            changed = tachk.loads(_with_number("".join(lines), constant.name, value))
            assert all(tachk.conform(changed, file, "0", "0").accepted for file in files), constant


def _with_number(text: str, name: str, value: int) -> str:
    """The text with a number at a place, as a report names it, or a constant changed."""
    found = re.fullmatch(r"(\d+) at .*:(\d+):(\d+)", name)
    if found is None:
        return re.sub(rf"(const int {name} = )-?\d+", rf"\g<1>{value}", text)
    before, line, column = found[1], int(found[2]), int(found[3])
    lines = text.splitlines(keepends=True)
    here = lines[line - 1]
    assert here[column - 1 :].startswith(before)
    lines[line - 1] = here[: column - 1] + str(value) + here[column - 1 + len(before) :]
    return "".join(lines)
