"""The diagnostics found so far."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager

from tachk.base.diagnostics.diagnostic import Diagnostic, Label, Severity, by_place
from tachk.base.span import Span


class DiagnosticCollector:
    """Collects diagnostics. One place of the text gets each code at most once, however often it is elaborated
    (a template is, once for each of its instances)."""

    def __init__(self) -> None:
        self._found: dict[tuple[str, int, int, int], Diagnostic] = {}
        self._ignored: frozenset[str] = frozenset()
        self._sources: list[object] = []

    def add(self, code: str, span: Span, message: str, help: str | None = None, labels: tuple[Label, ...] = ()) -> None:
        self.extend([Diagnostic(code, message, span, help, labels)])

    def extend(self, diagnostics: Iterable[Diagnostic]) -> None:
        for diagnostic in diagnostics:
            if diagnostic.code in self._ignored:
                continue
            span = diagnostic.span
            self._sources.append(span.source)  # keeps the source alive, so that its id stays its own
            self._found.setdefault((diagnostic.code, id(span.source), span.start, span.end), diagnostic)

    @contextmanager
    def without(self, codes: frozenset[str]) -> Iterator[None]:
        """Drops findings with these codes inside the ``with`` block."""
        before = self._ignored
        self._ignored = before | codes
        try:
            yield
        finally:
            self._ignored = before

    @property
    def has_errors(self) -> bool:
        return any(d.severity is Severity.ERROR for d in self._found.values())

    @property
    def has_mistakes(self) -> bool:
        """True if there are errors besides constructs that tachk knows and refuses."""
        return any(d.severity is Severity.ERROR and not d.is_unsupported for d in self._found.values())

    def sorted(self) -> tuple[Diagnostic, ...]:
        """All findings in the order of their places."""
        return by_place(self._found.values())


def count(number: int, noun: str) -> str:
    """A number with its noun: "1 argument", "no arguments"."""
    return f"{number} {noun}" if number == 1 else f"{number or 'no'} {noun}s"


def wrong_arguments(parameters: Sequence[str], given: int) -> str:
    """The help line where the number of arguments is wrong: which parameters lack one, or how many are too many."""
    missing = ", ".join(f"`{parameter}`" for parameter in parameters[given:])
    return f"add a value for {missing}" if missing else f"remove {count(given - len(parameters), 'argument')}"
