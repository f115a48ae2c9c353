"""Expectations that depend on constants: what they say, where they are kept, what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.formats.plain.expansion import expand
from tachk.formats.uppaal.query_file import print_queries
from tachk.formats.uppaal.writer import print_uppaal
from tachk.frontend.loaded import LoadedModel
from tachk.model.query import Expectation
from tachk.syntax.parsing.parser import parse_document
from tachk.syntax.printing.printer import print_document
from tests.support.queries import elaborate_queries

MODEL = """\
const int WAIT = 9;
const int WRITE = 10;
const bool CAREFUL = false;

process P() {
    clock x;

    init location A {
        to B { guard x >= WAIT && x < WRITE; }
    }

    location B;
}

system P;

property never "never in B" : A[] !P.B expect fails if WAIT < WRITE else holds;
property chain : E<> P.B expect holds if CAREFUL else fails if WAIT >= WRITE else holds;
property plain : E<> P.A expect holds;
"""


def outcomes(loaded: LoadedModel) -> dict[str, tuple[str | None, bool]]:
    return {q.name: (None if q.expectation is None else q.expectation.value, q.conditional) for q in loaded.queries}


def xml_of(loaded: LoadedModel) -> str:
    return print_uppaal(loaded, expand(loaded), loaded.layout)


def test_the_condition_is_computed_with_the_values_that_constants_have(load: Any) -> None:
    assert outcomes(load(MODEL)) == {"never": ("fails", True), "chain": ("holds", True), "plain": ("holds", False)}
    longer = outcomes(load(MODEL, WAIT=10))
    assert longer == {"never": ("holds", True), "chain": ("fails", True), "plain": ("holds", False)}
    assert outcomes(load(MODEL, WAIT=10, CAREFUL=True))["chain"] == ("holds", True)


def test_a_system_says_it_of_imported_properties(tmp_path: Path) -> None:
    (tmp_path / "lib.ta").write_text("property p : A[] not P.B;\nproperty q : E<> P.B;\n", encoding="utf-8")
    main = tmp_path / "main.ta"
    text = MODEL.partition("property")[0] + 'import "lib.ta";\nexpect p, q holds if WAIT < 10 else fails;\n'
    main.write_text(text, encoding="utf-8")
    assert outcomes(load_model(main)) == {"p": ("holds", True), "q": ("holds", True)}
    assert outcomes(load_model(main, {"WAIT": 20})) == {"p": ("fails", True), "q": ("fails", True)}


def test_it_is_printed_as_it_is_read() -> None:
    text = MODEL + "\nexpect never, chain fails if WAIT < WRITE else holds;\n"
    document, diagnostics = parse_document(Source("m.ta", text))
    assert document is not None
    assert not diagnostics
    assert print_document(document) == text


def test_it_survives_uppaals_xml(load: Any) -> None:
    xml = xml_of(load(MODEL))
    again = load_model(Source("m.xml", xml))
    assert outcomes(again) == outcomes(load(MODEL))
    assert outcomes(load_model(Source("m.xml", xml), {"WAIT": 10})) == outcomes(load(MODEL, WAIT=10))
    assert [(q.name, q.title) for q in again.queries] == [("never", "never in B"), ("chain", ""), ("plain", "")]
    assert xml_of(again) == xml


def test_a_constant_with_another_name_in_uppaal_has_it_in_the_condition_too(load: Any) -> None:
    text = MODEL.replace("CAREFUL", "query")
    xml = xml_of(load(text))
    assert "const bool query_1 = false;" in xml
    assert outcomes(load_model(Source("m.xml", xml), {"query_1": True, "WAIT": 10}))["chain"] == ("holds", True)


def test_a_query_file_gets_the_outcome_for_the_values(load: Any) -> None:
    text = print_queries(expand(load(MODEL, WAIT=10), ["WAIT"]).queries)
    assert [line for line in text.splitlines() if "EXPECT" in line] == [
        "/* EXPECT:T */",
        "/* EXPECT:F */",
        "/* EXPECT:T */",
    ]


def test_a_query_can_have_one(load: Any) -> None:
    ((query,), _) = elaborate_queries(load(MODEL), "E<> P.B expect fails if WAIT > 9 else holds")
    assert query.expectation is Expectation.HOLDS


@pytest.mark.parametrize(
    ("expectation", "code", "place"),
    [
        ("fails if WAIT < 3", "E0101", ";"),
        ("fails if P.x < 3 else holds", "E0601", "P.x"),
        ("fails if WAIT else holds if nobody else fails", "E0201", "nobody"),
        ("fails if 1 / 0 else holds", "E0602", "1 / 0"),
    ],
)
def test_what_is_wrong_with_one(load: Any, expectation: str, code: str, place: str) -> None:
    with pytest.raises(InputError) as caught:
        load(MODEL.replace("expect holds;", f"expect {expectation};"))
    assert [(found.code, found.span.text) for found in caught.value.diagnostics] == [(code, place)]
