"""The formulas that are evaluated on a trace: a text, a file of formulas, or the properties of a model."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, Severity, UsageError
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.exact_numbers import exact_number
from tachk.base.operators import PrefixOperator
from tachk.base.span import Source, Span
from tachk.base.time_units import length_of
from tachk.frontend.findings import DiagnosticCollector
from tachk.logic.constant_values import value_of, whole_quotient
from tachk.logic.durations import resolve, scaled
from tachk.logic.sentences import meaning
from tachk.recordings.monitors import compiler as monitoring
from tachk.recordings.monitors.constant_lines import ConstantReader, doubled_units
from tachk.recordings.monitors.given_constants import constants_by_name
from tachk.recordings.monitors.references import circle, expanded, references
from tachk.recordings.traces.trace_files import TRACE_SUFFIXES
from tachk.syntax import ast
from tachk.syntax.formula import Duration, Formula
from tachk.syntax.formulas.foreign_operators import operator_as_call
from tachk.syntax.formulas.parser import parse_formula
from tachk.syntax.formulas.printer import print_formula
from tachk.syntax.formulas.tokens import is_sentence
from tachk.syntax.parsing.tables import lexer
from tachk.syntax.rewrite import rewrite
from tachk.syntax.sentences.parser import parse_sentence, with_full_stop
from tachk.syntax.source_files import is_xml, read_source
from tachk.syntax.walk import nodes_of_kind

_UNIT = "say what one unit of the trace's time is: --unit s, unit='s', or time [s] in the header"

FORMULA_SUFFIXES = (".stl",)
MODEL_SUFFIXES = (".ta", ".xta", ".xml")

_TYPED = "<formula>"
_NEVER_FORMULAS = tuple(suffix for suffix in TRACE_SUFFIXES if suffix != ".txt")
"""Formulas may stand in a plain text file, as traces may."""

_LINE = re.compile(r"(?P<name>\w+(?:[.\-/]+\w+)*)\s*(?:\"(?P<title>[^\"\n]*)\"\s*)?:(?!:)\s*")
_NO_NAME = re.compile(r"[^\"`:()\[\]{}<>=&|!]*:(?!:)")
"""An invalid name."""


@dataclass(frozen=True, slots=True)
class NamedFormula:
    """Attributes:
    name: as written, or ``p1``, ``p2``, ... in order.
    formula: bounds still in the units in which they are written.
    sentence: its text if it was written as one, else empty.
    unit: what a bound without unit is measured in, such as ``10 ms``; empty: the unit of the trace.
    constants: of the model or the file that states it; a column of such a name comes first.
    given: the values that the user gives constants; a column of such a name is an error.
    durations: as ``constants``, those with a unit, in nanoseconds.
    siblings: formulas of the same file that it may name.
    written: in canonical form, where the formula is another one for some trace; else empty.
    """

    name: str
    title: str
    formula: Formula
    sentence: str = ""
    unit: str = ""
    constants: Mapping[str, Fraction | int] | None = None
    given: Mapping[str, Fraction] | None = None
    durations: Mapping[str, Fraction] | None = None
    siblings: Mapping[str, Formula] | None = None
    written: str = ""

    def beside(self, columns: Collection[str]) -> NamedFormula:
        """The formula where there are these columns: a name of one of them is not a formula."""
        left = {name: each for name, each in (self.siblings or {}).items() if name not in columns}
        return replace(self, siblings=left or None) if self.siblings else self

    @property
    def named_formulas(self) -> frozenset[str]:
        """The names in it that mean other formulas of its file."""
        return references(self.formula, self.siblings or {})

    def circles(self) -> Iterator[Diagnostic]:
        """A finding for each name in it that means no column but a formula that names itself."""
        named = {name: each for name, each in (self.siblings or {}).items() if name not in self.constant_names}
        for place in nodes_of_kind(self.formula, ast.NameExpression):
            if place.name in named and (around := circle(place.name, named)):
                message = f"the formula `{place.name}` names itself: {' -> '.join(around)}"
                yield Diagnostic("E0901", message, place.span, "leave out one of these names, or rename a formula")

    def within(self, columns: Collection[str]) -> NamedFormula:
        """The formula over these columns, with other formulas in place of their names; the text is lost."""
        if not self.siblings:
            return self
        return replace(self, formula=expanded(self.formula, self.siblings, columns), siblings=None)

    def numbers(self, unit: str) -> dict[str, Fraction | int]:
        """The values of all constants where times are measured in a unit. Raises UsageError if there is no unit."""
        length = length_of(unit)
        if self.durations and length is None:
            name = next(iter(self.durations))
            raise UsageError(f"the constant `{name}` has a unit, but the length of one unit of time is unknown", _UNIT)
        durations = {name: value / length for name, value in (self.durations or {}).items() if length is not None}
        return {**(self.constants or {}), **durations, **(self.given or {})}

    @property
    def text(self) -> str:
        """In canonical form."""
        return self.written or _printed(self.formula)

    @property
    def columns(self) -> frozenset[str]:
        """The columns that it speaks about; a constant of the model may be among them."""
        read = _columns_read(self.formula)
        return read if self.given is None else read - self.given.keys()

    @property
    def names(self) -> frozenset[str]:
        """All names in it, of columns and constants."""
        bounds = {
            name.name
            for duration in nodes_of_kind(self.formula, Duration)
            for name in nodes_of_kind(duration, ast.NameExpression)
        }
        return _columns_read(self.formula) | bounds

    @property
    def constant_names(self) -> frozenset[str]:
        """The names that are constants where no column has them."""
        return frozenset((*(self.constants or {}), *(self.durations or {}), *(self.given or {})))


def beside_columns(formulas: Iterable[NamedFormula], columns: Collection[str]) -> tuple[NamedFormula, ...]:
    """The formulas where there are these columns. Raises InputError for formulas that name themselves."""
    beside = tuple(named.beside(columns) for named in formulas)
    if found := [finding for named in beside for finding in named.circles()]:
        raise InputError(found)
    return beside


def hidden_formulas(formulas: Iterable[NamedFormula], columns: Collection[str]) -> tuple[str, ...]:
    """Warnings of names that mean columns, and would mean formulas if there were none of these names."""
    return tuple(
        f"`{name}` in the formula `{named.name}` is the column, not the formula of this name"
        for named in formulas
        for name in sorted(named.named_formulas.intersection(columns))
    )


# One formula often judges many traces: what it alone gives is kept.
_printed = lru_cache(maxsize=256)(print_formula)
_columns_read = lru_cache(maxsize=256)(monitoring.columns_read)


def read_formulas(
    given: str | os.PathLike[str], definitions: Mapping[str, str] | None = None
) -> tuple[NamedFormula, ...]:
    """The formulas of a text, a file of formulas, or a model.

    A text is a formula or a sentence, which may lack its full stop here.

    Args:
        definitions: other values for constants of a model or a file, and values for names in bounds and conditions.

    Raises:
        InputError: with everything that is wrong.
        UsageError: the file cannot be read, or states nothing that can be monitored.
    """
    return formulas_in(formula_source(given), definitions)


def formula_source(given: str | os.PathLike[str]) -> Source:
    """The text of a formula, of a file of formulas or of a model: it stays what it is while the file changes.

    Raises InputError and UsageError as `read_formulas` for what cannot be read.
    """
    if not names_file(given):
        return Source(_TYPED, str(given))
    path = Path(given)
    if path.suffix.lower() in _NEVER_FORMULAS:
        raise _exchanged(path)
    return read_source(path)


def formulas_in(source: Source, definitions: Mapping[str, str] | None = None) -> tuple[NamedFormula, ...]:
    """As `read_formulas`, of what `formula_source` has read."""
    values = definitions or {}
    if source.name == _TYPED:
        return defined(_text_formulas(source.text), values)
    if Path(source.name).suffix.lower() in MODEL_SUFFIXES:
        return model_formulas(source, values)
    return _defined_in_file(_file_formulas(source, values), values)


def defined(formulas: tuple[NamedFormula, ...], definitions: Mapping[str, str | Fraction]) -> tuple[NamedFormula, ...]:
    """The formulas with these values of constants. Raises UsageError for a name that none of them has."""
    if not definitions:
        return formulas
    names = sorted({name for named in formulas for name in named.names})
    values: dict[str, Fraction] = {}
    for name, text in definitions.items():
        if name not in names:
            raise UsageError(f"-D {name}: no formula has this name", did_you_mean(name, names))
        try:
            values[name] = exact_number(str(text))
        except ValueError:
            raise UsageError(f"-D {name}={text}: expected a number", "such as -D T=2.5") from None
    return tuple(replace(named, given={**(named.given or {}), **values}) for named in formulas)


def _defined_in_file(formulas: tuple[NamedFormula, ...], definitions: Mapping[str, str]) -> tuple[NamedFormula, ...]:
    """The formulas of a file, whose constants have these values already."""
    names = {name for named in formulas for name in named.names}
    numbers, durations = formulas[0].constants or {}, formulas[0].durations or {}
    done = {name for name in definitions if name in durations or (name in numbers and name not in names)}
    return defined(formulas, {name: text for name, text in definitions.items() if name not in done})


@lru_cache(maxsize=256)
def _text_formulas(text: str) -> tuple[NamedFormula, ...]:
    """Kept, because one formula often judges many traces."""
    source = Source(_TYPED, with_full_stop(text))
    return _checked([_read("p1", "", Span(source, 0, len(source.text)))], "the formula")


def check_order(formula: object, trace: object) -> None:
    """Raises UsageError where the formulas were given in the place of the trace, and the trace in theirs."""
    if isinstance(formula, (str, os.PathLike)) and isinstance(trace, (str, os.PathLike)):
        first, second = Path(formula), Path(trace)
        if first.suffix.lower() in TRACE_SUFFIXES and second.suffix.lower() in (*FORMULA_SUFFIXES, *MODEL_SUFFIXES):
            raise _exchanged(first)


def _exchanged(path: Path) -> UsageError:
    return UsageError(f"{path} is a trace, no file of formulas", "the formulas come first, then the trace")


def in_trace_units(named: NamedFormula, columns: Collection[str], unit: str) -> Formula:
    """The formula over the columns of a trace, with bounds that are numbers in the unit of the trace.

    A name that is not a column but a constant of the model stands for its value. Raises InputError.
    """
    clash = next((name for name in named.given or {} if name in columns), None)
    if clash is not None:
        raise UsageError(f"-D {clash}: the trace has a column of this name", "rename the constant in the formula")
    own = named.unit or unit
    constants = {name: value for name, value in named.numbers(own).items() if name not in columns}
    formula = resolve(named.formula, constants_by_name(constants), own, _UNIT)

    def change(node: Any) -> Any:
        match node:
            case ast.NameExpression(name=name, span=span) if name in constants:
                return literal(span, Fraction(constants[name]))
            case _:
                return node

    return rewrite(scaled(formula, _ratio(own, unit)), change)


def literal(span: Span, value: Fraction) -> ast.Expression:
    """A number as it stands in a condition, in which numbers are floating-point ones."""
    size = abs(value)
    whole = size.denominator == 1
    literal = ast.IntegerLiteral(span, int(size)) if whole else ast.FloatLiteral(span, repr(float(size)))
    return literal if value >= 0 else ast.UnaryExpression(span, PrefixOperator.MINUS, literal)


def _ratio(own: str, common: str) -> Fraction:
    """The number of units of the trace that make one of the formula; 1 if one of them is not known."""
    first, second = length_of(own), length_of(common)
    return Fraction(1) if first is None or second is None else first / second


def names_file(given: str | os.PathLike[str]) -> bool:
    """True if an argument names a file rather than being a formula."""
    if not isinstance(given, str):
        return True
    if "\n" in given:
        return False
    is_path_like = given.endswith((*FORMULA_SUFFIXES, *MODEL_SUFFIXES)) and not re.search(r"\s", given)
    return is_path_like or os.path.isfile(given)  # unlike Path.is_file false for a text that is too long


def _checked(read: list[NamedFormula | tuple[Diagnostic, ...]], what: str) -> tuple[NamedFormula, ...]:
    wrong = [found for each in read if isinstance(each, tuple) for found in each]
    if any(found.severity is Severity.ERROR for found in wrong):
        raise InputError(wrong)
    formulas = tuple(each for each in read if isinstance(each, NamedFormula))
    if not formulas:
        raise UsageError(f"there is no formula in {what}", "write one on each line: name: G (p -> F[0, 5] q)")
    return formulas


# ---- files of formulas --------------------------------------------------------------------------------------------


def _file_formulas(source: Source, definitions: Mapping[str, str]) -> tuple[NamedFormula, ...]:
    read: list[NamedFormula | tuple[Diagnostic, ...]] = []
    names: dict[str, Span] = {}
    named: dict[str, Formula] = {}
    constants = ConstantReader(definitions)
    for span in _entries(source):
        if constants.take(span):
            continue
        match = _LINE.match(source.text, span.start, span.end)
        name = match["name"] if match else f"p{len(read) + 1}"
        title = (match["title"] or "") if match else ""
        start = match.end() if match else span.start
        if name in names:
            read.append((Diagnostic("E0202", f"the formula `{name}` is there twice", span),))
            continue
        names[name] = span
        if match is None and (no_name := _NO_NAME.match(source.text, span.start, span.end)) is not None:
            read.append((_not_a_name(Span(source, span.start, no_name.end() - 1)),))
            continue
        read.append(_read(name, title, Span(source, start, span.end)))
        if match is not None and isinstance(read[-1], NamedFormula):
            named[name] = read[-1].formula
    complete = list(_with_constants(read, constants, named))
    return _checked([tuple(constants.found), *complete], source.name)


def _with_constants(
    read: Iterable[NamedFormula | tuple[Diagnostic, ...]], reader: ConstantReader, named: Mapping[str, Formula]
) -> Iterator[NamedFormula | tuple[Diagnostic, ...]]:
    """The formulas of a file with its constants and names."""
    values = reader.values()
    for each in read:
        if not isinstance(each, NamedFormula):
            yield each
        elif doubled := tuple(doubled_units(each.formula, values.durations)):
            yield doubled
        else:
            siblings = named if _columns_read(each.formula) & named.keys() else None
            yield replace(each, constants=values.numbers or None, durations=values.durations or None, siblings=siblings)


def _not_a_name(span: Span) -> Diagnostic:
    help_ = "a name consists of letters, digits and _, with - . / between them: REQ-1.2"
    return Diagnostic("E0101", f"`{span.text.strip()}` is not a name of a formula", span, help_)


def _entries(source: Source) -> Iterator[Span]:
    """The formulas of a file: one a line; a line that begins with a blank goes on with the one above.

    Comments begin with ``//``, or with ``#`` at the beginning of a line.
    """
    start = end = -1
    offset = 0
    for line in source.text.splitlines(keepends=True):
        content = _without_comment(line).rstrip()
        if content:
            if start >= 0 and content[0] not in " \t":
                yield Span(source, start, end)
                start = -1
            if start < 0:
                start = offset + len(content) - len(content.lstrip())
            end = offset + len(content)
        elif not line.strip() and start >= 0:
            yield Span(source, start, end)
            start = -1
        offset += len(line)
    if start >= 0:
        yield Span(source, start, end)


def _without_comment(line: str) -> str:
    if line.lstrip().startswith("#"):
        return ""
    unquoted = re.sub(r"`[^`]*`|\"[^\"]*\"", lambda match: "_" * len(match.group()), line)
    place = unquoted.find("//")
    return line if place < 0 else line[:place]


def _read(name: str, title: str, span: Span) -> NamedFormula | tuple[Diagnostic, ...]:
    if span.text.rstrip().endswith(".") and is_sentence(lexer().cut(span.source, span.start, span.end).tokens[:-1]):
        return _sentence(name, title, span)
    formula, found = parse_formula(span)
    if formula is None:
        return found
    words = tuple(_called_words(formula))
    return words or NamedFormula(name, title, formula)


def _called_words(formula: Formula) -> Iterator[Diagnostic]:
    """A finding for each operator that is written as a function: ``always(p)``."""
    for call in nodes_of_kind(formula, ast.CallExpression):
        function = call.function
        if isinstance(function, ast.NameExpression):
            found = operator_as_call(function.name, function.span)
            if found is not None:
                yield found


def _sentence(name: str, title: str, span: Span) -> NamedFormula | tuple[Diagnostic, ...]:
    sentence, found = parse_sentence(span)
    if sentence is None:
        return found
    return NamedFormula(name, title, meaning(sentence), " ".join(span.text.split()))


# ---- models -------------------------------------------------------------------------------------------------------


def model_formulas(source: Source, definitions: Mapping[str, str]) -> tuple[NamedFormula, ...]:
    """The temporal properties of the text of a model. Raises as `read_formulas`."""
    items, unit, constants = _stated(source, definitions)
    read: list[NamedFormula | tuple[Diagnostic, ...]] = []
    for item in items:
        if isinstance(item, ast.PropertyDeclaration) and isinstance(item.formula, ast.TemporalFormula):
            each = _read(item.name.name, item.title, item.formula.span)
            if isinstance(each, NamedFormula):
                each = replace(each, unit=unit, constants=constants)
            read.append(each)
    if not read:
        raise UsageError(
            f"{source.name} contains no property that can be checked on a trace",
            "formulas and sentences can be monitored; E<>, A[] and --> speak about all runs: write A[] p as G p, "
            "and p -->[<= 5] q as G (p -> F[0, 5] q)",
        )
    return _checked(read, source.name)


def _stated(source: Source, definitions: Mapping[str, str]) -> tuple[Sequence[ast.Item], str, dict[str, int]]:
    """The declarations of a model, its time unit, its constants.

    A file without a system line is not a model but a part of models, so its names have no meaning yet: it is read only.
    """
    # Imported late: these imports take half of the start-up time of a process that only reads formulas.
    from tachk.formats.loading.imports import Importer
    from tachk.formats.loading.load import load_model

    if not is_xml(source):
        findings = DiagnosticCollector()
        document, items = Importer(findings).read(source)
        if document is not None and not any(isinstance(item, ast.SystemLine) for item in items):
            if findings.has_errors:
                raise InputError(findings.sorted())
            units = [f"{item.amount} {item.unit}" for item in items if isinstance(item, ast.TimeUnitDeclaration)]
            return items, units[0] if units else "", _plain_constants(items, definitions)
    loaded = load_model(source, definitions)
    return loaded.items, loaded.heading.time_unit, dict(loaded.heading.constants)


def _plain_constants(items: Iterable[ast.Item], definitions: Mapping[str, str]) -> dict[str, int]:
    """The constants whose values follow from numbers and each other alone. Raises UsageError for definitions of names
    that are no such constants."""
    constants: dict[str, int] = {}
    left = dict(definitions)
    for item in items:
        if isinstance(item, ast.VariableDeclaration) and (item.type is None or "const" in item.type.prefixes):
            for declarator in item.declarators:
                if declarator.initialiser is None or declarator.dimensions:
                    continue
                if (text := left.pop(declarator.name.name, None)) is not None:
                    constants[declarator.name.name] = _whole(declarator.name.name, text)
                    continue
                try:
                    value = value_of(declarator.initialiser, constants_by_name(constants), whole_quotient)
                except InputError:
                    continue
                if value.denominator == 1:
                    constants[declarator.name.name] = int(value)
    for name in left:
        raise UsageError(f"-D {name}: there is no such constant", did_you_mean(name, constants))
    return constants


def _whole(name: str, text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise UsageError(f"-D {name}={text}: expected a whole number", "such as -D N=4") from None
