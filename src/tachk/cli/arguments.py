"""Tells models from queries among the arguments of a command, and reads the values of options."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Sequence
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import closest
from tachk.base.exact_numbers import DIGITS
from tachk.model.grid import grid_of, set_by

MODEL_SUFFIXES = (".ta", ".xta", ".xml", ".tck")
QUERY_SUFFIXES = (".q",)

_PATH_QUERY = re.compile(r"\s*[AE]\s*(\[\]|<>)")
_QUERY_OPERATOR = re.compile(r"[AE]\s*(\[\]|<>)|-->|\b(sup|inf|bounds)\b|[\s{}()<>=!&|]")
_RANGE = re.compile(r"\s*-?\w+\s*(\.\.\.?|:)\s*-?\w+\s*((:|\.\.)\s*-?\w+\s*)?|-?\w+\s*(,\s*-?\w+\s*)+")
"""The ways in which other programs write several values."""
_SETTING = re.compile(r"\s*[A-Za-z_]\w*\s*=[^=>].*")
_SIZES = {"": 1, "B": 1, "K": 10**3, "M": 10**6, "G": 10**9, "KI": 2**10, "MI": 2**20, "GI": 2**30}


def split_models_and_queries(arguments: Sequence[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The arguments that are models and those that are queries, each in order.

    A model is a file that exists, or a name that ends like one. A sentence may lack its full stop here. Raises
    UsageError for an argument that is neither model nor query, or if there is no model.
    """
    models: list[str] = []
    queries: list[str] = []
    for argument in arguments:
        if _is_model(argument):
            models.append(argument)
        elif _PATH_QUERY.match(argument):
            queries.append(argument)
        else:
            from tachk.syntax.sentences.parser import with_full_stop

            queries.append(with_full_stop(argument))
    if not models:
        raise UsageError(
            "no model among the arguments",
            "the first argument should be a model file: tachk verify MODEL.ta 'A[] not deadlock'",
        )
    return tuple(models), tuple(queries)


def _is_model(argument: str) -> bool:
    # Unlike the methods of Path, these take everything that is not a path, such as a long query, for no file.
    if os.path.exists(argument) and not os.path.isdir(argument):
        if os.path.splitext(argument)[1] in QUERY_SUFFIXES:
            raise UsageError(f"{argument} is a file of queries", f"give it with -q: -q {argument}")
        return True
    if os.path.isdir(argument):
        names = (name for name in os.listdir(argument) if os.path.splitext(name)[1] in MODEL_SUFFIXES)
        inside = sorted(os.path.normpath(os.path.join(argument, name)) for name in names)
        models = ", ".join(inside[:5]) or "none"
        raise UsageError(f"{argument} is a folder, not a model", f"models in it: {models}")
    if argument.endswith((*MODEL_SUFFIXES, *QUERY_SUFFIXES)) and not re.search(r"\s", argument):
        raise UsageError(f"there is no file {argument}", _similar_files(argument))
    refuse_setting(argument, "-D")
    if not _QUERY_OPERATOR.search(argument):
        raise UsageError(
            f"{argument!r} is neither a file nor a query",
            f"to check the model's property of this name: --property {argument}" if argument.isidentifier() else None,
        )
    return False


def refuse_setting(argument: str, option: str) -> None:
    """Raises UsageError for ``N=5`` in the place of a query; the option is what sets constants."""
    if _SETTING.fullmatch(argument):
        raise UsageError(f"{argument!r} is not a query", f"to set a constant: {option} {argument.replace(' ', '')}")


def _similar_files(path: str) -> str | None:
    folder, name = os.path.split(path)
    if not os.path.isdir(folder or "."):
        return f"there is no folder {folder}"
    close = closest(name, os.listdir(folder or "."))
    return f"did you mean {os.path.join(folder, close)}?" if close else None


def parse_definitions(definitions: Iterable[str]) -> dict[str, str]:
    """``NAME=expression`` pairs as a dictionary; one text may have several, with commas between.

    Raises UsageError for anything else, for a name given twice and for several values of one name.
    """
    result: dict[str, str] = {}
    for name, expression in set_by(definitions):
        if name in result:
            raise UsageError(f"-D {name} is given twice")
        if _RANGE.fullmatch(expression):
            raise UsageError(
                f"-D {name}={expression}: one value at a time",
                f"for all of them: tachk sweep MODEL -D {name}={_as_range(expression)}",
            )
        result[name] = expression
    return result


def parse_lateness(values: Iterable[str]) -> dict[str, str]:
    """Durations by ``input`` and ``output``, of texts such as ``input=1ms``, or ``20ms`` for both.

    Raises UsageError where a direction is given twice.
    """
    result: dict[str, str] = {}
    for value in values:
        name, named, amount = value.rpartition("=")
        new = {name.strip(): amount} if named else {"input": amount, "output": amount}
        if twice := result.keys() & new.keys():
            raise UsageError(
                f"--late gives the lateness of {' and '.join(f'{each}s' for each in sorted(twice))} twice",
                "give it once: --late 20ms, or --late input=1ms --late output=20ms",
            )
        result |= new
    return result


def split_definitions(definitions: Iterable[str]) -> tuple[dict[str, str], tuple[str, ...]]:
    """The constants that are set to one value each, and the texts of those that take several values."""
    settings = list(set_by(definitions))
    several = tuple(f"{name}={listed}" for name, listed in settings if len(grid_of([f"{name}={listed}"])) > 1)
    single = [f"{name}={listed}" for name, listed in settings if f"{name}={listed}" not in several]
    return parse_definitions(single), several


def _as_range(values: str) -> str:
    """Several values as `tachk sweep` takes them."""
    ends = re.fullmatch(r"(-?\d+)\s*(?:\.\.\.?|:)\s*(-?\d+)", values)
    if ends:
        return f"{ends[1]}..{ends[2]}"
    return values if "," in values else "LOW..HIGH"


def parse_size(text: str) -> int:
    """``500M``, ``2GB``, ``1.5 GiB`` as bytes. Raises UsageError."""
    match = re.fullmatch(rf"\s*({DIGITS}(?:\.{DIGITS})?)\s*([KMG]I?|)B?\s*", text.upper())
    if match is None:
        raise UsageError(f"{text!r} is not a size", "write it like 500M, 2G or 4GiB")
    size = int(Fraction(match[1]) * _SIZES[match[2]])
    if size < 1:
        raise UsageError(f"a limit of {text} leaves no memory", "write it like 500M, 2G or 4GiB")
    return size
