"""Reports that tachk has written as JSON, read again.

A report is checked against its schema (docs/schema) first, so that its users find the fields that they expect.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.resources import schema_text

_LARGEST = 2**64
"""No count, seed or value of a report is as large."""

_LONGEST = 160
"""The largest length of a message about a mistake in a report."""

_HALF_OF_A_PAIR = re.compile("[\ud800-\udfff]")


def read_json(path: Path, how: str) -> Mapping[str, Any]:
    """The object in a file, without numbers and characters that no report has. Raises UsageError.

    Args:
        how: what writes such files.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError as error:
        raise UsageError(f"{path} is not a text in UTF-8: {error.reason} at byte {error.start}", how) from None
    return json_object(text, str(path), how)


def json_object(text: str, name: str, how: str) -> Mapping[str, Any]:
    """The object that a text in JSON is, without numbers and characters that no report has. Raises UsageError.

    Args:
        name: of the file, for messages.
        how: what writes such files.
    """
    try:
        document = json.loads(text, parse_int=_integer, parse_float=_real, parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        reason = "it is nested too deeply" if isinstance(error, RecursionError) else str(error)
        raise UsageError(f"{name}: {reason}", how) from None
    if not isinstance(document, dict):
        raise UsageError(f"{name} is not a result of tachk", how)
    if "\\ud" in text.lower() and _HALF_OF_A_PAIR.search(json.dumps(document, ensure_ascii=False)):
        raise UsageError(f"{name} has half of a pair of surrogates, which is not a character", how)
    return document


def check_report(document: Mapping[str, Any], report: str, path: Path, how: str) -> None:
    """Raises UsageError where a document is not a report as the schema of this name describes it, with the place in the
    document and what is wrong there."""
    from jsonschema.exceptions import best_match

    error = best_match(validator(report).iter_errors(document))
    if error is None:
        return
    raise UsageError(f"{path}: {error.json_path}: {_shortened(error.message)}", how)


def _shortened(message: str) -> str:
    return message if len(message) <= _LONGEST else f"{message[:_LONGEST]}…"


def first_violation(schema: Mapping[str, Any], document: object) -> str:
    """Where a document does not follow a schema, and how; empty where it does."""
    from jsonschema.exceptions import best_match

    error = best_match(_draft()(schema).iter_errors(document))
    if error is None:
        return ""
    place = error.json_path.removeprefix("$").removeprefix(".")
    wrong = f"{place}: {_shortened(error.message)}" if place else _shortened(error.message)
    allowed = error.schema.get("properties", {}) if error.validator == "additionalProperties" else {}
    return f"{wrong}; allowed: {', '.join(allowed)}" if allowed else wrong


@cache
def validator(report: str) -> Any:
    """The validator of documents for the schema of this name, and those that it refers to."""
    from referencing import Registry, Resource
    from referencing.jsonschema import DRAFT202012

    def named(uri: str) -> Resource[Any]:
        schema = json.loads(schema_text(uri.removesuffix(".schema.json")))
        return Resource.from_contents(schema, default_specification=DRAFT202012)

    registry = Registry(retrieve=named)  # type: ignore[call-arg]  # attrs field with an alias
    return _draft()(json.loads(schema_text(report)), registry=registry)


@cache
def _draft() -> Any:
    """The class of validators. Integers are integers here, whereas by JSON Schema 1e300 is one, too."""
    from jsonschema import Draft202012Validator
    from jsonschema.validators import extend

    types = Draft202012Validator.TYPE_CHECKER.redefine("integer", lambda _, value: type(value) is int)
    return extend(Draft202012Validator, type_checker=types)


def _integer(text: str) -> int:
    if len(text) > len(str(_LARGEST)) + 1 or abs(int(text)) > _LARGEST:
        raise ValueError(f"the number {text[:20]}… is too large for a report")
    return int(text)


def _real(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"the number {text[:20]} is too large for a report")
    return number


def _no_number(text: str) -> float:
    raise ValueError(f"{text} is not a number of JSON")
