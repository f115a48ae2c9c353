"""The findings of `tachk check --deep`, as text and as JSON."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from io import StringIO
from typing import Any, TextIO

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.diagnostics.render import render
from tachk.base.frames import data_frame
from tachk.base.notebook import folded, html_table
from tachk.base.plain_data import Fields, PlainData
from tachk.meaning.run_view import view_trace
from tachk.model.network import Network
from tachk.model.quantity import duration, grouped, seconds
from tachk.report.json_report import FORMS, trace_to_json
from tachk.report.plain_console import ReportConsole
from tachk.report.run.display import Ends, RunDisplay
from tachk.report.run.trace_text import print_trace
from tachk.verify.semantic_lint.findings import DeepCheck, LintAnswer, LintEvidence

_ENDS = Ends(4, 8)
"""The steps that are shown of a longer run."""


def print_deep_check(network: Network, check: DeepCheck, out: TextIO) -> None:
    """Prints the extent of the exploration, a line for each question, and the runs that show findings."""
    statistics = check.statistics
    states = "state" if statistics.states_stored == 1 else "states"
    took = f"{grouped(statistics.states_stored)} {states} in {seconds(statistics.seconds)}"
    print(f"  explored {took}, then not on: {check.reason}" if check.reason else f"  explored all {took}", file=out)
    width = max(len(part.question) for part in check.parts)
    for part in check.parts:
        print(f"  {part.question:<{width}}  {part.in_words}", file=out)
    for evidence in check.evidence:
        print(f"\n{_run_text(network, evidence)}", file=out)


def _run_text(network: Network, evidence: LintEvidence) -> str:
    """What the run that shows a finding says of it, and the run."""
    end = duration(evidence.run.states[-1].time, network.time_unit)
    steps = len(evidence.run.steps)
    run = f"this run of {steps} {'step' if steps == 1 else 'steps'}"
    loops = evidence.run.loop_start is not None
    how = f"shown by {run}, which goes on for ever" if loops else f"reached by {run}, at time {end}"
    out = StringIO()
    console = ReportConsole(file=out, highlight=False, soft_wrap=True, force_jupyter=False)
    print_trace(view_trace(network, evidence.run), console, network.time_unit, RunDisplay(ends=_ENDS))
    return f"{evidence.finding.code} at {evidence.finding.span} is {how}:\n{out.getvalue()}".rstrip("\n")


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class DeepCheckReport(DeepCheck):
    """What the states of a model show, in the forms in which people and programs read it.

    Attributes:
        network: of the model, for the runs that show findings.
    """

    network: Network = field(repr=False)

    @staticmethod
    def of(check: DeepCheck, network: Network) -> DeepCheckReport:
        """A check with its model."""
        return DeepCheckReport(**{each.name: getattr(check, each.name) for each in fields(DeepCheck)}, network=network)

    def to_dict(self) -> dict[str, Any]:
        """As docs/schema/check.schema.json describes ``deep``."""
        return deep_to_json(self.network, self)

    def to_rows(self) -> list[dict[str, str | int]]:
        """A row for each question."""
        return [
            {
                "question": part.question,
                "answer": part.answer,
                "undecided": part.undecided,
                "findings": len(part.findings),
            }
            for part in self.parts
        ]

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        return data_frame(self.to_rows())

    def to_text(self) -> str:
        """The answers with the runs that show findings, as `tachk check --deep` prints them."""
        out = StringIO()
        print_deep_check(self.network, self, out)
        return out.getvalue()

    def _repr_html_(self) -> str:
        table = html_table(
            ["question", "answer"], [(part.question, part.in_words) for part in self.parts], self._extent
        )
        runs = {id(each.finding): _run_text(self.network, each) for each in self.evidence}
        findings = [
            folded(f"{each.code}: {each.message}", "\n\n".join(filter(None, (render(each), runs.get(id(each))))))
            for each in self.findings
        ]
        return "\n".join([table, *findings])

    @property
    def _extent(self) -> str:
        states = grouped(self.statistics.states_stored)
        return f"{states} states, then {self.reason}" if self.reason else f"all {states} states"


def deep_to_json(network: Network, check: DeepCheck) -> dict[str, Any]:
    """As docs/schema/check.schema.json describes it; the trace of a finding is of the form of `tachk verify`."""
    runs = {id(evidence.finding): evidence.run for evidence in check.evidence}
    plain = PlainData()

    def finding(found: Diagnostic) -> dict[str, Any]:
        run = runs.get(id(found))
        return {**plain.of(found), "trace": None if run is None else trace_to_json(view_trace(network, run))}

    answer = Fields("question answer undecided findings")
    whole = Fields("complete reason stats=statistics questions=parts", complete=lambda check: not check.reason)
    return PlainData({**FORMS, type(check): whole, LintAnswer: answer, Diagnostic: finding}).of(check)
