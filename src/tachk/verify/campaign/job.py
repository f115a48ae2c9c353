"""The job of each cell: verification of properties, and answers to statistical queries."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from hashlib import sha256
from time import monotonic
from typing import TYPE_CHECKING, assert_never

from tachk.base.diagnostics.diagnostic import InputError, Severity, UnsupportedError, UsageError
from tachk.base.job import StoppedError, limited
from tachk.base.records import dataclass, field, replace
from tachk.engine.options import Limits, Options
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.loaded import LoadedModel, with_constants, with_hybrid_clocks
from tachk.frontend.overrides import constant_overrides
from tachk.frontend.queries.queries import UncheckedQuery, is_statistical
from tachk.frontend.queries.statistical import StatisticalReader
from tachk.model.grid import Values
from tachk.model.query import Query
from tachk.simulation.intervals import clopper_pearson
from tachk.simulation.statistics.deciding import Decision
from tachk.simulation.statistics.estimate import (
    Decided,
    DrawnRuns,
    Estimate,
    Estimated,
    Mean,
    Settings,
    Split,
    estimate,
)
from tachk.verify.answering import answers
from tachk.verify.fault_explanation import diagnostic_of
from tachk.verify.questions import Questions, checked
from tachk.verify.verdict import Answer, Verdict

if TYPE_CHECKING:  # monitors take a third of the start of a sweep that has no formula
    from tachk.verify.campaign.evaluated_runs import EvaluatedRuns, FormulaCounts

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
    "estimate": "REAL",
    "low": "REAL",
    "high": "REAL",
    "runs": "INTEGER",
}
"""The columns of a row with SQLite's types.

``lower`` and ``upper`` are what ``inf``, ``sup`` and ``bounds`` find for their first expression, None where there is no
limit. ``seconds`` are those of the search that answered, which properties share. ``run_steps`` and ``run_end`` (in time
units of the model) are of the run behind the answer, where there is one. ``estimate``, ``low``, ``high`` and ``runs``
answer statistical queries: a frequency or mean, what contains the probability or mean with the confidence, and how many
runs were drawn.
"""

ESTIMATED = "estimated"
"""The answer to a statistical query that is a number."""


@dataclass(frozen=True, slots=True)
class Verification:
    """The properties of a model, checked for each cell.

    Attributes:
        names: of the constants that vary.
        property_names: the names of the properties, in order.
        limits: of each cell.
        formula_runs: random runs of each cell, and formulas to evaluate on them.
        frames: how deep Python may recurse. Chains of the model that have thousands of links have raised it where the
            model was read, not in the processes that get the model.
    """

    model: LoadedModel
    names: tuple[str, ...]
    questions: Questions
    property_names: tuple[str, ...]
    options: Options = field(default_factory=Options)
    limits: Limits = field(default_factory=Limits)
    settings: Settings = field(default_factory=Settings)
    formula_runs: EvaluatedRuns | None = None
    frames: int = field(default_factory=sys.getrecursionlimit)

    @property
    def asks_queries(self) -> bool:
        """True if there are queries or properties to check, or formulas only."""
        return self.formula_runs is None or len(self.property_names) > len(self.formula_runs.names)

    def parts(self) -> dict[str, str]:
        """The settings that finished cells must share with this job to count: a name for users, and its value."""
        texts = {item.span.source.text for item in self.model.items} | {self.model.document.span.source.text}
        text = sha256("\0".join(sorted(texts)).encode()).hexdigest()
        typed = [source.text.strip() for source in self.questions.typed]
        given = self.model.overrides.items()
        fixed = sorted(f"{name} = {value.span.text}" for name, value in given if name not in self.names)
        return {
            "constants": ", ".join(self.names),
            **({"values of other constants": ", ".join(fixed)} if fixed else {}),
            "text of the model": text,
            "queries": ", ".join((*self.questions.names, *typed)) or "all properties of the model",
            "--non-zeno": str(self.questions.non_zeno).lower(),
            "--cell-seconds": str(self.limits.seconds),
            "--max-states": str(self.limits.states),
            "--max-memory": str(self.limits.memory_bytes),
            "statistics": str(self.settings),
            **({} if self.formula_runs is None else {"--monitor": str(self.formula_runs)}),
        }

    def rows(self, values: Values) -> tuple[Row, ...]:
        """One row for each property. What is wrong, refused or out of time is unknown, with the reason."""
        try:
            return self._answers(values)
        except StoppedError as error:
            return unknown_rows(self.property_names, error.reason)
        except InputError as error:
            first = next(found for found in error.diagnostics if found.severity is Severity.ERROR)
            return unknown_rows(self.property_names, f"wrong model: {first.message}")
        except (UnsupportedError, UsageError) as error:
            return unknown_rows(self.property_names, str(error))

    def _answers(self, values: Values) -> tuple[Row, ...]:
        with limited(self.limits.seconds):
            with limited(memory=self.limits.memory_bytes):
                model = with_constants(self.model, dict(zip(self.names, values, strict=True)), self.property_names)
                formulas = self.questions.about(model) if self.asks_queries else ()
                rows = [*self._drawn(model, [query for query in formulas if is_statistical(query)])]
            queries = checked(formulas)
            if queries:
                alone = replace(self.options, processes=1)  # it is cells that are computed at the same time
                found = answers(model, self.questions, queries, alone, self.limits, trace=True)
                rows += map(_row, found)
            return tuple(sorted(rows, key=lambda row: self.property_names.index(str(row["property"]))))

    def _drawn(self, model: LoadedModel, statistical: Sequence[UncheckedQuery]) -> Iterator[Row]:
        """The answers of random runs, in the model as simulations see it."""
        if not statistical and self.formula_runs is None:
            return
        seen = with_hybrid_clocks(model, ())
        reader = StatisticalReader(seen)
        for query in statistical:
            property_names = reader.read(query)
            yield _estimated(estimate(property_names.network or seen.network, property_names, self.settings))
        if self.formula_runs is not None:
            chosen = {name: value for name, value in seen.network.constants if name in model.overrides}
            for counts in self.formula_runs.counts(seen.network, chosen):
                yield _formula_row(counts, self.settings.confidence)


def verification(
    model: LoadedModel,
    names: tuple[str, ...],
    questions: Questions,
    options: Options,
    limits: Limits,
    settings: Settings | None = None,
    formula_runs: EvaluatedRuns | None = None,
) -> Verification:
    """The job that checks the given queries and properties in each cell.

    Raises:
        InputError, UsageError: a query is wrong, there is no such property or constant, or nothing to check.
    """
    constant_overrides(dict.fromkeys(names, 0), model.items, DiagnosticCollector())
    named = formula_runs is None or bool(questions.names or questions.typed or questions.files)
    formulas = questions.about(model) if named else ()
    property_names = tuple(q.name for q in formulas if isinstance(q, Query) or is_statistical(q))
    property_names += () if formula_runs is None else formula_runs.names
    if not property_names:
        raise UsageError(f"{questions.path} has no property to check", "give a query behind the model")
    return Verification(model, names, questions, property_names, options, limits, settings or Settings(), formula_runs)


@dataclass(frozen=True, slots=True)
class ComputedCell:
    """The rows of a cell, and the seconds that it took."""

    values: Values
    rows: tuple[Row, ...]
    seconds: float


def computed(job: Verification, values: Values) -> ComputedCell:
    """The computation of a cell in a process or a worker."""
    began = monotonic()
    sys.setrecursionlimit(max(sys.getrecursionlimit(), job.frames))
    rows = job.rows(values)
    return ComputedCell(values, rows, monotonic() - began)


def killed(job: Verification, values: Values) -> ComputedCell:
    """The rows of a cell whose process or worker did not survive it."""
    return ComputedCell(values, unknown_rows(job.property_names, KILLED), 0.0)


def unknown_rows(names: Iterable[str], reason: str) -> tuple[Row, ...]:
    """The rows of properties that have no answer."""
    nothing = {**dict.fromkeys(COLUMNS), "answer": Answer.UNKNOWN.value, "reason": reason, "notes": ""}
    return tuple({**nothing, "property": name} for name in names)


def _formula_row(found: FormulaCounts, confidence: float) -> Row:
    """The row of a formula: how probable it is that a run satisfies it. A run that is undetermined may or may not."""
    runs = found.true + found.false + found.undetermined
    low, high = clopper_pearson(found.true, runs, confidence, maybe=found.undetermined)
    nothing: dict[str, str | int | float | None] = {**dict.fromkeys(COLUMNS), "reason": "", "notes": ""}
    known = {"estimate": found.true / runs, "low": low, "high": high, "runs": runs, "transitions": found.transitions}
    return {**nothing, "property": found.name, "answer": ESTIMATED, **known}


def _estimated(found: Estimate) -> Row:
    """The row of a statistical query."""
    nothing: dict[str, str | int | float | None] = {**dict.fromkeys(COLUMNS), "reason": "", "notes": ""}
    row = {**nothing, "property": found.query.name, "answer": ESTIMATED}
    match found:
        case Estimated():
            sample = found.sample
            row |= {"estimate": found.frequency, "low": found.low, "high": found.high}
        case Mean():
            sample = found.sample
            row |= {"estimate": found.mean, "low": found.low, "high": found.high}
        case Decided():
            sample = found.samples[0]
            row["estimate"] = found.frequencies[0]
            row["answer"] = found.decision.value
            if found.decision is Decision.UNKNOWN:
                row["reason"] = "no decision"
        case Split():
            rare = found.rare
            row |= {"estimate": rare.mean, "low": found.low, "high": found.high, "transitions": rare.transitions}
            return row
        case DrawnRuns():
            return {**row, "answer": Answer.UNKNOWN.value, "reason": "trajectories are not for sweeps"}
        case never:
            assert_never(never)
    return {**row, "runs": sample.runs, "transitions": sample.transitions}


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
        **dict.fromkeys(("estimate", "low", "high", "runs")),
    }
