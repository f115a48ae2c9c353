"""The part of docs/performance.md that a stored run gives: what it says, and that it is what the stored run says."""

from __future__ import annotations

import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).resolve().parents[2]

if not (ROOT / "bench").is_dir():
    pytest.skip("needs a checkout", allow_module_level=True)

sys.path.append(str(ROOT))

from bench.families import Instance  # noqa: E402
from bench.page import blocks, pictures, replaced  # noqa: E402
from bench.side_by_side import Contest, Program, ResourceLimits, Row  # noqa: E402
from bench.stored_runs import StoredRun, growth, losses, read, wins_from, write  # noqa: E402

PAGE = ROOT / "docs" / "performance.md"
STORED = ROOT / "bench" / "results" / "families.json"


def row(program: str, size: int, seconds: float, stored: int = 10, answer: str = "reached") -> Row:
    return Row("fischer", size, program, "", answer, stored, stored, stored, seconds, 0.0, 10**7, 0)


def run(*rows: Row) -> StoredRun:
    return StoredRun("2026-01-01T00:00", "a machine", "abc", 60, 3.0, 3, rows)


def test_the_page_and_its_curves_are_what_the_stored_run_gives() -> None:
    stored = read(STORED)
    text = PAGE.read_text(encoding="utf-8")
    assert replaced(text, blocks(stored)) == text, "python -m bench page bench/results/families.json"
    for name, svg in pictures(stored).items():
        assert (PAGE.parent / "images" / name).read_text(encoding="utf-8") == svg
        assert ElementTree.fromstring(svg).tag.endswith("svg")


def test_the_stored_run_has_no_two_answers_to_one_question() -> None:
    stored = read(STORED)
    answers: dict[tuple[str, int], set[str]] = {}
    for one in stored.rows:
        if one.finished:
            answers.setdefault((one.family, one.size), set()).add(one.answer)
    assert {instance: found for instance, found in answers.items() if len(found) > 1} == {}


def test_tachk_wins_from_the_size_from_which_on_nobody_is_faster() -> None:
    rows = [row("TChecker", 2, 0.1), row("tachk", 2, 0.2), row("TChecker", 4, 0.3), row("tachk", 4, 0.3)]
    assert wins_from(run(*rows, row("tachk", 6, 0.9)), "fischer") == 4
    assert wins_from(run(*rows, row("tachk", 6, 0.9), row("TARZAN", 6, 0.8)), "fischer") is None
    assert wins_from(run(*rows, row("tachk", 6, 60, answer="out of time")), "fischer") is None


def test_a_loss_is_what_takes_longer_than_the_best_other_and_more_than_a_start() -> None:
    rows = [row("tachk", 2, 0.2), row("TARZAN", 2, 0.1), row("tachk", 4, 0.8), row("TARZAN", 4, 0.4)]
    rows += [row("TChecker", 4, 0.2), row("tachk", 6, 60, answer="out of time"), row("TARZAN", 6, 50)]
    (first, second) = losses(run(*rows), ["fischer"])
    assert (first.size, first.best.program, first.factor) == (4, "TChecker", 4.0)
    assert second.size == 6 and second.factor == float("inf")


def test_growth_compares_with_the_size_that_has_a_tenth_of_the_states() -> None:
    rows = [row("tachk", 2, 0.1, 10), row("tachk", 3, 0.2, 100), row("tachk", 4, 0.4, 700), row("tachk", 5, 4, 1000)]
    found = growth(run(*rows), "fischer")
    assert found is not None and (found.large.size, found.small.size) == (5, 3)
    assert found.factor == pytest.approx(2.0)
    assert growth(run(rows[0]), "fischer") is None


def test_a_run_is_read_as_it_was_written(tmp_path: Path) -> None:
    told = run(row("tachk", 2, 0.125), row("TARZAN", 2, 0.25))
    write(told, tmp_path / "run.json")
    assert read(tmp_path / "run.json") == told


def test_who_did_not_finish_a_size_is_not_asked_about_larger_ones() -> None:
    contest = Contest("fischer", 1, ResourceLimits(60))
    contest.ended.add("TARZAN")
    program = Program("TARZAN", executable="none", settings=("dfs", "bfs"))
    assert contest.measure(4, Instance(()), [program]) == []


def test_who_was_ended_has_another_try_where_tachk_decides_nothing(tmp_path: Path) -> None:
    contest = Contest("fischer", 1, ResourceLimits(60), settings={"TChecker": ("covreach bfs",)}, ended={"TChecker"})
    programs = [Program("tachk", source=tmp_path), Program("TChecker", executable="true", settings=("covreach bfs",))]
    (tmp_path / "tachk").mkdir()
    (tmp_path / "tachk" / "__main__.py").write_text("", encoding="utf-8")
    found = contest.measure(4, Instance((), network=tmp_path), programs)
    assert [one.program for one in found] == ["tachk", "TChecker"]


def test_who_had_words_for_a_smaller_size_and_gives_no_answer_has_failed(tmp_path: Path) -> None:
    contest = Contest("fischer", 1, ResourceLimits(60), settings={"TChecker": ("covreach bfs",)})
    program = Program("TChecker", executable="true", settings=("covreach bfs", "reach bfs"))
    (failed,) = contest.measure(4, Instance((), network=tmp_path), [program])
    assert not failed.finished and failed.answer == "ended with an error" and contest.ended == {"TChecker"}
