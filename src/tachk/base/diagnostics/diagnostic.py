"""A diagnostic is a value; other modules render it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import StrEnum
from importlib import import_module

from tachk.base.records import dataclass
from tachk.base.span import Span

UNSUPPORTED = frozenset({"E0728", "E0730", "E0731", "E0732", "E0733", "E0750"})
"""The codes of constructs that are refused although they are no mistake."""


class Severity(StrEnum):
    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Label:
    """A secondary place with its own short text, such as "first declared here"."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding about one place of the input.

    Attributes:
        code: stable identifier, ``E0201`` or ``W0103``; a key of `explanation.all_explanations()`.
        message: one sentence, lower case, without a full stop; must make sense on its own.
        span: the primary place.
        help: how to mend it, or None where nothing useful can be said.
        labels: secondary places.
    """

    code: str
    message: str
    span: Span
    help: str | None = None
    labels: tuple[Label, ...] = ()

    @property
    def severity(self) -> Severity:
        """Whether this is an error or a warning, as its code says."""
        return Severity.WARNING if self.code.startswith("W") else Severity.ERROR

    @property
    def is_unsupported(self) -> bool:
        """True if this is about a construct that tachk knows and refuses, not about a mistake."""
        return self.code in UNSUPPORTED


def by_place(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """The findings in the order of the lines of each file, the files in the order in which they are met."""
    found = list(diagnostics)
    files: dict[int, int] = {}
    for diagnostic in found:
        files.setdefault(id(diagnostic.span.in_file.source), len(files))

    def place(diagnostic: Diagnostic) -> tuple[int, int, int, str]:
        span = diagnostic.span.in_file
        return files[id(span.source)], span.start, span.end, diagnostic.code

    return tuple(sorted(found, key=place))


class TachkError(Exception):
    """Base of every error tachk raises on purpose. It can be pickled, and so come from another process."""

    def __reduce__(self) -> tuple[Callable[..., TachkError], tuple[object, ...]]:
        return _as_raised, (type(self), self.args, self.__dict__)


def _as_raised(kind: type[TachkError], arguments: tuple[object, ...], attributes: dict[str, object]) -> TachkError:
    error = kind.__new__(kind, *arguments)
    error.__dict__.update(attributes)
    return error


class InputError(TachkError):
    """The user's text, query or option is wrong. Carries every diagnostic that was found."""

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics = tuple(diagnostics)
        super().__init__("; ".join(f"{d.span}: {d.code}: {d.message}{_advice(d.help)}" for d in self.diagnostics))

    def _render_traceback_(self) -> list[str]:
        return _in_notebook(self, self.diagnostics)


class UnsupportedError(TachkError):
    """The model is legal but uses a feature that the requested analysis cannot decide."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        self.diagnostic = diagnostic
        super().__init__(f"{diagnostic.span}: {diagnostic.code}: {diagnostic.message}{_advice(diagnostic.help)}")

    def _render_traceback_(self) -> list[str]:
        return _in_notebook(self, (self.diagnostic,))


class UsageError(TachkError):
    """A wrong option, path or constant that has no place in a source text."""

    def __init__(self, message: str, help: str | None = None) -> None:
        self.message = message
        self.help = help
        super().__init__(f"{message}{_advice(help)}")

    def _render_traceback_(self) -> list[str]:
        return [f"{type(self).__name__}: {self.message}", *([f"help: {self.help}"] if self.help else [])]


def _in_notebook(error: TachkError, diagnostics: Iterable[Diagnostic]) -> list[str]:
    """What IPython shows of an error: source lines of the user, no lines of tachk."""
    rendered = import_module("tachk.base.diagnostics.render")  # which knows diagnostics
    return [f"{type(error).__name__}:", *(line for each in diagnostics for line in rendered.render(each).splitlines())]


def _advice(help: str | None) -> str:
    """The lines after a message in a script or notebook."""
    return f" ({help})" if help else ""


class InternalError(TachkError):
    """A defect of tachk itself."""
