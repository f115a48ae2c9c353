"""What differs between two models, and what does not count."""

from __future__ import annotations

import pytest

from tachk.base.span import Source
from tachk.formats.difference import difference, print_difference
from tachk.formats.loading.load import load_model
from tachk.formats.plain.expansion import expand, expand_document
from tachk.formats.plain.plain_model import PlainModel
from tachk.syntax.parsing.parser import parse_document

MODEL = """\
const int N = 3, M = 1;
chan c;
void f() { int i = N; }
process P(const int[0, 1] k) {
    clock x;
    init location A { invariant x <= N; to B { guard x > 1; sync c!; } to B; }
    location B { to A { assign x = 0; } }
}
process Q() { init location A { to A { sync c?; } } }
system P, Q;
property one : A[] P(0).x <= 5 expect holds;
"""


def plain(text: str) -> PlainModel:
    return expand(load_model(Source("model.ta", text)), repair_names=False)


def text_of(after: str, before: str = MODEL) -> str:
    return print_difference(difference(plain(before), plain(after)))


CHOICE = MODEL.replace(
    "to B; }",
    "to Choice { guard x > 2; } }\n    branchpoint Choice { to B { probability 2; } to A { probability 1; } }",
)


def test_names_of_branchpoints_do_not_count() -> None:
    assert text_of(CHOICE.replace("Choice", "Other"), CHOICE) == ""
    assert (
        text_of(CHOICE.replace("probability 2", "probability 3"), CHOICE)
        == """\
template P
  ~ edge after_A -> B
      - probability 2;
      + probability 3;
"""
    )


SAME = {
    "the time unit": f"time_unit = 3 s;\n{MODEL}",
    "comments and layout": MODEL.replace("chan c;", "// a channel\nchan   c;").replace(
        "init location A {", "/// doc\ninit location A\n{"
    ),
    "order of declarations": MODEL.replace(
        "const int N = 3, M = 1;\nchan c;", "chan c;\nconst int M = 1;\nconst int N = 3;"
    ),
    "order of edges": MODEL.replace("to B { guard x > 1; sync c!; } to B;", "to B; to B { guard x > 1; sync c!; }"),
    "spelling": MODEL.replace("assign x = 0", "assign x := 0").replace("x > 1;", "(x > 1);"),
    "names of properties": MODEL.replace("property one", "property two"),
    "classic form": MODEL.replace(
        "init location A { to A { sync c?; } }", "state A; init A; trans A -> A { sync c?; };"
    ),
}


@pytest.mark.parametrize("what", SAME)
def test_what_does_not_count(what: str) -> None:
    assert text_of(SAME[what]) == ""


def test_changes() -> None:
    after = (
        MODEL.replace("N = 3", "N = 4")
        .replace("int i = N", "int i = M")
        .replace("invariant x <= N; ", "")
        .replace("guard x > 1", "guard x > 2")
        .replace("to B;", "")
        .replace("location B {", "urgent location B { to C;")
        .replace("process Q", "process R() { init location A; }\nprocess Q")
        .replace("    clock x;", "    clock x;\n    int n;")
        .replace("system P, Q", "system Q, P")
        .replace("expect holds", "expect fails")
    ).replace("urgent location B", "location C;\n    urgent location B")
    assert (
        text_of(after)
        == """\
declarations
  ~ N
      - const int N = 3
      + const int N = 4
  ~ f()
      - void f() {
      -     int i = N;
      - }
      + void f() {
      +     int i = M;
      + }
template P
  + n: int n
  ~ location A
      - init; invariant x <= N
      + init
  ~ location B
      - (nothing)
      + urgent
  + location C
  ~ edge A -> B
      - guard x > 1; sync c!;
      + guard x > 2; sync c!;
  - edge A -> B
  + edge B -> C
template R
  + the template: 1 location
system
  ~ system line
      - P, Q
      + Q, P
properties
  ~ A[] P(0).x <= 5
      - expect holds
      + expect fails
"""
    )


def test_a_document_by_itself() -> None:
    document, _ = parse_document(Source("model.ta", 'import "gone.ta";\n' + MODEL))
    changes = difference(expand_document(document), plain(MODEL))
    assert changes == ()
    assert {change.where for change in difference(expand_document(None), expand_document(document))} == {
        "declarations",
        "template P",
        "template Q",
        "system",
        "properties",
    }
