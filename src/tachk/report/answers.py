"""The answers of one run, for Python: a sequence of verdicts that can be written in every form."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from io import StringIO
from typing import TYPE_CHECKING, Any, overload

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import unknown_key
from tachk.base.records import dataclass
from tachk.report.record import RunRecord
from tachk.verify.verdict import Verdict

if TYPE_CHECKING:
    from tachk.report.json_report import Json
    from tachk.report.page.content import Page
    from tachk.report.run.evidence_run import Run
    from tachk.simulation.statistics.answers import StatisticalAnswer


@dataclass(frozen=True, slots=True)
class Report(Sequence[Verdict]):
    """The verdicts of one run, in the order of the queries; ``report["name"]`` finds one by name."""

    record: RunRecord

    @overload
    def __getitem__(self, index: int | str) -> Verdict: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Verdict, ...]: ...
    def __getitem__(self, index: int | str | slice) -> Verdict | tuple[Verdict, ...]:
        if isinstance(index, str):
            for verdict in self.record.verdicts:
                if verdict.query.name == index:
                    return verdict
            if index in self.estimates:
                raise KeyError(f"{index} is a statistical query: report.estimates[{index!r}] is its answer")
            for query in self.record.not_checked:
                if query.name == index:
                    raise KeyError(f"{index} is not checked: {query.reason}")
            raise unknown_key(index, (verdict.query.name for verdict in self.record.verdicts))
        return self.record.verdicts[index]

    def __bool__(self) -> bool:
        raise TypeError("a report has several answers: ask `report.met`, or the answer of one, report['name'].answer")

    def __len__(self) -> int:
        return len(self.record.verdicts)

    @property
    def estimates(self) -> Mapping[str, StatisticalAnswer]:
        """The answers to statistical queries, by the names of the queries."""
        return {answer.query.name: answer for answer in self.record.estimates}

    @property
    def met(self) -> bool | None:
        """True if every answer is as expected; False if one is not; else None, as one is unknown."""
        return self.record.met

    def run(self, index: int | str) -> Run | None:
        """The run that shows why an answer is as it is, None where there is none: it can be printed and looked at.

        Raises UsageError for a name or a number that no answer has.
        """
        from tachk.report.run.evidence_run import Run

        try:
            verdict = self[index]
        except (IndexError, KeyError) as error:
            message = f"there is no answer number {index}" if isinstance(error, IndexError) else error.args[0]
            names = (f"{number}: {verdict.query.name}" for number, verdict in enumerate(self.record.verdicts))
            raise UsageError(message, f"the answers are {', '.join(names) or 'none'}") from None
        return None if verdict.trace is None else Run(self.record.network, verdict)

    def to_dict(self) -> dict[str, Json]:
        """The run as docs/schema/verify.schema.json describes it."""
        from tachk.report.json_report import run_to_json

        return run_to_json(self.record)

    def to_rows(self) -> list[dict[str, str | int | float | bool | None]]:
        """One flat dictionary for each answer, with the model's constants: what `pandas.DataFrame` takes."""
        from tachk.report.extreme_text import value_lines

        constants = dict(self.record.network.constants)
        rows: list[dict[str, str | int | float | bool | None]] = [
            {
                "model": self.record.model,
                **constants,
                "property": verdict.query.name,
                "answer": verdict.answer.value,
                "values": "; ".join(value_lines(verdict, self.record.network.time_unit)) or None,
                "met": verdict.met,
                "states_stored": verdict.statistics.states_stored,
                "states_explored": verdict.statistics.states_explored,
                "transitions": verdict.statistics.transitions,
                "seconds": verdict.statistics.seconds,
                "peak_bytes": verdict.statistics.peak_bytes,
            }
            for verdict in self.record.verdicts
        ]
        rows += (
            {
                "model": self.record.model,
                **constants,
                "property": answer.query.name,
                "answer": _short(answer),
                "met": answer.met,
                "seconds": answer.seconds,
            }
            for answer in self.record.estimates
        )
        return rows

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        from tachk.base.frames import data_frame

        return data_frame(self.to_rows())

    def to_text(self, every_trace: bool = False, clocks: bool = False) -> str:
        """The output of `tachk verify`."""
        from tachk.report.plain_console import plain_console
        from tachk.report.run.display import RunDisplay
        from tachk.report.text_report import print_run

        out = StringIO()
        print_run(self.record, plain_console(out), every_trace, RunDisplay(clocks))
        return out.getvalue()

    def to_page(self, title: str | None = None) -> str:
        """One HTML file with the answers, their runs and the automata, as `tachk report` writes it."""
        from tachk.report.page.html import page_to_html

        return page_to_html(self._page(title))

    def widget(self, title: str | None = None) -> Any:
        """The same for a notebook: an `anywidget.AnyWidget`. Raises UsageError where anywidget is not installed."""
        from tachk.report.page.html import page_to_widget

        return page_to_widget(self._page(title))

    def _page(self, title: str | None) -> Page:
        from tachk.report.page.answers import answers_of
        from tachk.report.page.content import Page

        return Page(title or self.record.model, (answers_of(self.record),))

    def __str__(self) -> str:
        return self.to_text()

    def __repr__(self) -> str:
        from tachk.report.extreme_text import answer_text

        unit = self.record.network.time_unit
        answers = [f"{verdict.query.name}: {answer_text(verdict, unit)}" for verdict in self.record.verdicts]
        answers += [f"{answer.query.name}: {_short(answer)}" for answer in self.record.estimates]
        answers += [f"{query.name}: not checked" for query in self.record.not_checked]
        return f"<Report on {self.record.model}: {', '.join(answers) or 'nothing checked'}>"

    def _repr_html_(self) -> str:
        from tachk.report.html_report import run_to_html

        return run_to_html(self.record)


def _short(answer: StatisticalAnswer) -> str:
    from tachk.report.statistics.answered import short_answer
    from tachk.report.statistics.json import answered_document

    return short_answer(answered_document(answer)["found"])
