"""Estimates by random runs, for scripts: `tachk.Model` has these methods."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, overload

from tachk.base.arguments import checked_arguments
from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.base.diagnostics.suggestion import unknown_key
from tachk.base.records import dataclass, field, replace
from tachk.base.seeds import DEFAULT_SEED
from tachk.frontend.queries.queries import UncheckedQuery
from tachk.model.query import Query

if TYPE_CHECKING:
    from tachk.engine.options import Limits, Options
    from tachk.frontend.loaded import LoadedModel
    from tachk.simulation.statistics.answers import StatisticalAnswer
    from tachk.simulation.statistics.estimate import Estimate, Settings
    from tachk.verify.questions import Questions


@dataclass(frozen=True, slots=True)
class Estimates(Sequence["Estimate"]):
    """Answers to statistical queries, in the order of the queries; also by the name of a query.

    Attributes:
        model: its name in reports.
    """

    model: str
    answers: tuple[Estimate, ...]
    settings: Settings = field(repr=False)

    @overload
    def __getitem__(self, index: int | str) -> Estimate: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Estimate]: ...
    def __getitem__(self, index: int | str | slice) -> Estimate | Sequence[Estimate]:
        """Raises KeyError for a name, and IndexError for a number, that there is not."""
        if not isinstance(index, str):
            return self.answers[index]
        for answer in self.answers:
            if answer.query.name == index:
                return answer
        raise unknown_key(index, (answer.query.name for answer in self.answers))

    def __len__(self) -> int:
        return len(self.answers)

    def __iter__(self) -> Iterator[Estimate]:
        return iter(self.answers)

    def to_dict(self) -> dict[str, Any]:
        """As `tachk estimate --format json` writes it."""
        from tachk.report.statistics.json import estimates_document

        return estimates_document(self.model, self.answers, self.settings)

    def to_rows(self) -> list[dict[str, str | int | float | None]]:
        """A row for each query: ``low`` and ``high`` contain the probability or the mean with the confidence."""
        from tachk.report.statistics.answered import short_answer

        return [
            {
                "model": self.model,
                "query": answer["name"],
                "formula": answer["query"],
                "kind": answer["kind"],
                "answer": short_answer(answer),
                "low": answer.get("low"),
                "high": answer.get("high"),
                "estimate": answer.get("frequency", answer.get("mean")),
                "confidence": self.settings.confidence,
                "runs": sum(sample["runs"] for sample in answer.get("samples", ())) or None,
            }
            for answer in self.to_dict()["answers"]
        ]

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        from tachk.base.frames import data_frame

        return data_frame(self.to_rows())

    def to_text(self) -> str:
        """As `tachk estimate` prints it."""
        from tachk.report.statistics.text import answer_lines

        return "".join(f"{line}\n" for each in self.answers for line in answer_lines(each, self.settings))

    def __str__(self) -> str:
        return self.to_text()

    def __repr__(self) -> str:
        from tachk.report.statistics.answered import short_answer

        answers = (f"{each['name']}: {short_answer(each)}" for each in self.to_dict()["answers"])
        return f"<Estimates of {self.model}: {', '.join(answers)}>"

    def _repr_html_(self) -> str:
        from tachk.base.notebook import folded, html_table

        columns = ("query", "formula", "answer", "confidence", "runs")
        rows = [[row[name] for name in columns] for row in self.to_rows()]
        return f"{html_table(columns, rows, self.model)}\n{folded('in words', self.to_text())}"


class Estimable:
    """A model with statistical queries: probabilities and means.

    Attributes:
        path: where it was read from, or what reports call it.
    """

    path: str
    loaded: LoadedModel

    @checked_arguments
    def estimate(
        self,
        *queries: str,
        confidence: float = 0.95,
        epsilon: float = 0.05,
        runs: int | None = None,
        seed: int = DEFAULT_SEED,
        threads: int = 1,
        max_steps: int | None = None,
        fault: str | Iterable[str] = (),
    ) -> Estimates:
        """Answers statistical queries by random runs: docs/statistics.md says how certain an answer is.

        Args:
            queries: such as ``"Pr[<=100](<> P.a)"``; none: those of the model.
            epsilon: half the width of the intervals of probabilities.
            runs: how many are drawn; None: as many as it takes.
            seed: the same seed gives the same answers, with any number of threads.
            max_steps: a run with more transitions is given up and counts as unknown.
            fault: faults to inject, such as ``"lost=0.01"``, see docs/faults.md.

        Raises:
            InputError: a query is wrong.
            UsageError: there is no statistical query, or an argument has no meaning.
            UnsupportedError: something cannot be simulated.
        """
        from tachk.simulation.fault_injection import read_plan, with_faults
        from tachk.simulation.simulated import simulated
        from tachk.simulation.statistics.estimate import Settings, estimate
        from tachk.simulation.statistics.sampling import RunSource

        if not 0 < confidence < 1 or not 0 < epsilon <= 0.5 or threads < 1 or (runs is not None and runs < 1):
            raise UsageError("confidence is between 0 and 1, epsilon at most 0.5, runs and threads at least 1")
        loaded = simulated(self.loaded, self.path)
        plan = read_plan([fault] if isinstance(fault, str) else list(fault))
        settings = Settings(RunSource(seed, 0, threads, max_steps), confidence, epsilon, runs)
        chosen = list(_chosen_queries(loaded, queries))
        if not chosen:
            raise UsageError(f"{self.path}: there is no statistical query", "such as 'Pr[<=100](<> P.location)'")
        found = [
            estimate(with_faults(query.network or loaded.network, plan).network, query, settings) for query in chosen
        ]
        return Estimates(self.path, tuple(found), settings)


def share_of_searches(limits: Limits, formulas: Sequence[Query | UncheckedQuery]) -> Limits:
    """The limits with the seconds that searches may take, so that the same share is left for each statistical query."""
    searched = sum(isinstance(formula, Query) for formula in formulas)
    drawn = sum(formula.family == "statistical" for formula in formulas if isinstance(formula, UncheckedQuery))
    if limits.seconds is None or not drawn:
        return limits
    return replace(limits, seconds=limits.seconds * searched / (searched + drawn))


def answers_among(
    loaded: LoadedModel,
    questions: Questions,
    formulas: Sequence[Query | UncheckedQuery],
    options: Options,
    limits: Limits,
) -> dict[int, StatisticalAnswer | UncheckedQuery]:
    """The answers of the statistical queries among those of a verification; as `answer_statistical`.

    Args:
        questions: the questions about the model, from which the formulas come.
        options: of the verification; its seed is that of the runs.

    Raises InputError where a query that was typed is wrong.
    """
    from tachk.frontend.queries.queries import is_statistical

    if not any(map(is_statistical, formulas)):
        return {}
    from tachk.simulation.simulated import simulated
    from tachk.simulation.statistics.answers import answer_statistical
    from tachk.simulation.statistics.estimate import Settings
    from tachk.simulation.statistics.sampling import RunSource

    settings = Settings(RunSource(options.seed))
    found = answer_statistical(lambda: simulated(loaded, questions.path), formulas, settings, limits)
    for number, formula in enumerate(formulas, 1):
        query = found.get(number)
        typed = formula.span.in_file.source in questions.typed
        if typed and isinstance(query, UncheckedQuery) and query.is_wrong:
            raise InputError(query.diagnostics)
    return found


def _chosen_queries(loaded: LoadedModel, queries: tuple[str, ...]) -> Iterator[Any]:
    from tachk.base.span import Source
    from tachk.frontend.queries.queries import is_statistical
    from tachk.frontend.queries.statistical import StatisticalReader
    from tachk.verify.questions import Questions

    typed = tuple(Source("<query>", text) for text in queries)
    formulas = Questions("", (), (), typed).about(loaded) if queries else loaded.formulas
    reader = StatisticalReader(loaded)
    for query in formulas:
        if is_statistical(query):
            yield reader.read(query)
