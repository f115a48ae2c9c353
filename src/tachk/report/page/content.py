"""The content of a page: answers about models, other results, texts, and how to repeat it all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from tachk.report.drawing.svg import Picture


@dataclass(frozen=True, slots=True)
class Section:
    """One answer.

    Attributes:
        place: the name of the section on the page.
        result: as docs/schema/verify.schema.json has it.
        values: what `sup`, `inf` and `bounds` have found.
        run_text: the run in words, or the run-time error; empty if there is none.
        chart: the sequence chart of the run; empty where there is none.
        playback: the run for the script; None where there is none.
    """

    place: str
    result: Mapping[str, Any]
    values: Sequence[str] = ()
    run_text: str = ""
    chart: str = ""
    playback: Mapping[str, Any] | None = field(default=None, repr=False)


@dataclass(frozen=True, slots=True)
class SourceLine:
    """A line of the text of a model.

    Attributes:
        section: about the property that begins in it, if there is one.
    """

    number: int
    text: str
    section: Section | None = None


@dataclass(frozen=True, slots=True)
class SourceFile:
    """The text of a model file."""

    name: str
    lines: Sequence[SourceLine] = field(repr=False)


@dataclass(frozen=True, slots=True)
class Answers:
    """The answers about one model.

    Attributes:
        run: as docs/schema/verify.schema.json has it.
        pictures: of the templates; the name of each is what the playbacks call it.
        sources: the texts of the model file and of those that it imports.
        remark: why there are none of both.
    """

    run: Mapping[str, Any]
    sections: Sequence[Section]
    pictures: Sequence[Picture] = ()
    sources: Sequence[SourceFile] = ()
    remark: str = ""


@dataclass(frozen=True, slots=True)
class Table:
    """Attributes:
    numbers: the columns that hold numbers, from 0.
    rows: texts; one that is an answer or a verdict is coloured.
    """

    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    numbers: frozenset[int] = frozenset()


@dataclass(frozen=True, slots=True)
class Chapter:
    """Another result.

    Attributes:
        title: empty for a picture alone.
        lines: what is said about it, in sentences.
        tables: what was found.
        pictures: what a picture shows, and its SVG.
        details: what is folded away: a title and a text.
    """

    title: str
    lines: Sequence[str] = ()
    tables: Sequence[Table] = ()
    pictures: Sequence[tuple[str, str]] = ()
    details: Sequence[tuple[str, str]] = ()


@dataclass(frozen=True, slots=True)
class Text:
    """The comments of a person on the results.

    Attributes:
        markdown: without HTML.
    """

    markdown: str


Part = Answers | Chapter | Text


@dataclass(frozen=True, slots=True)
class Page:
    """Attributes:
    parts: in the order in which they are shown.
    facts: what is needed to repeat it: names and values.
    """

    title: str
    parts: Sequence[Part]
    facts: Sequence[tuple[str, str]] = ()

    @property
    def answers(self) -> list[Answers]:
        """The parts about models."""
        return [part for part in self.parts if isinstance(part, Answers)]

    @property
    def automata(self) -> Mapping[str, Sequence[Picture]]:
        """The pictures by models, each model once."""
        return {answers.run["model"]: answers.pictures for answers in self.answers if answers.pictures}

    @property
    def with_sources(self) -> Sequence[Answers]:
        """The answers about models whose texts are shown: the first ones about each model."""
        first: dict[str, Answers] = {}
        for answers in self.answers:
            if answers.sources:
                first.setdefault(answers.run["model"], answers)
        return [*first.values()]

    @property
    def results(self) -> list[Mapping[str, Any]]:
        """All results of verification."""
        return [section.result for answers in self.answers for section in answers.sections]

    @property
    def estimates(self) -> list[Mapping[str, Any]]:
        """All answers to statistical queries of verifications."""
        return [estimate for answers in self.answers for estimate in answers.run.get("estimates", ())]
