"""The findings of `tachk check --deep`, as text and as JSON."""

from __future__ import annotations

from typing import Any, TextIO

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.plain_data import Fields, PlainData
from tachk.meaning.run_view import view_trace
from tachk.model.network import Network
from tachk.model.quantity import duration, grouped, seconds
from tachk.report.json_report import FORMS, trace_to_json
from tachk.report.plain_console import ReportConsole
from tachk.report.run.display import Ends, RunDisplay
from tachk.report.run.trace_text import print_trace
from tachk.verify.semantic_lint.findings import DeepCheck, LintAnswer

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
        end = duration(evidence.run.states[-1].time, network.time_unit)
        steps = len(evidence.run.steps)
        run = f"this run of {steps} {'step' if steps == 1 else 'steps'}"
        loops = evidence.run.loop_start is not None
        how = f"shown by {run}, which goes on for ever" if loops else f"reached by {run}, at time {end}"
        print(f"\n{evidence.finding.code} at {evidence.finding.span} is {how}:", file=out)
        console = ReportConsole(file=out, highlight=False, soft_wrap=True, force_jupyter=False)
        print_trace(view_trace(network, evidence.run), console, network.time_unit, RunDisplay(ends=_ENDS))


def deep_to_json(network: Network, check: DeepCheck) -> dict[str, Any]:
    """As docs/schema/check.schema.json describes it; the trace of a finding is of the form of `tachk verify`."""
    runs = {id(evidence.finding): evidence.run for evidence in check.evidence}
    plain = PlainData()

    def finding(found: Diagnostic) -> dict[str, Any]:
        run = runs.get(id(found))
        return {**plain.of(found), "trace": None if run is None else trace_to_json(view_trace(network, run))}

    answer = Fields("question answer undecided findings")
    whole = Fields("complete reason stats=statistics questions=parts", complete=lambda check: not check.reason)
    return PlainData({**FORMS, DeepCheck: whole, LintAnswer: answer, Diagnostic: finding}).of(check)
