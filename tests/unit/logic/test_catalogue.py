"""The catalogue of sentences: its observers, its page of documentation and the pictures there."""

from __future__ import annotations

import runpy
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import pytest

from tachk.logic.durations import resolve
from tachk.logic.observer.construction import NoObserver, build_observer
from tachk.logic.patterns import CATALOGUE, Pattern, patterns
from tachk.syntax.formula import Formula
from tests.support.exact_monitor import verdict
from tests.support.exact_trace import ExactTrace, Scalar

DOCS = Path(__file__).parents[3] / "docs"
PAGE = SimpleNamespace(**runpy.run_path(str(DOCS / "sentence_pictures.py")))

every_pattern = pytest.mark.parametrize("pattern", patterns(), ids=lambda pattern: pattern.name)


def in_seconds(pattern: Pattern) -> Formula:
    return resolve(pattern.tree, lambda _: None, "s")


@every_pattern
def test_the_observer_that_is_named_exists(pattern: Pattern) -> None:
    if pattern.shape:
        build_observer(in_seconds(pattern), "Observer")
        return
    with pytest.raises(NoObserver):
        build_observer(in_seconds(pattern), "Observer")


def test_names_are_unique_and_shapes_known() -> None:
    names = [pattern.name for pattern in patterns()]
    assert len(set(names)) == len(names)
    assert {pattern.shape for pattern in patterns()} <= {"", *(f"S{number}" for number in range(1, 11))}
    assert all(family.patterns for family in CATALOGUE)


def trace_of(waves: dict[str, str]) -> ExactTrace:
    """The run that a picture shows."""
    times = range(PAGE.LAST)
    columns: dict[str, tuple[Scalar, ...]] = {}
    for name, wave in waves.items():
        if ":" in wave:
            steps = PAGE.values(wave)
            columns[name] = tuple(Fraction([value for begin, value in steps if begin <= time][-1]) for time in times)
        else:
            columns[name] = tuple(any(begin <= time < end for begin, end in PAGE.runs(wave)) for time in times)
    return ExactTrace(tuple(map(Fraction, times)), columns, PAGE.LAST - Fraction(1, 10))


@every_pattern
def test_pictures_show_runs_of_which_the_sentence_is_true(pattern: Pattern) -> None:
    picture = PAGE.PICTURES[pattern.name]
    assert verdict(in_seconds(pattern), trace_of(picture.waves)).truth is not False


@every_pattern
def test_pictures_show_what_is_demanded(pattern: Pattern) -> None:
    picture = PAGE.PICTURES[pattern.name]
    for mark in PAGE.marks(picture):
        if mark.kind in ("some", "all", "none"):
            runs = PAGE.runs(picture.waves[mark.signal])
            met = [(max(a, mark.begin), min(b, mark.end)) for a, b in runs if a <= mark.end and mark.begin < b]
            inside = sum(b - a for a, b in met)
            assert {"some": bool(met), "all": inside == mark.end - mark.begin, "none": inside == 0}[mark.kind]


@every_pattern
def test_pictures_are_up_to_date(pattern: Pattern) -> None:
    kept = (DOCS / "sentences" / PAGE.file_name(pattern)).read_text(encoding="utf-8")
    assert kept == PAGE.draw(pattern), "run python docs/sentence_pictures.py"


def test_the_page_is_up_to_date() -> None:
    text = (DOCS / "sentences.md").read_text(encoding="utf-8")
    assert text == PAGE.page(text), "run python docs/sentence_pictures.py"
    files = {path.name for path in (DOCS / "sentences").iterdir()}
    assert files == {PAGE.file_name(pattern) for pattern in patterns()}
