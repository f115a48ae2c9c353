"""`tachk diff`: show how the behaviour of two models differs."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.base.plain_data import PlainData
from tachk.base.records import replace
from tachk.cli import options
from tachk.cli.destination import destination
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.cli.reporting import Reporting
from tachk.syntax.source_files import read_source

if TYPE_CHECKING:
    from tachk.api import model as api
    from tachk.formats.plain.plain_model import PlainModel


_PLAIN = PlainData({})


@click.command(name="diff")
@click.argument("before", metavar="A", type=click.Path(), help="A model.")
@click.argument("after", metavar="B", type=click.Path(), help="The same model, changed.")
@options.definitions
@options.max_seconds()
@options.report("text", "json")
def command(before: str, after: str, definitions: tuple[str, ...], seconds: float | None, **given: Any) -> None:
    """Show how the behaviour of two models differs. Layout, comments and most order do not count.

    Exit status: 0 no difference, 1 some difference.
    """

    (reporting,) = distributed(given, Reporting)
    options.finish(lambda: run_diff(before, after, definitions, reporting), seconds)


def run_diff(
    before: str, after: str, definitions: Iterable[str] = (), reporting: Reporting = Reporting()
) -> ExitStatus:
    """Prints the differences in the behaviour of two models; nothing if nothing is.

    Args:
        definitions: values of constants, for both.
    """
    from tachk.cli.arguments import parse_definitions
    from tachk.formats.difference import least_difference, print_difference

    changes = least_difference(*_models(before, after, parse_definitions(definitions)))
    with destination(reporting.output, reporting.quiet) as out:
        if out is not None and reporting.form == "json":
            json.dump(
                {"before": before, "after": after, "changes": [_PLAIN.of(each) for each in changes]}, out, indent=2
            )
            out.write("\n")
        elif out is not None:
            out.write(print_difference(changes))
    return ExitStatus.DIFFERENT if changes else ExitStatus.AS_EXPECTED


def _models(before: str, after: str, constants: Mapping[str, str]) -> tuple[PlainModel, PlainModel]:
    """Both models in full, or both as their files say where one of them cannot be loaded and no constant is set.

    A version that git hands over stands alone, away from the files that it imports.
    """
    from tachk.api import model as api

    if os.devnull not in (before, after):
        try:
            first, second = api.load(before, **constants), api.load(after, **constants)
        except InputError:
            if constants:
                raise
        else:
            return _expanded(first), _expanded(second)
    elif constants:
        raise UsageError("-D sets constants of two models, and one of these is not a file")
    return _as_written(before), _as_written(after)


def _expanded(model: api.Model) -> PlainModel:
    """The model in full. A query that no model can have stands in the list of a XML file and in a comment of a text."""
    from tachk.formats.plain.expansion import expand
    from tachk.formats.uppaal.query_asides import wrong_query_in

    loaded = model.loaded
    plain = expand(loaded, model.definitions, repair_names=False)
    wrong = {query.name: query.text for query in loaded.unchecked if query.is_wrong}
    in_comments = (wrong_query_in(comment.text) for comment in loaded.document.comments)
    texts = [*wrong.values(), *(text for text in in_comments if text is not None)]
    right_queries = tuple(query for query in plain.queries if query.name not in wrong)
    return replace(plain, queries=right_queries, wrong=tuple(" ".join(text.split()) for text in texts))


def _as_written(path: str) -> PlainModel:
    """The model of a file, imports not followed; nothing for the file that is not there."""
    from tachk.formats.loading.model_files import read_model
    from tachk.formats.plain.expansion import expand_document

    return expand_document(None if path == os.devnull else read_model(read_source(path)).document)
