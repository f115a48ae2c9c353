"""The forms in which findings about requirements are told."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import pytest

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.commands.requirements import run_requirements
from tachk.cli.exit_status import ExitStatus
from tachk.verify.requirements.analysis import FindingKind

ROOT = Path(__file__).parents[4]
SCHEMA = json.loads((ROOT / "docs/schema/requirements.schema.json").read_text(encoding="utf-8"))


def found(tmp_path: Path, file: str) -> tuple[ExitStatus, dict]:
    output = tmp_path / "found.json"
    status = run_requirements(file, "json", output)
    told = json.loads(output.read_text(encoding="utf-8"))
    jsonschema.validate(told, SCHEMA)
    return status, told


def test_findings_follow_the_schema(tmp_path: Path) -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    status, told = found(tmp_path, str(ROOT / "examples/night_light.stl"))
    assert status is ExitStatus.NOT_AS_EXPECTED
    assert told["unit"] == "s"
    assert told["requirements"][0]["name"] == "light"
    kinds = {finding["kind"]: finding for finding in told["findings"]}
    assert kinds["colliding"]["requirements"] == ["light", "calm"]
    start, end = kinds["colliding"]["run"]
    assert (start["time"], end["time"]) == ("0", "5")
    assert start["signals"] == {"alarm": "true", "button": "true", "lamp": "false"}
    assert (kinds["redundant"]["requirements"], kinds["redundant"]["by"]) == (["soon"], ["light"])
    assert kinds["vacuous"]["by"] == ["dark"]


def test_what_is_not_followed_follows_the_schema(tmp_path: Path) -> None:
    file = tmp_path / "set.stl"
    file.write_text("late: G (p -> F[2, 5] q)\nnever: G !p\nalways: F[0, 2.5] p\n", encoding="utf-8")
    status, told = found(tmp_path, str(file))
    assert status is ExitStatus.NOT_AS_EXPECTED
    late, never, _ = told["requirements"]
    assert (late["followed"], never["followed"], never["reason"]) == (False, True, "")
    assert late["reason"]
    (undecided,) = told["undecided"]
    assert undecided.startswith("late is not followed")
    assert [finding["kind"] for finding in told["findings"]] == ["inconsistent"]


def test_the_schema_knows_every_finding_and_no_other() -> None:
    assert SCHEMA["properties"]["findings"]["items"]["properties"]["kind"]["enum"] == [
        kind.value for kind in FindingKind
    ]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"unit": "", "requirements": [], "findings": [], "undecided": [], "more": 1}, SCHEMA)


def test_what_no_other_requirement_is_to_blame_for_names_none(tmp_path: Path) -> None:
    file, output = tmp_path / "set.stl", tmp_path / "found.txt"
    file.write_text("a: G (x > 5 && x < 3 -> p)\nb: G (p -> p || q)\n", encoding="utf-8")
    assert run_requirements(str(file), output=output) is ExitStatus.NOT_AS_EXPECTED
    lines = output.read_text(encoding="utf-8").splitlines()
    assert "vacuous: the trigger of a never happens" in lines
    assert "redundant: b always holds" in lines
    _, told = found(tmp_path, str(file))
    assert [finding["by"] for finding in told["findings"]] == [[], []]


def test_constants_of_the_file_are_no_signals(tmp_path: Path) -> None:
    file, output = tmp_path / "set.stl", tmp_path / "found.txt"
    file.write_text(
        "const N = 3\nconst T = 2.5\na: G (N > 2)\nb: G (x > 2 * N -> y)\nc: G (x > 7 -> F[0, T] !y)\n",
        encoding="utf-8",
    )
    assert run_requirements(str(file), output=output) is ExitStatus.NOT_AS_EXPECTED
    assert output.read_text(encoding="utf-8").splitlines() == [
        "3 requirements about x, y",
        "",
        "redundant: a always holds",
    ]
    # With other values the trigger of `b` never happens, and `a` cannot be satisfied.
    assert run_requirements(str(file), output=output, definitions=("N=2", "T=1")) is ExitStatus.NOT_AS_EXPECTED
    assert "inconsistent: no run satisfies a for ever" in output.read_text(encoding="utf-8")
    with pytest.raises(UsageError):
        run_requirements(str(file), output=output, definitions=("M=2",))


def test_what_demands_forbid_together_is_reported_for_both(tmp_path: Path) -> None:
    file, output = tmp_path / "set.stl", tmp_path / "found.txt"
    file.write_text("a: G (p -> q)\nb: G (p -> !q)\n", encoding="utf-8")
    assert run_requirements(str(file), output=output) is ExitStatus.NOT_AS_EXPECTED
    assert "vacuous: the triggers of a and b never happen if a and b hold" in output.read_text(encoding="utf-8")
    _, told = found(tmp_path, str(file))
    (finding,) = told["findings"]
    assert (finding["requirements"], finding["by"]) == (["a", "b"], ["a", "b"])
