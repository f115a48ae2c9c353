"""`tachk diff`."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Mapping

from tachk import api
from tachk.cli.arguments import parse_definitions
from tachk.cli.exit_status import ExitStatus
from tachk.diagnostics.diagnostic import InputError, UsageError
from tachk.formats.difference import least_difference, print_difference
from tachk.formats.plain.expansion import expand, expand_document
from tachk.formats.plain.plain_model import PlainModel
from tachk.loading.model_files import read_model
from tachk.syntax.source_files import read_source


def run_diff(before: str, after: str, definitions: Iterable[str] = ()) -> ExitStatus:
    """Prints what is different in the behaviour of two models; nothing if nothing is.

    Args:
        definitions: values of constants, for both.
    """
    changes = least_difference(*_models(before, after, parse_definitions(definitions)))
    sys.stdout.write(print_difference(changes))
    return ExitStatus.DIFFERENT if changes else ExitStatus.AS_EXPECTED


def _models(before: str, after: str, constants: Mapping[str, str]) -> tuple[PlainModel, PlainModel]:
    """Both models in full, or both as their files say where one of them cannot be loaded and no constant is set.

    A version that git hands over stands alone, away from the files that it imports.
    """
    if os.devnull not in (before, after):
        try:
            first, second = api.load(before, **constants), api.load(after, **constants)
        except InputError:
            if constants:
                raise
        else:
            return (
                expand(first.loaded, first.definitions, repair_names=False),
                expand(second.loaded, second.definitions, repair_names=False),
            )
    elif constants:
        raise UsageError("-D sets constants of two models, and one of these is no file")
    return _as_written(before), _as_written(after)


def _as_written(path: str) -> PlainModel:
    """The model of a file, imports not followed; nothing for the file that is not there."""
    return expand_document(None if path == os.devnull else read_model(read_source(path)).document)
