"""What every tool answers: a summary, the result, its evidence and the limits of the call, as JSON and as text."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from enum import StrEnum
from typing import Any

from tachk.api.tools.limits import LIMITS_SCHEMA, ToolLimits
from tachk.base.plain_data import PlainData
from tachk.base.records import dataclass
from tachk.base.resources import schema_text


class EvidenceKind(StrEnum):
    """The kinds of evidence for an answer."""

    RUN = "run"
    """A run of the model that shows it."""
    CERTIFICATE = "certificate"
    """A set of symbolic states that shows that something is never reached, or always."""
    SAMPLES = "samples"
    """Random runs: an estimate, no proof."""
    NONE = "none"
    """Nothing but the answer of the search."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What shows one answer.

    Attributes:
        about: the name of the property, the finding or the run.
        checked: whether something other than what found it has accepted it in this call.
        how: what was checked and by what, or why it was not.
    """

    about: str
    kind: EvidenceKind
    checked: bool
    how: str

    def __str__(self) -> str:
        kind = "answer" if self.kind is EvidenceKind.NONE else str(self.kind)
        return f"{self.about}: {kind} {'judged' if self.checked else 'not judged'}: {self.how}"


@dataclass(frozen=True, slots=True)
class ToolAnswer:
    """The answer of a call.

    Attributes:
        text: for people and for language models.
        structured: as the schema of the tool says; None for a call that failed, whose text says why.
    """

    text: str
    structured: Mapping[str, Any] | None = None

    @property
    def failed(self) -> bool:
        return self.structured is None


def answer(
    summary: str, result: object, text: str, evidence: Iterable[Evidence], limits: ToolLimits, notes: Iterable[str] = ()
) -> ToolAnswer:
    """The answer with its evidence.

    Args:
        summary: in one line.
        result: as the schema of the tool says.
        text: the result in words.
        notes: what to know about the call, such as warnings and what was left out.
    """
    found, said = list(evidence), list(notes)
    structured = {
        "summary": summary,
        "result": result,
        "evidence": [PlainData()(each) for each in found],
        "notes": said,
        "limits": PlainData()(limits),
    }
    paragraphs = [summary, text.rstrip("\n"), "\n".join(said), "\n".join(f"evidence for {each}" for each in found)]
    return ToolAnswer("\n\n".join(filter(None, paragraphs)) + "\n", json.loads(json.dumps(structured)))


def answer_schema(result: Mapping[str, Any], definitions: Mapping[str, Any]) -> dict[str, Any]:
    """The schema of an answer with such a result."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "type": "object",
        "additionalProperties": False,
        "required": ["summary", "result", "evidence", "notes", "limits"],
        "properties": {
            "summary": {"type": "string", "description": "The answer in one line."},
            "result": result,
            "evidence": {
                "type": "array",
                "items": {
                    "type": "object",
                    "additionalProperties": False,
                    "required": ["about", "kind", "checked", "how"],
                    "properties": {
                        "about": {"type": "string", "description": "A property, a finding or a run."},
                        "kind": {"enum": [kind.value for kind in EvidenceKind]},
                        "checked": {
                            "type": "boolean",
                            "description": "Whether a judge other than the search accepted it in this call; false: "
                            "the answer is not judged.",
                        },
                        "how": {"type": "string", "description": "What was checked, or why it was not."},
                    },
                },
            },
            "notes": {"type": "array", "items": {"type": "string"}, "description": "Warnings, and what was left out."},
            "limits": LIMITS_SCHEMA,
        },
        "$defs": definitions,
    }


def report_schema(report: str, part: str = "") -> dict[str, Any]:
    """The schema of an answer whose result is a report of docs/schema, or a part of one.

    Args:
        part: a name among the ``$defs`` of the report.
    """
    schema = json.loads(schema_text(report))
    definitions = schema.pop("$defs", {})
    if part:
        return answer_schema({"$ref": f"#/$defs/{part}"}, definitions)
    whole = {name: value for name, value in schema.items() if not name.startswith("$")}
    return answer_schema({"$ref": "#/$defs/report"}, {**definitions, "report": whole})
