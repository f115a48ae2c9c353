"""Answers that are not as expected, as messages at the lines of their properties: SARIF, and GitHub's annotations."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence

from tachk.report.annotations import Annotation, annotated, in_a_file, to_github, to_sarif, with_help
from tachk.report.record import NotRead, RunRecord
from tachk.report.run_formats import ReportWriter
from tachk.report.text_report import TextReport, recorded_run
from tachk.verify.verdict import Answer


class SarifReport(ReportWriter):
    """Writes all at the end."""

    def finish(self, records: Sequence[RunRecord | NotRead]) -> None:
        self.out.write(json.dumps(to_sarif([*_annotations(records)], [*_complaints(records)]), indent=2) + "\n")


class GithubReport(TextReport):
    """Writes the report for people, then the annotations that GitHub shows at the lines of properties."""

    def finish(self, records: Sequence[RunRecord | NotRead]) -> None:
        super().finish(records)
        for line in to_github(_annotations(records), _complaints(records)):
            self.out.write(f"{line}\n")


def _complaints(records: Iterable[RunRecord | NotRead]) -> Iterator[str]:
    """What is wrong with models of which no place is known."""
    for record in records:
        if isinstance(record, NotRead) and not record.diagnostics:
            message = with_help(record.message, record.help)
            yield f"{record.model}: {message}" if record.model else message


def _annotations(records: Iterable[RunRecord | NotRead]) -> Iterator[Annotation]:
    for record in records:
        if isinstance(record, NotRead):
            yield from map(annotated, record.diagnostics)
        else:
            yield from _of_answers(record)


def _of_answers(record: RunRecord) -> Iterator[Annotation]:
    for verdict in record.verdicts:
        place = in_a_file(verdict.query.span)
        wanted = verdict.query.expectation.value if verdict.query.expectation else "holds"
        if verdict.unsupported is not None:
            yield annotated(verdict.unsupported)
        elif verdict.answer is Answer.UNKNOWN:
            message = f"{verdict.query.name} is unknown: {verdict.reason}"
            yield Annotation("warning", "unknown-answer", message, place)
        elif verdict.met is False:
            said = f"{verdict.query.name} {verdict.answer.value}, expected {wanted}"
            yield Annotation(
                "error",
                "unexpected-answer",
                "\n".join((said, *recorded_run(record, verdict).rstrip().splitlines())),
                place,
            )
    for answer in record.estimates:
        place = in_a_file(answer.query.span)
        if answer.met is None:
            message = f"{answer.query.name} is unknown: {answer.reason or 'no decision'}"
            yield Annotation("warning", "unknown-answer", message, place)
        elif answer.met is False:
            from tachk.report.statistics.answered import answered_lines

            yield Annotation("error", "unexpected-answer", "\n".join(answered_lines(answer)), place)
    for query in record.not_checked:
        yield from map(annotated, query.diagnostics)
