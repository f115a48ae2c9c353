"""Questions about a model: properties by their names and the queries of texts, or everything that it states."""

from __future__ import annotations

from collections.abc import Iterable

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.base.diagnostics.suggestion import closest
from tachk.base.records import dataclass, replace
from tachk.base.span import Source
from tachk.frontend.loaded import LoadedModel, elaborate_query_file
from tachk.frontend.queries.queries import UncheckedQuery
from tachk.model.query import Query


@dataclass(frozen=True, slots=True)
class Questions:
    """Attributes:
    path: what messages call the model.
    names: of properties of the model.
    files: of queries, each with its optional expectation.
    typed: queries. Nothing in them may be wrong, while a wrong query of a file is one that is not checked.
    non_zeno: a run with infinitely many transitions counts only if time diverges in it.
    statistical: the names may be those of statistical queries.
    """

    path: str
    names: tuple[str, ...] = ()
    files: tuple[Source, ...] = ()
    typed: tuple[Source, ...] = ()
    non_zeno: bool = False
    statistical: bool = False

    def about(self, model: LoadedModel) -> tuple[Query | UncheckedQuery, ...]:
        """The questions in order: the named properties and the queries of the texts, else all of the model.

        Raises:
            InputError: one that was typed or named is wrong.
            UsageError: there is no property of that name, or no query in what was typed.
        """
        chosen = self._chosen(model)
        if not self.non_zeno:
            return chosen
        return tuple(replace(query, non_zeno=True) if isinstance(query, Query) else query for query in chosen)

    def _chosen(self, model: LoadedModel) -> tuple[Query | UncheckedQuery, ...]:
        if not self.names and not self.typed and not self.files:
            return model.formulas
        given = self._given(model)
        return (*(self._property(model, name) for name in self.names), *given)

    def _given(self, model: LoadedModel) -> tuple[Query | UncheckedQuery, ...]:
        """The queries of several texts, numbered through in their order whether they are checked or not."""
        formulas: list[Query | UncheckedQuery] = []
        diagnostics: list[Diagnostic] = []
        for source, typed in [(file, False) for file in self.files] + [(source, True) for source in self.typed]:
            found, others = elaborate_query_file(model, source, len(formulas) + 1)
            if typed and not found and not others:
                raise UsageError(f"{source.text!r} is not a query", "such as 'E<> P.location' or 'A[] not deadlock'")
            formulas += sorted((*found, *others), key=lambda formula: formula.span.start)
            if typed:
                diagnostics += (finding for query in others if query.is_wrong for finding in query.diagnostics)
        if diagnostics:
            raise InputError(diagnostics)
        return tuple(formulas)

    def _property(self, model: LoadedModel, name: str) -> Query | UncheckedQuery:
        for query in model.queries:
            if query.name == name:
                return query
        for unchecked in model.unchecked:
            if unchecked.name == name:
                if unchecked.diagnostics:
                    raise InputError(unchecked.diagnostics)
                if self.statistical and unchecked.family == "statistical":
                    return unchecked
                raise UsageError(f"{self.path}: {name} is not checked: {why_not(unchecked)}")
        names = [query.name for query in model.queries]
        close = closest(name, names)
        raise UsageError(
            f"{self.path} has no property {name!r}",
            f"did you mean `{close}`?" if close else f"it has: {', '.join(names) or 'none'}",
        )


def checked(formulas: Iterable[Query | UncheckedQuery]) -> tuple[Query, ...]:
    """The queries of the kinds that tachk checks."""
    return tuple(formula for formula in formulas if isinstance(formula, Query))


def why_not(query: UncheckedQuery) -> str:
    """The reason why a query is not checked."""
    if query.diagnostics:
        return query.diagnostics[0].message
    return f"{query.family} query" + (": see `tachk estimate`" if query.family == "statistical" else "")
