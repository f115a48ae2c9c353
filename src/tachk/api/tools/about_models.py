"""The tools about models as they are written: check, verify and explain."""

from __future__ import annotations

from collections.abc import Mapping
from io import StringIO
from typing import Any

from tachk.api.checking import check_model
from tachk.api.tools.answer import Evidence, ToolAnswer, answer
from tachk.api.tools.evidence import evidence_of, replayed
from tachk.api.tools.inputs import model_source, read_model
from tachk.api.tools.limits import GRACE, ToolLimits
from tachk.base.diagnostics.diagnostic import InputError, Severity, UsageError
from tachk.base.diagnostics.explanation import CODE, all_explanations, message_text
from tachk.base.diagnostics.render import render
from tachk.base.job import unhurried
from tachk.base.records import replace
from tachk.recordings.monitors.formulas import NamedFormula, read_formulas
from tachk.report.check_report import Checked, checks_to_json
from tachk.report.deep_report import print_deep_check
from tachk.report.formula_lines import formula_lines
from tachk.report.json_report import run_to_json
from tachk.report.record import RunRecord

_LONGEST_RUN = 200
"""Steps of a run that an answer contains unless a call asks for all."""


def check(arguments: Mapping[str, Any], limits: ToolLimits) -> ToolAnswer:
    """Every mistake and warning of a model; with ``deep`` also what no run of it does."""
    found, model = check_model(model_source(arguments["model"]), arguments.get("constants", {}))
    if found.complaint is not None:
        raise UsageError(found.complaint, found.help)
    evidence: list[Evidence] = []
    deep = ""
    if arguments.get("deep", False) and model is not None:
        try:
            result = model.check(limits.before_evidence())
        except InputError as error:
            found = replace(found, findings=(*error.diagnostics, *found.findings), size=None)
        else:
            found = replace(found, deep=result, network=model.network)
            out = StringIO()
            with unhurried(GRACE):
                print_deep_check(model.network, result, out)
            deep = out.getvalue()
            evidence = [replayed(model.network, each.finding.code, each.run) for each in result.evidence]
    with unhurried(GRACE):
        (written,) = checks_to_json([found])["models"]
    text = "\n".join(render(each) for each in found.everything)
    return answer(_check_summary(found), written, f"{text}\n\n{deep}".strip("\n"), evidence, limits)


def _check_summary(found: Checked) -> str:
    errors = sum(each.severity is Severity.ERROR for each in found.everything)
    warnings = len(found.everything) - errors
    counts = f"{_count(errors, 'error')}, {_count(warnings, 'warning')}"
    if found.size is None:
        return f"{found.model} cannot be used: {counts}"
    size = found.size
    parts = (
        _count(size.processes, "process", "processes"),
        _count(size.locations, "location"),
        _count(size.edges, "edge"),
        _count(size.properties, "property", "properties"),
    )
    return f"{found.model}: {', '.join(parts)}, {counts}"


def _count(number: int, one: str, many: str = "") -> str:
    return f"{number} {one if number == 1 else many or f'{one}s'}"


def verify(arguments: Mapping[str, Any], limits: ToolLimits) -> ToolAnswer:
    """The answers about properties or queries, with the runs that show them."""
    shown = arguments.get("runs", "unexpected")
    model = read_model(arguments)
    report = model.verify(
        *arguments.get("queries", ()),
        property=tuple(arguments.get("properties", ())),
        limits=limits.before_evidence(),
    )
    evidence = list(evidence_of(report.record, arguments.get("certificates", "auto"), limits.of_search()))
    with unhurried(GRACE):
        left_out, record = _without_long_runs(report.record, shown)
        warnings = [render(each) for each in (*model.refusals, *model.warnings)]
        summary = repr(report).removeprefix("<Report on ").removesuffix(">")
        text = _text(record, shown == "all")
        return answer(summary, run_to_json(record), text, evidence, limits, (*warnings, *left_out))


def _without_long_runs(record: RunRecord, shown: str) -> tuple[list[str], RunRecord]:
    """The record with the runs that an answer contains, and what is said of others."""
    if shown == "all":
        return [], record
    verdicts, notes = [], []
    for verdict in record.verdicts:
        run = verdict.trace
        if run is not None and (shown == "none" or verdict.met is True or len(run.steps) > _LONGEST_RUN):
            name, steps = verdict.query.name, len(run.steps)
            notes.append(f"the run of {steps} steps about {name} is left out; properties and runs='all' show it")
            verdict = replace(verdict, trace=None)
        verdicts.append(verdict)
    return notes, replace(record, verdicts=tuple(verdicts))


def _text(record: RunRecord, every_trace: bool) -> str:
    from tachk.report.answers import Report

    return Report(record).to_text(every_trace)


def explain(arguments: Mapping[str, Any], limits: ToolLimits) -> ToolAnswer:
    """What the code of a message means, or what a formula or a sentence says."""
    what = arguments["what"]
    if CODE.fullmatch(what):
        text = message_text(what)
        explanation = all_explanations()[what.upper()]
        result = {
            "kind": "message",
            "code": what.upper(),
            "title": explanation.title,
            "why": explanation.why,
            "wrong": explanation.bad,
            "right": explanation.good,
        }
        return answer(f"{what.upper()}: {explanation.title}", result, text, (), limits)
    formulas = read_formulas(what)
    texts = [(named, formula_lines(named)) for named in formulas]
    result = {"kind": "formulas", "formulas": [_formula(named, lines) for named, lines in texts]}
    text = "\n\n".join("\n".join(([named.name] if len(texts) > 1 else []) + lines) for named, lines in texts)
    return answer(f"{_count(len(formulas), 'formula')}: {formulas[0].text}", result, text, (), limits)


def _formula(named: NamedFormula, lines: list[str]) -> dict[str, Any]:
    parts = dict(line.split(None, 1) for line in lines)
    return {
        "name": named.name,
        "formula": named.text,
        "sentence": named.sentence or None,
        "columns": sorted(named.columns),
        "horizon": parts["look-ahead"],
        "observer": parts.get("observer"),
    }
