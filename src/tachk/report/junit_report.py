"""JUnit XML, the form in which build servers take test results."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from xml.etree import ElementTree

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.diagnostics.render import render
from tachk.report.extreme_text import value_lines
from tachk.report.record import NotRead, RunRecord
from tachk.report.run_formats import ReportWriter
from tachk.report.text_report import recorded_run
from tachk.verify.verdict import Answer, Verdict

_NUMBERED = re.compile(r"q\d+")
"""The names of queries that have no name of their own."""

_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


class JunitReport(ReportWriter):
    """Writes all at the end."""

    def finish(self, records: Sequence[RunRecord | NotRead]) -> None:
        self.out.write(runs_to_junit(records))


def runs_to_junit(records: Iterable[RunRecord | NotRead]) -> str:
    """One suite for each model, one case for each query.

    An answer that is not the expected one is a failure; an unknown answer, a wrong query and one that is refused are
    errors; a formula of another kind of analysis is skipped. A model that cannot be read is a case that is an error.
    """
    suites = ElementTree.Element("testsuites")
    for record in records:
        if isinstance(record, NotRead):
            _suite_of_nothing(suites, record)
        else:
            _suite(suites, record)
    ElementTree.indent(suites)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(suites, encoding="unicode") + "\n"


def _suite(parent: ElementTree.Element, record: RunRecord) -> None:
    met = [*(verdict.met for verdict in record.verdicts), *(answer.met for answer in record.estimates)]
    wrong = [query for query in record.not_checked if query.diagnostics]
    searches = {verdict.statistics for verdict in record.verdicts}  # several queries may share a search
    suite = ElementTree.SubElement(
        parent,
        "testsuite",
        name=clean(record.model),
        tests=str(len(met) + len(record.not_checked)),
        failures=str(met.count(False)),
        errors=str(met.count(None) + len(wrong)),
        skipped=str(len(record.not_checked) - len(wrong)),
        time=f"{sum(s.seconds for s in searches) + sum(answer.seconds for answer in record.estimates):.3f}",
    )
    for verdict in record.verdicts:
        name = _name(verdict.query.name, verdict.query.title)
        case = _case(suite, record.model, name, f"{verdict.statistics.seconds:.3f}")
        wanted = verdict.query.expectation.value if verdict.query.expectation else "holds"
        if verdict.unsupported is not None:
            _result(case, "error", f"cannot be checked: {verdict.reason}", _rendered([verdict.unsupported]))
        elif verdict.answer is Answer.UNKNOWN:
            _result(case, "error", f"unknown: {verdict.reason}", _details(record, verdict))
        elif verdict.met is False:
            said = f"{verdict.answer.value}, expected {wanted}"
            if record.leaves_the_model(verdict):
                said = f"differs from what the model expects of other constants: {said}"
            _result(case, "failure", said, _details(record, verdict))
        words = [*value_lines(verdict, record.network.time_unit), *verdict.notes]
        if words:
            ElementTree.SubElement(case, "system-out").text = clean("\n".join(words))
    if record.estimates:
        _estimates(suite, record)
    for query in record.not_checked:
        case = _case(suite, record.model, _name(query.name, query.title), "0.000")
        if query.diagnostics:
            _result(case, "error", f"cannot be checked: {query.reason}", _rendered(query.diagnostics))
        else:
            _result(case, "skipped", query.reason, "")


def _estimates(suite: ElementTree.Element, record: RunRecord) -> None:
    """A case for each statistical query."""
    from tachk.report.statistics.answered import answered_lines

    for answer in record.estimates:
        name = _name(answer.query.name, answer.query.title)
        case = _case(suite, record.model, name, f"{answer.seconds:.3f}")
        first, *others = answered_lines(answer)
        if answer.met is None:
            _result(case, "error", f"unknown: {answer.reason or 'no decision'}", "\n".join(others))
        elif answer.met is False:
            _result(case, "failure", first, "\n".join(others))
        ElementTree.SubElement(case, "system-out").text = clean("\n".join((first, *others)))


def _suite_of_nothing(parent: ElementTree.Element, record: NotRead) -> None:
    name = record.model or "tachk verify"
    counts = {"tests": "1", "failures": "0", "errors": "1", "skipped": "0", "time": "0.000"}
    suite = ElementTree.SubElement(parent, "testsuite", {"name": clean(name)} | counts)
    message = f"{record.message} ({record.help})" if record.help else record.message
    _result(_case(suite, name, name, "0.000"), "error", message, _rendered(record.diagnostics))


def _name(name: str, title: str) -> str:
    return f"{name}: {' '.join(title.split())}" if title and _NUMBERED.fullmatch(name) else name


def _rendered(diagnostics: Iterable[Diagnostic]) -> str:
    return "\n".join(map(render, diagnostics))


def _case(suite: ElementTree.Element, model: str, name: str, time: str) -> ElementTree.Element:
    return ElementTree.SubElement(suite, "testcase", classname=clean(model), name=clean(name), time=time)


def _result(case: ElementTree.Element, kind: str, message: str, details: str) -> None:
    element = ElementTree.SubElement(case, kind, message=clean(message))
    if kind != "skipped":
        element.set("type", kind)
    element.text = clean(details) or None


def _details(record: RunRecord, verdict: Verdict) -> str:
    return f"{verdict.query.text}\n{recorded_run(record, verdict)}"


def clean(text: str) -> str:
    """The text without the characters that XML 1.0 cannot hold."""
    return _NOT_IN_XML.sub("�", text)
