from __future__ import annotations

from pathlib import Path

import pytest

from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.frontend.unused_names import unused_names

P = "process P() { init location a; }\nsystem P;"


def found(text: str) -> list[tuple[str, str]]:
    loaded = load_model(Source("m.ta", text))
    return [(finding.code, finding.span.text) for finding in unused_names(loaded.items, loaded.document.items)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("int n;", [("W0608", "n")]),
        ("int n[2] = {1, 2}, m;", [("W0608", "n"), ("W0608", "m")]),
        ("const int N = 3; int n[N];", [("W0608", "n")]),
        ("const int N = 3;", [("W0608", "N")]),
        ("typedef int[0,3] t;", [("W0608", "t")]),
        ("typedef int[0,3] t; t v;", [("W0608", "v")]),
        ("chan c;", [("W0608", "c")]),
        ("clock x;", [("W0608", "x")]),
        ("int f() { return 1; }", [("W0608", "f")]),
        ("int n; int f() { return n; } int k = 0;", [("W0608", "f"), ("W0608", "k")]),
    ],
)
def test_what_nothing_uses(text: str, expected: list[tuple[str, str]]) -> None:
    assert found(f"{text}\n{P}") == expected


@pytest.mark.parametrize(
    ("edge", "expected"),
    [
        ("assign n = 1;", [("W0609", "n")]),
        ("assign n++;", [("W0609", "n")]),
        ("assign n += 2;", [("W0609", "n")]),
        ("assign n = n + 1;", []),
        ("assign a[n] = 1, n = 0;", [("W0609", "a")]),
        ("guard n > 0;", []),
        ("assign f();", [("W0609", "n")]),
        ("assign a[n++] = 1;", [("W0609", "a")]),
        ("assign n = a[0];", [("W0609", "n")]),
        ("assign x = 0;", [("W0609", "n"), ("W0609", "x")]),
        ("guard x > 1; assign x = 0;", [("W0609", "n")]),
    ],
)
def test_what_is_written_but_never_read(edge: str, expected: list[tuple[str, str]]) -> None:
    text = f"""process P() {{ int n; int a[2]; clock x; void f() {{ n = 1; }}
        init location l {{ to l {{ {edge} }} }} }}
    system P;"""
    assert [finding for finding in found(text) if finding[0] == "W0609"] == expected


@pytest.mark.parametrize(
    "reader",
    [
        "property p : A[] P.n <= 1;",
        "property p : G[0, 3] P.n <= 1;",
        'property p "it" : A[] P.a || P.n > 0 expect fails;',
        "signal s = P.n;",
    ],
)
def test_a_property_or_a_signal_reads(reader: str) -> None:
    text = f"process P() {{ int n; init location a {{ to a {{ assign n = 1; }} }} }}\nsystem P;\n{reader}"
    assert found(text) == []


def test_what_an_imported_file_declares_is_its_own_matter(tmp_path: Path) -> None:
    folder = tmp_path
    (folder / "lib.ta").write_text("const int UNUSED = 1; int shared;\n", encoding="utf-8")
    (folder / "m.ta").write_text(f'import "lib.ta";\nint own;\n{P}', encoding="utf-8")
    loaded = load_model(str(folder / "m.ta"), {})
    assert [d.span.text for d in unused_names(loaded.items, loaded.document.items)] == ["own"]
