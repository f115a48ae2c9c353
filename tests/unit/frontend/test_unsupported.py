"""Constructs of statistical and refinement checking: read, named, refused, and printed as they were."""

from __future__ import annotations

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.syntax.parsing.parser import parse_document
from tachk.syntax.printing.printer import print_document

PROCESS = "process P() { init location s; }\nsystem P;\n"


def labels(text: str) -> str:
    return f"int n;\nprocess P() {{ init location s {{ to s {{ {text} }} }} }}\nsystem P;\n"


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("double f() { return sin(1.0); }\nint n = fint(f());\n" + PROCESS, "f"),
        ("typedef struct { hybrid clock h; } box;\n" + PROCESS, "hybrid clock"),
        ("before_update { 1 }\n" + PROCESS, "before_update { 1 }"),
        ("dynamic Q(int a);\nprocess Q(int a) { init location s; }\n" + PROCESS, "dynamic Q(int a);"),
        (labels("assign spawn Q(1, 2);"), "spawn Q(1, 2)"),
        (labels("assign exit();"), "exit()"),
        (labels("guard numOf(Q) > 1;"), "numOf(Q)"),
        (labels("guard random(2) > 1;"), "random(2)"),
        (labels("assign foreach (q : Q) n;"), "foreach (q : Q) n"),
    ],
)
def test_it_is_named_and_is_the_only_error(text: str, named: str) -> None:
    refusals = load_model(Source("m.ta", text)).refusals
    assert all(found.is_unsupported for found in refusals)
    assert refusals[0].span.text in (named, named.split("(")[0])


def test_io_declarations_are_named() -> None:
    with pytest.raises(InputError) as caught:
        load_model(Source("m.ta", "chan a, b;\nIO P { a?, b! }\n" + PROCESS))
    assert [found.is_unsupported for found in caught.value.diagnostics] == [True]


def test_progress_measures_are_read_and_mean_nothing() -> None:
    text = "int n;\n\nprocess P() {\n    init location s;\n}\n\nsystem P;\nprogress { n; n > 2 : n + 1; }\n"
    assert load_model(Source("m.ta", text)).warnings == ()
    document, _ = parse_document(Source("m.ta", text))
    assert document is not None
    assert print_document(document) == text


@pytest.mark.parametrize(
    "text", ["dynamic Q(int a);\n", labels("guard foreach (q : Q) q.s; assign n = 1, spawn Q(1);")]
)
def test_the_formatter_keeps_it(text: str) -> None:
    document, diagnostics = parse_document(Source("m.ta", text))
    assert document is not None, diagnostics
    again, _ = parse_document(Source("m.ta", print_document(document)))
    assert again == document


def test_the_words_stay_names() -> None:
    loaded = load_model(
        Source(
            "m.ta",
            "int dynamic, spawn, foreach, exit(int a) { return a; }\n".replace(", exit", ";\nint exit")
            + "typedef int[0,3] small;\nsmall dynamics(int a) { return 1; }\n"
            + labels("guard spawn + foreach == exit(dynamic);").replace("int n;\n", ""),
        )
    )
    assert loaded.network.processes[0].edges[0].guard is not None
