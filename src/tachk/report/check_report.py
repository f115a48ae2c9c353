"""The findings of `tachk check`, in the forms that editors, code hosts and build servers read."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import tachk
from tachk.base.diagnostics.diagnostic import Diagnostic, Severity
from tachk.base.plain_data import Fields, PlainData, complaint
from tachk.base.span import Span

if TYPE_CHECKING:
    from tachk.model.network import Network
    from tachk.verify.semantic_lint.findings import DeepCheck


@dataclass(frozen=True, slots=True)
class Size:
    """The size of a model."""

    processes: int
    locations: int
    edges: int
    properties: int


@dataclass(frozen=True, slots=True)
class Checked:
    """The findings about one model.

    Attributes:
        model: the path as the user gave it.
        size: None where the model is wrong or refused.
        findings: every mistake and warning, in the order in which they are reported.
        portability: what a version of UPPAAL would refuse or treat otherwise, if that was requested.
        complaint: what is wrong that has no place in a text, such as a file that is not there.
        help: how to mend the complaint.
        out_of_time: whether the complaint is that the limit on time was over, and nothing else is known.
        deep: the findings from the states of the model, if they were requested.
        network: the model, for printing them.
    """

    model: str
    size: Size | None = None
    findings: tuple[Diagnostic, ...] = ()
    portability: tuple[Diagnostic, ...] | None = None
    complaint: str | None = None
    help: str | None = None
    out_of_time: bool = False
    deep: DeepCheck | None = None
    network: Network | None = None

    @property
    def everything(self) -> tuple[Diagnostic, ...]:
        deep = () if self.deep is None else self.deep.findings
        return (*self.findings, *deep, *(self.portability or ()))


def checks_to_json(checks: Iterable[Checked]) -> dict[str, Any]:
    """The form that docs/schema/check.schema.json describes."""
    return {"models": [_check_to_json(check) for check in checks]}


def _check_to_json(check: Checked) -> dict[str, Any]:
    return {**_PLAIN.of(check), "deep": _deep_to_json(check)}


def _findings(check: Checked) -> list[object]:
    return [*([complaint(check.complaint, check.help)] if check.complaint else []), *check.findings]


_PLAIN = PlainData({Checked: Fields("model size findings portability", findings=_findings)})


def _deep_to_json(check: Checked) -> dict[str, Any] | None:
    if check.deep is None or check.network is None:
        return None
    from tachk.report.deep_report import deep_to_json

    return deep_to_json(check.network, check.deep)


def checks_to_sarif(checks: Sequence[Checked]) -> dict[str, Any]:
    """SARIF 2.1.0, the form of code scanning."""
    found = [diagnostic for check in checks for diagnostic in check.everything]
    codes = sorted({diagnostic.code for diagnostic in found})
    complaints = [check for check in checks if check.complaint is not None]
    return {
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [
            {
                "tool": {
                    "driver": {
                        "name": "tachk",
                        "version": tachk.__version__,
                        "rules": [_sarif_rule(code) for code in codes],
                    }
                },
                "columnKind": "unicodeCodePoints",
                "invocations": [
                    {
                        "executionSuccessful": not complaints,
                        "toolExecutionNotifications": [
                            {"level": "error", "message": {"text": _sentence(check.complaint or "", check.help)}}
                            for check in complaints
                        ],
                    }
                ],
                "results": [_sarif_result(diagnostic, codes.index(diagnostic.code)) for diagnostic in found],
            }
        ],
    }


def _sarif_rule(code: str) -> dict[str, Any]:
    from tachk.base.diagnostics.explanation import all_explanations  # reads a file

    explanation = all_explanations().get(code)
    if explanation is None:
        return {"id": code}
    return {
        "id": code,
        "shortDescription": {"text": explanation.title},
        "fullDescription": {"text": explanation.why},
        "help": {"text": f"tachk explain {code}"},
    }


def _sarif_result(diagnostic: Diagnostic, rule: int) -> dict[str, Any]:
    related = [{**_sarif_location(label.span), "message": {"text": label.text}} for label in diagnostic.labels]
    return {
        "ruleId": diagnostic.code,
        "ruleIndex": rule,
        "level": diagnostic.severity.value,
        "message": {"text": _sentence(diagnostic.message, diagnostic.help)},
        "locations": [_sarif_location(diagnostic.span)],
        **({"relatedLocations": related} if related else {}),
    }


def _sarif_location(span: Span) -> dict[str, Any]:
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


def checks_to_github(checks: Iterable[Checked]) -> Iterator[str]:
    """Workflow commands: GitHub Actions shows each as an annotation at its line."""
    for check in checks:
        if check.complaint is not None:
            yield f"::error title=tachk::{_escaped(_sentence(f'{check.model}: {check.complaint}', check.help))}"
        for diagnostic in check.everything:
            place = _FilePlace(diagnostic.span)
            fields = {"file": place.file, "line": place.line, "endLine": place.end_line}
            if place.line == place.end_line:
                fields |= {"col": place.column, "endColumn": place.end_column}
            fields["title"] = diagnostic.code
            written = ",".join(f"{name}={_escaped_field(str(value))}" for name, value in fields.items())
            level = "error" if diagnostic.severity is Severity.ERROR else "warning"
            yield f"::{level} {written}::{_escaped(_sentence(diagnostic.message, diagnostic.help))}"


class _FilePlace:
    """The place of a range in the file that people see; lines and columns count from 1."""

    def __init__(self, span: Span) -> None:
        place = span.in_file
        self.file = place.source.name
        self.line, self.column = place.source.line_column(place.start)
        self.end_line, self.end_column = place.source.line_column(place.end)


def _sentence(message: str, help: str | None) -> str:
    return f"{message} ({help})" if help else message


def _escaped(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _escaped_field(text: str) -> str:
    return _escaped(text).replace(":", "%3A").replace(",", "%2C")


CHECK_FORMATS: dict[str, Callable[[Sequence[Checked]], str]] = {
    "json": lambda checks: json.dumps(checks_to_json(checks), indent=2) + "\n",
    "sarif": lambda checks: json.dumps(checks_to_sarif(checks), indent=2) + "\n",
    "github": lambda checks: "".join(f"{line}\n" for line in checks_to_github(checks)),
}
"""The formats for programs, each with the function that writes it about all models."""
