"""What is asked about each cell: verification of properties."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import field
from hashlib import sha256
from time import monotonic

from tachk.campaign.grid import Values
from tachk.diagnostics.diagnostic import InputError, Severity, UnsupportedError, UsageError
from tachk.engines.options import Limits, Options
from tachk.engines.outcome import TIME_LIMIT
from tachk.frontend.findings import Findings
from tachk.frontend.loaded import LoadedModel, with_constants
from tachk.frontend.overrides import constant_overrides
from tachk.properties.answering import answers
from tachk.properties.fault_explanation import diagnostic_of
from tachk.properties.questions import Questions, checked
from tachk.properties.verdict import Answer, Verdict
from tachk.records import dataclass
from tachk.time_limit import OutOfTimeError, time_limit

Row = Mapping[str, str | int | float | None]
"""One line of the table: the name of a column and what stands in it."""

KILLED = "the process that computed it was killed"

COLUMNS: Mapping[str, str] = {
    "property": "TEXT",
    "answer": "TEXT",
    "reason": "TEXT",
    "notes": "TEXT",
    "lower": "INTEGER",
    "upper": "INTEGER",
    "states_explored": "INTEGER",
    "states_stored": "INTEGER",
    "transitions": "INTEGER",
    "peak_bytes": "INTEGER",
    "seconds": "REAL",
    "run_steps": "INTEGER",
    "run_end": "REAL",
}
"""What a row tells, with SQLite's types.

``lower`` and ``upper`` are what ``inf``, ``sup`` and ``bounds`` find for their first expression, None where there is no
limit. ``seconds`` are those of the search that answered, which properties share. ``run_steps`` and ``run_end`` (in time
units of the model) are of the run behind the answer, where there is one.
"""


@dataclass(frozen=True, slots=True)
class Verification:
    """The properties of a model, checked for each cell.

    Attributes:
        names: of the constants that vary.
        asked: the names of the properties, in order.
        limits: of each cell.
    """

    model: LoadedModel
    names: tuple[str, ...]
    questions: Questions
    asked: tuple[str, ...]
    options: Options = field(default_factory=Options)
    limits: Limits = field(default_factory=Limits)

    def parts(self) -> dict[str, str]:
        """What must be the same for finished cells to count: names as a user would say them, each with its value."""
        texts = {item.span.source.text for item in self.model.items} | {self.model.document.span.source.text}
        text = sha256("\0".join(sorted(texts)).encode()).hexdigest()
        typed = [source.text.strip() for source in self.questions.typed]
        return {
            "constants": ", ".join(self.names),
            "text of the model": text,
            "queries": ", ".join((*self.questions.names, *typed)) or "all properties of the model",
            "--non-zeno": str(self.questions.non_zeno).lower(),
            "--cell-seconds": str(self.limits.seconds),
            "--max-states": str(self.limits.states),
            "--max-memory": str(self.limits.memory_bytes),
        }

    def rows(self, values: Values) -> tuple[Row, ...]:
        """One row for each property. What is wrong, refused or out of time is unknown, with the reason."""
        try:
            verdicts = self._verdicts(values)
        except OutOfTimeError:
            return unknown_rows(self.asked, TIME_LIMIT)
        except InputError as error:
            first = next(found for found in error.diagnostics if found.severity is Severity.ERROR)
            return unknown_rows(self.asked, f"wrong model: {first.message}")
        except UnsupportedError as error:
            return unknown_rows(self.asked, str(error))
        return tuple(_row(verdict) for verdict in verdicts)

    def _verdicts(self, values: Values) -> tuple[Verdict, ...]:
        began = monotonic()
        with time_limit(self.limits.seconds):
            model = with_constants(self.model, dict(zip(self.names, values, strict=True)), self.asked)
            queries = checked(self.questions.about(model))
        limits = self.limits.after(monotonic() - began)
        return answers(model, self.questions, queries, self.options, limits, None, trace=True)


def verification(
    model: LoadedModel, names: tuple[str, ...], questions: Questions, options: Options, limits: Limits
) -> Verification:
    """The job of checking what is asked.

    Raises:
        InputError, UsageError: a query is wrong, there is no such property or constant, or nothing to check.
    """
    constant_overrides(dict.fromkeys(names, 0), model.items, Findings())
    asked = tuple(query.name for query in checked(questions.about(model)))
    if not asked:
        raise UsageError(f"{questions.path} has no property to check", "give a query behind the model")
    return Verification(model, names, questions, asked, options, limits)


@dataclass(frozen=True, slots=True)
class Computed:
    """What came of a cell, and how many seconds it took."""

    values: Values
    rows: tuple[Row, ...]
    seconds: float


def computed(job: Verification, values: Values) -> Computed:
    """What a process or a worker does with a cell."""
    began = monotonic()
    rows = job.rows(values)
    return Computed(values, rows, monotonic() - began)


def killed(job: Verification, values: Values) -> Computed:
    """What is known of a cell whose process or worker did not survive it."""
    return Computed(values, unknown_rows(job.asked, KILLED), 0.0)


def unknown_rows(names: Iterable[str], reason: str) -> tuple[Row, ...]:
    """The rows of properties that have no answer."""
    nothing = {**dict.fromkeys(COLUMNS), "answer": Answer.UNKNOWN.value, "reason": reason, "notes": ""}
    return tuple({**nothing, "property": name} for name in names)


def _row(verdict: Verdict) -> Row:
    statistics, run = verdict.statistics, verdict.trace
    reason = verdict.reason or ("" if verdict.unsupported is None else verdict.unsupported.message)
    if verdict.fault is not None:
        reason = f"{reason}: {diagnostic_of(verdict.fault).message}"
    least, largest = next(((found.least, found.largest) for found in verdict.extremes), (None, None))
    return {
        "property": verdict.query.name,
        "answer": verdict.answer.value,
        "reason": reason,
        "notes": "; ".join(verdict.notes),
        "lower": None if least is None else least.value,
        "upper": None if largest is None else largest.value,
        "states_explored": statistics.states_explored,
        "states_stored": statistics.states_stored,
        "transitions": statistics.transitions,
        "peak_bytes": statistics.peak_bytes,
        "seconds": statistics.seconds,
        "run_steps": None if run is None else len(run.path),
        "run_end": None if run is None else float(run.states[-1].time),
    }
