"""A plug-in of pytest: each property of a model is a test. Only pytest imports this module.

Without a model to collect it costs an import of this file: tachk itself is loaded with the first model.
"""

from __future__ import annotations

import argparse
import os
import re
import warnings
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from tachk.api.model import Model
    from tachk.base.diagnostics.diagnostic import Diagnostic
    from tachk.frontend.queries.queries import UncheckedQuery
    from tachk.model.query import Query
    from tachk.report.record import RunRecord

MODEL_SUFFIXES = (".ta", ".xta", ".xml")
_UPPAAL_ONLY = ".xml"
"""Files that end so are models if they hold UPPAAL's root element."""
_LARGEST_PREAMBLE = 4096
_SYSTEM_LINE = re.compile(r"^\s*system\b", re.MULTILINE)

_PLACES = pytest.StashKey[tuple[Path, ...]]()
"""The files and folders of models, as absolute paths."""
_FOUND = pytest.StashKey[set[Path]]()
"""The models that were collected."""
_WHOLE_FILES = "tachk_whole_files"
"""The entry of `workerinput` by which a worker of pytest-xdist knows that it gets all tests of a model."""


class ModelWarning(UserWarning):
    """A warning of tachk about a model, or that there is no model where one was named."""


class AnswerError(Exception):
    """The answer about a property is not the expected one, or there is none. The text is the report for people."""


def pytest_addoption(parser: pytest.Parser, pluginmanager: pytest.PytestPluginManager) -> None:
    _leave_modules_alone(pluginmanager)
    group = parser.getgroup("tachk", "models of timed automata")
    group.addoption(
        "--tachk",
        metavar="PATH",
        action="append",
        default=[],
        help="test the properties of this model, or of the models in this folder; may be given several times",
    )
    group.addoption(
        "--tachk-max-seconds",
        metavar="SECONDS",
        type=_seconds,
        help="a property without an answer after this time fails; properties of one model share their time",
    )
    parser.addini("tachk_models", "models, and folders of models, whose properties are tests", type="paths", default=[])


def _leave_modules_alone(pluginmanager: pytest.PytestPluginManager) -> None:
    """pytest compiles every module of a distribution with a plug-in anew, for `assert`: here a second for nothing."""
    marked = getattr(pluginmanager.rewrite_hook, "_must_rewrite", None)  # private; without it all works, later
    if isinstance(marked, set):
        marked.discard("tachk")


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = -1.0
    if not seconds >= 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of seconds")
    return seconds


def pytest_configure(config: pytest.Config) -> None:
    given = [_existing(config.invocation_params.dir / path, "--tachk") for path in config.getoption("tachk")]
    stated = [_existing(path, "tachk_models") for path in config.getini("tachk_models")]
    config.stash[_PLACES] = (*given, *stated)
    config.stash[_FOUND] = set()
    whole_run = config.args_source is not config.ArgsSource.ARGS and config.invocation_params.dir == config.rootpath
    for place in dict.fromkeys((*given, *(stated if whole_run else ()))):
        named = [Path(os.path.abspath(config.invocation_params.dir / each.split("::")[0])) for each in config.args]
        if not any(each.is_relative_to(place) or place.is_relative_to(each) for each in named):
            config.args.append(str(place))


def _existing(path: Path, option: str) -> Path:
    if not path.exists():
        raise pytest.UsageError(f"{option}: there is no file or folder {path}")
    return Path(os.path.abspath(path))


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Called by pytest-xdist for each process that it starts."""
    node.workerinput[_WHOLE_FILES] = node.config.getoption("dist") in ("loadfile", "loadscope")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> ModelFile | None:
    if file_path.suffix not in MODEL_SUFFIXES:
        return None
    places = parent.config.stash[_PLACES]
    named = file_path in places or parent.session.isinitpath(file_path)
    inside = any(file_path.is_relative_to(place) for place in places)
    if file_path.suffix == _UPPAAL_ONLY:
        if not inside or not (named or _is_of_uppaal(file_path)):
            return None
    elif not inside and not named:
        return None
    parent.config.stash[_FOUND].add(file_path)
    return ModelFile.from_parent(parent, path=file_path, named=named)


def _is_of_uppaal(path: Path) -> bool:
    with path.open("rb") as file:
        return b"<nta" in file.read(_LARGEST_PREAMBLE)


def pytest_collection_finish(session: pytest.Session) -> None:
    found = session.config.stash[_FOUND]
    for path in session.config.getoption("tachk"):
        place = Path(os.path.abspath(session.config.invocation_params.dir / path))
        if not any(each.is_relative_to(place) for each in found):
            warnings.warn(ModelWarning(f"--tachk {path}: no model was collected there"), stacklevel=1)


class ModelFile(pytest.File):
    """A model. Its tests share a search where that is possible.

    Attributes:
        named: the file itself was named, not a folder around it.
    """

    def __init__(self, *, named: bool, **of_node: Any) -> None:
        super().__init__(**of_node)
        self.named = named
        self._model: Model | None = None
        self._answers: dict[str, RunRecord | Exception] = {}

    @property
    def shown_path(self) -> str:
        """The path as messages have it."""
        start = self.config.invocation_params.dir
        return str(self.path.relative_to(start) if self.path.is_relative_to(start) else self.path)

    def collect(self) -> Iterator[pytest.Item]:
        from tachk.api.model import load
        from tachk.base.diagnostics.diagnostic import TachkError

        try:
            self._model = load(self.shown_path if Path.cwd() == self.config.invocation_params.dir else self.path)
        except TachkError as error:
            if not self.named and not _SYSTEM_LINE.search(self.path.read_text(encoding="utf-8", errors="replace")):
                pytest.skip(f"{self.shown_path} has no system line: it is for other models", allow_module_level=True)
            raise self.CollectError(_explained(error)) from None
        for found in self._model.warnings:
            line, _ = found.span.in_file.source.line_column(found.span.in_file.start)
            warnings.warn_explicit(ModelWarning(_rendered([found])), None, str(self.path), line)
        formulas = self._model.loaded.formulas
        if not formulas:
            pytest.skip(f"{self.shown_path} states no property", allow_module_level=True)
        for formula in formulas:
            yield PropertyTest.from_parent(self, name=formula.name, formula=formula)

    def answer(self, test: PropertyTest) -> RunRecord:
        """The part of a report that is about one property. Raises what `Model.verify` raises."""
        if test.name not in self._answers:
            together = [each for each in self.session.items if isinstance(each, PropertyTest) and each.parent is self]
            workerinput = getattr(self.config, "workerinput", None)
            shares = workerinput is None or workerinput[_WHOLE_FILES]
            self._verify(together if shares and test in together else [test])
        found = self._answers[test.name]
        if isinstance(found, Exception):
            raise found
        return found

    def _verify(self, tests: Sequence[PropertyTest]) -> None:
        """Answers tests. Ctrl-C, which ends a search with an answer, ends pytest, too."""
        from tachk.base.diagnostics.diagnostic import TachkError
        from tachk.base.job import StoppedError
        from tachk.base.records import replace
        from tachk.engine.options import Limits
        from tachk.engine.outcome import INTERRUPTED

        assert self._model is not None
        names = [test.name for test in tests if test.is_answered]
        seconds = self.config.getoption("tachk_max_seconds")
        limits = Limits(seconds=None if seconds is None else seconds * len(names))
        try:
            record = self._model.verify(property=names, limits=limits).record
        except (TachkError, StoppedError) as error:
            self._answers |= dict.fromkeys(names, error)
            return
        reasons = {verdict.reason for verdict in record.verdicts} | {answer.reason for answer in record.estimates}
        if INTERRUPTED in reasons:
            raise KeyboardInterrupt
        for name in names:
            verdicts = tuple(each for each in record.verdicts if each.query.name == name)
            estimates = tuple(each for each in record.estimates if each.query.name == name)
            not_checked = tuple(each for each in record.not_checked if each.name == name)
            self._answers[name] = replace(record, verdicts=verdicts, estimates=estimates, not_checked=not_checked)


class PropertyTest(pytest.Item):
    """A property of a model: it passes if the answer is the expected one.

    Attributes:
        title: of a query in UPPAAL's XML, which has no name; else empty. `-k` selects it, too.
    """

    parent: ModelFile

    def __init__(self, *, formula: Query | UncheckedQuery, **of_node: Any) -> None:
        super().__init__(**of_node)
        self.formula = formula
        self.title = " ".join(formula.title.split())
        if self.title:
            self.extra_keyword_matches.add(self.title)

    @property
    def is_answered(self) -> bool:
        """Whether it is a question that a search or random runs can answer."""
        from tachk.frontend.queries.queries import is_statistical
        from tachk.model.query import Query

        return isinstance(self.formula, Query) or (is_statistical(self.formula) and not self.formula.diagnostics)

    def runtest(self) -> None:
        from tachk.frontend.queries.queries import UncheckedQuery
        from tachk.report.answers import Report
        from tachk.verify.questions import why_not

        if isinstance(self.formula, UncheckedQuery) and not self.is_answered:
            if not self.formula.diagnostics:
                pytest.skip(f"not checked: {why_not(self.formula)}")
            raise AnswerError(f"{self.name} cannot be checked:\n{_rendered(self.formula.diagnostics)}")
        record = self.parent.answer(self)
        if record.met is not True:
            raise AnswerError(f"{self._headline(record)}\n\n{Report(record).to_text()}")

    def _headline(self, record: RunRecord) -> str:
        """What is wrong, in the line that pytest repeats in its summary."""
        from tachk.engine.outcome import TIME_LIMIT
        from tachk.report.statistics.answered import answered_lines

        if record.met is False and record.verdicts:
            verdict = record.verdicts[0]
            expectation = verdict.query.expectation
            return f"{verdict.in_words}, expected: {expectation.value if expectation else 'holds'}"
        reasons = [verdict.reason for verdict in record.verdicts] + [answer.reason for answer in record.estimates]
        if record.estimates:
            said = next(iter(answered_lines(record.estimates[0])))
        else:
            said = f"unknown: {', '.join(reasons) or 'no decision'}"
        if TIME_LIMIT in reasons:
            said += f" (--tachk-max-seconds {self.config.getoption('tachk_max_seconds'):g})"
        return said

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        from tachk.base.diagnostics.diagnostic import TachkError
        from tachk.base.job import StoppedError

        if isinstance(excinfo.value, AnswerError):
            return str(excinfo.value)
        if isinstance(excinfo.value, TachkError | StoppedError):
            return _explained(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int, str]:
        span = self.formula.span.in_file
        line, _ = span.source.line_column(span.start)
        return self.path, line - 1, f"{self.name}: {self.title}" if self.title else self.name


def _explained(error: Exception) -> str:
    """The message of `tachk verify` for an error."""
    from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError, UsageError
    from tachk.base.job import StoppedError

    match error:
        case InputError(diagnostics=diagnostics):
            return _rendered(diagnostics)
        case UnsupportedError(diagnostic=diagnostic):
            return _rendered([diagnostic])
        case UsageError(message=message, help=help):
            return f"error: {message}" + (f"\nhelp: {help}" if help else "")
        case StoppedError(reason=reason):
            return f"error: the {reason} was over before there was a result (--tachk-max-seconds)"
        case _:
            return f"error: {error}"


def _rendered(diagnostics: Iterable[Diagnostic]) -> str:
    from tachk.base.diagnostics.render import render

    return "\n".join(map(render, diagnostics))
