"""The findings of `tachk check`, in the forms that editors, code hosts and build servers read."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.plain_data import Fields, PlainData, complaint
from tachk.report.annotations import annotated, to_github, to_sarif, with_help

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


def _complaints(checks: Iterable[Checked]) -> list[str]:
    return [with_help(f"{c.model}: {c.complaint}", c.help) for c in checks if c.complaint is not None]


def checks_to_sarif(checks: Sequence[Checked]) -> dict[str, Any]:
    """SARIF 2.1.0, the form of code scanning."""
    return to_sarif([annotated(found) for check in checks for found in check.everything], _complaints(checks))


def checks_to_github(checks: Sequence[Checked]) -> Iterator[str]:
    """Workflow commands: GitHub Actions shows each as an annotation at its line."""
    return to_github([annotated(found) for check in checks for found in check.everything], _complaints(checks))


CHECK_FORMATS: dict[str, Callable[[Sequence[Checked]], str]] = {
    "json": lambda checks: json.dumps(checks_to_json(checks), indent=2) + "\n",
    "sarif": lambda checks: json.dumps(checks_to_sarif(checks), indent=2) + "\n",
    "github": lambda checks: "".join(f"{line}\n" for line in checks_to_github(checks)),
}
"""The formats for programs, each with the function that writes it about all models."""
