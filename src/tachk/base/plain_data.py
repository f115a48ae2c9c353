"""Results as plain data for programs: one walker derives the JSON of a result from its dataclass.

The walker writes an object as a dictionary of its attributes, a member of an enumeration as its value, an exact number
as a string such as ``"5/2"``, tuples and arrays as lists. A `Fields` lists the attributes of a class that the
dictionary has, and their names there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum
from fractions import Fraction
from operator import attrgetter
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, Label
from tachk.base.records import fields, is_dataclass
from tachk.base.span import Span

_ATOMS = frozenset({str, int, float, bool, type(None)})


class Fields:
    """The attributes of a class that its JSON has, in order.

    Args:
        names: of attributes, with blanks between; ``key=attribute`` under another name, ``key=first.second`` for an
            attribute of an attribute, which is None where the first one is.
        computed: other values, by key. A key that ``names`` has, too, stands there, else at the end.
    """

    def __init__(self, names: str, **computed: Callable[[Any], object]) -> None:
        self.parts: dict[str, Callable[[Any], object]] = {}
        for name in names.split():
            key, _, path = name.partition("=")
            self.parts[key] = computed.get(key) or _getter(path or key)
        self.parts |= computed


def _getter(path: str) -> Callable[[Any], object]:
    first, dot, rest = path.partition(".")
    if not dot:
        return attrgetter(first)
    then = _getter(rest)

    def get(value: Any) -> object:
        found = getattr(value, first)
        return None if found is None else then(found)

    return get


class PlainData:
    """The walker.

    Args:
        forms: for classes, the `Fields` of their JSON or a function that makes it. The JSON of a dataclass that is not
            among them has all its fields.
    """

    def __init__(self, forms: Mapping[type, Fields | Callable[[Any], object]] | None = None) -> None:
        self._forms = {**_COMMON, **(forms or {})}
        self._atoms = _ATOMS - self._forms.keys()

    def of(self, value: object) -> dict[str, Any]:
        """An object as a dictionary for `json.dumps`."""
        found: dict[str, Any] = self(value)
        return found

    def __call__(self, value: Any) -> Any:
        """Plain data of any value. Raises TypeError for one that has none."""
        kind = type(value)
        atoms = self._atoms
        if kind in atoms:
            return value
        form = self._forms.get(kind)
        if isinstance(form, Fields):
            described = ((key, get(value)) for key, get in form.parts.items())
            return {key: item if type(item) in atoms else self(item) for key, item in described}
        if form is not None:
            return form(value)
        if isinstance(value, tuple | list):
            return [item if type(item) in atoms else self(item) for item in value]
        if isinstance(value, Enum):
            return value.value
        if isinstance(value, Fraction):
            return str(value)
        if isinstance(value, Mapping):
            return {self(key): item if type(item) in atoms else self(item) for key, item in value.items()}
        if is_dataclass(value):
            return {field.name: self(getattr(value, field.name)) for field in fields(value)}
        if hasattr(value, "tolist"):
            return value.tolist()
        raise TypeError(f"{kind.__name__} has no plain data")


def complaint(message: str | None, help: str | None) -> dict[str, Any]:
    """A finding that has no place in a text, in the form of a diagnostic."""
    return {"code": None, "severity": "error", "message": message, "help": help, "place": None, "labels": []}


def _place(span: Span) -> dict[str, Any]:
    """Lines and columns count from 1, the end column is the one behind the last character. Places in UPPAAL's XML say
    also what they are about, by the names of the model (``names``) and as XPath (``path``)."""
    place, passage = span.in_file, span.passage
    line, column = place.source.line_column(place.start)
    end_line, end_column = place.source.line_column(place.end)
    return {
        "file": place.source.name,
        "line": line,
        "column": column,
        "end_line": end_line,
        "end_column": end_column,
        **({} if passage is None else {"names": passage.names, "path": passage.path}),
    }


_COMMON: Mapping[type, Fields | Callable[[Any], object]] = {
    Diagnostic: Fields("code severity message help place=span labels"),
    Label: Fields("text place=span"),
    Span: _place,
}
