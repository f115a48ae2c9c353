"""Messages at places of files, for code hosts: SARIF 2.1.0 and the commands of GitHub's workflows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import PurePath
from typing import Any
from urllib.parse import quote

import tachk
from tachk.base.diagnostics.diagnostic import Diagnostic, Label
from tachk.base.records import dataclass
from tachk.base.span import Span

RULES = {
    "unexpected-answer": (
        "The answer to a property is not the expected one.",
        "A property is expected to hold unless the model says `expect fails`. The message has the run that shows it.",
    ),
    "unknown-answer": (
        "A property was not decided.",
        "A limit was hit, or tachk does not answer such a property. The message says which.",
    ),
}
"""The rules of annotations that are no diagnostics, each with a line and an explanation."""


@dataclass(frozen=True, slots=True)
class Annotation:
    """A message about a place.

    Attributes:
        level: ``error`` or ``warning``.
        rule: the code of a diagnostic, or one of `RULES`.
        message: some sentences.
        span: the place; None where no file has it, such as a query of the command line.
        labels: further places.
    """

    level: str
    rule: str
    message: str
    span: Span | None = None
    labels: tuple[Label, ...] = ()


def annotated(diagnostic: Diagnostic) -> Annotation:
    """The annotation for a diagnostic."""
    message = with_help(diagnostic.message, diagnostic.help)
    labels = tuple(label for label in diagnostic.labels if in_a_file(label.span) is not None)
    return Annotation(diagnostic.severity.value, diagnostic.code, message, in_a_file(diagnostic.span), labels)


def in_a_file(span: Span) -> Span | None:
    """The place, if users can open it; queries of the command line and of scripts have none."""
    return None if span.in_file.source.name.startswith("<") else span


def with_help(message: str, help: str | None) -> str:
    return f"{message} ({help})" if help else message


def to_sarif(annotations: Sequence[Annotation], complaints: Sequence[str]) -> dict[str, Any]:
    """SARIF 2.1.0, the form of code scanning.

    Args:
        complaints: what is wrong that has no place in a text, such as a file that is not there.
    """
    codes = sorted({annotation.rule for annotation in annotations})
    return {
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [
            {
                "tool": {
                    "driver": {"name": "tachk", "version": tachk.__version__, "rules": [_rule(code) for code in codes]}
                },
                "columnKind": "unicodeCodePoints",
                "invocations": [
                    {
                        "executionSuccessful": not complaints,
                        "toolExecutionNotifications": [
                            {"level": "error", "message": {"text": complaint}} for complaint in complaints
                        ],
                    }
                ],
                "results": [_result(annotation, codes.index(annotation.rule)) for annotation in annotations],
            }
        ],
    }


def _rule(code: str) -> dict[str, Any]:
    from tachk.base.diagnostics.explanation import all_explanations  # reads a file

    if code in RULES:
        short, full = RULES[code]
        return {"id": code, "shortDescription": {"text": short}, "fullDescription": {"text": full}}
    explanation = all_explanations().get(code)
    if explanation is None:
        return {"id": code}
    return {
        "id": code,
        "shortDescription": {"text": explanation.title},
        "fullDescription": {"text": explanation.why},
        "help": {"text": f"tachk explain {code}"},
    }


def _result(annotation: Annotation, rule: int) -> dict[str, Any]:
    related = [{**_location(label.span), "message": {"text": label.text}} for label in annotation.labels]
    return {
        "ruleId": annotation.rule,
        "ruleIndex": rule,
        "level": annotation.level,
        "message": {"text": annotation.message},
        "locations": [] if annotation.span is None else [_location(annotation.span)],
        **({"relatedLocations": related} if related else {}),
    }


def _location(span: Span) -> dict[str, Any]:
    place = _FilePlace(span)
    return {
        "physicalLocation": {
            "artifactLocation": {"uri": quote(PurePath(place.file).as_posix())},
            "region": {
                "startLine": place.line,
                "startColumn": place.column,
                "endLine": place.end_line,
                "endColumn": place.end_column,
            },
        }
    }


def to_github(annotations: Iterable[Annotation], complaints: Iterable[str]) -> Iterator[str]:
    """Workflow commands: GitHub Actions shows each as an annotation at its line.

    Args:
        complaints: as for `to_sarif`.
    """
    for annotation in annotations:
        fields: dict[str, str | int] = {}
        if annotation.span is not None:
            place = _FilePlace(annotation.span)
            fields = {"file": place.file, "line": place.line, "endLine": place.end_line}
            if place.line == place.end_line:
                fields |= {"col": place.column, "endColumn": place.end_column}
        fields["title"] = annotation.rule
        written = ",".join(f"{name}={_escaped_field(str(value))}" for name, value in fields.items())
        yield f"::{annotation.level} {written}::{_escaped(annotation.message)}"
    for complaint in complaints:
        yield f"::error title=tachk::{_escaped(complaint)}"


class _FilePlace:
    """The place of a range in the file that people see; lines and columns count from 1."""

    def __init__(self, span: Span) -> None:
        place = span.in_file
        self.file = place.source.name
        self.line, self.column = place.source.line_column(place.start)
        self.end_line, self.end_column = place.source.line_column(place.end)


def _escaped(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _escaped_field(text: str) -> str:
    return _escaped(text).replace(":", "%3A").replace(",", "%2C")
