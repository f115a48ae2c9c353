"""Files, imports, constants from outside, strict XTA."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model

PROCESS = "process P() { state s; init s; }\n"


def write(folder: Path, **files: str) -> Path:
    """Writes NAME.ta files; returns the path of main.ta."""
    for name, text in files.items():
        (folder / f"{name}.ta").write_text(text, encoding="utf-8")
    return folder / "main.ta"


def codes(path: Path) -> list[tuple[str, str]]:
    with pytest.raises(InputError) as caught:
        load_model(path)
    return [(d.code, d.span.text) for d in caught.value.diagnostics]


def test_an_import_brings_in_everything(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        main='import "lib.ta";\nint[0,N] n;\nsystem P;\nproperty q : A[] zero;',
        lib=f'time_unit = 1 ms; const int N = 3; {PROCESS} signal zero = n == 0; property p "t" : E<> P.s;',
    )
    loaded = load_model(path)
    assert [q.name for q in loaded.queries] == ["p", "q"]
    assert [s.name for s in loaded.network.signals] == ["zero"]
    assert loaded.network.time_unit == "1 ms"
    assert loaded.network.constants == (("N", 3),)


def test_a_file_is_read_once(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        main=f'import "left.ta"; import "right.ta"; import "base.ta"; int c = L + R;\n{PROCESS}system P;',
        left='import "base.ta"; const int L = B;',
        right='import "base.ta"; const int R = B + 1;',
        base="const int B = 4;",
    )
    assert load_model(path).network.variables[0].initial == (9,)


def test_imports_are_relative_to_the_importing_file(tmp_path: Path) -> None:
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "a.ta").write_text('import "b.ta";', encoding="utf-8")
    (tmp_path / "lib" / "b.ta").write_text("const int B = 4;", encoding="utf-8")
    path = write(tmp_path, main=f'import "lib/a.ta"; int c = B;\n{PROCESS}system P;')
    assert load_model(path).network.variables[0].initial == (4,)


def test_findings_in_imported_files_name_the_file(tmp_path: Path) -> None:
    path = write(tmp_path, main=f'import "lib.ta";\n{PROCESS}system P;', lib="int a = b;")
    with pytest.raises(InputError) as caught:
        load_model(path)
    (found,) = caught.value.diagnostics
    assert found.span.source.name.endswith("lib.ta")


def test_circular_imports_are_rejected(tmp_path: Path) -> None:
    path = write(tmp_path, main=f'import "a.ta";\n{PROCESS}system P;', a='import "b.ta";', b='import "a.ta";')
    assert codes(path) == [("E0416", 'import "a.ta";')]
    path = write(tmp_path, main=f'import "main.ta";\n{PROCESS}system P;')
    assert codes(path) == [("E0416", 'import "main.ta";')]


def test_missing_and_broken_imports(tmp_path: Path) -> None:
    path = write(tmp_path, main=f'import "none.ta";\nimport "bad.ta";\n{PROCESS}system P;', bad="int a b;")
    assert [code for code, _ in codes(path)] == ["E0415", "E0101"]


def test_an_imported_file_has_no_system_line(tmp_path: Path) -> None:
    path = write(
        tmp_path, main=f'import "lib.ta";\n{PROCESS}system P;', lib="process Q() { state s; init s; }\nsystem Q;"
    )
    assert codes(path) == [("E0411", "system Q;")]


def test_missing_file() -> None:
    with pytest.raises(UsageError, match="no_such_file"):
        load_model("no_such_file.ta")


CONSTANTS = "const int N = 3; const int[0,9] M = N; const bool B = false; const int A[2] = {1, 2}; int v;\n"


@pytest.mark.parametrize(
    ("constants", "expected"),
    [
        ({}, {"N": 3, "M": 3, "B": 0}),
        ({"N": 5}, {"N": 5, "M": 5, "B": 0}),
        ({"N": "2 * 2", "M": "N + 1", "B": True}, {"N": 4, "M": 5, "B": 1}),
        ({"B": "true"}, {"N": 3, "M": 3, "B": 1}),
        ({"N": -7, "M": 0}, {"N": -7, "M": 0, "B": 0}),
        ({"N": 100000, "M": 1}, {"N": 100000, "M": 1, "B": 0}),
    ],
)
def test_constants_from_outside(load: Any, constants: dict[str, Any], expected: dict[str, int]) -> None:
    assert dict(load(CONSTANTS + PROCESS, **constants).network.constants) == expected


@pytest.mark.parametrize(
    ("constants", "code"),
    [
        ({"M": 10}, "E0603"),
        ({"N": "v"}, "E0201"),
        ({"N": "B +"}, None),
        ({"A": 3}, "E0608"),
        ({"N": "M"}, "E0201"),
    ],
)
def test_wrong_constants_from_outside(load: Any, constants: dict[str, Any], code: str | None) -> None:
    with pytest.raises(InputError) as caught:
        load(CONSTANTS + PROCESS, **constants)
    first = caught.value.diagnostics[0]
    assert first.span.source.name == f"-D {next(iter(constants))}"
    assert code is None or first.code == code


@pytest.mark.parametrize(("word", "meant"), [("yes", "true"), ("Off", "false"), ("True", "true")])
def test_a_boolean_constant_from_outside_has_two_words(load: Any, word: str, meant: str) -> None:
    with pytest.raises(InputError) as caught:
        load(CONSTANTS + PROCESS, B=word)
    assert caught.value.diagnostics[0].message == f"unknown name `{word}`"
    assert caught.value.diagnostics[0].help == f"a Boolean value is `{meant}`"


def test_unknown_constants_from_outside(load: Any) -> None:
    with pytest.raises(UsageError) as caught:
        load("const int MESSAGES = 3;\n" + PROCESS, MESAGES=4)
    assert caught.value.help == "did you mean `MESSAGES`?"
    with pytest.raises(UsageError, match="variable"):
        load(CONSTANTS + PROCESS, v=4)


def test_strict_xta_rejects_the_additions() -> None:
    plain = Source("m.xta", f"const int N = 3; {PROCESS}system P;")
    assert load_model(plain, strict_xta=True).network.constants == (("N", 3),)
    added = Source("m.ta", f"time_unit = 1 ms; {PROCESS}system P; property p : E<> P.s; signal a = 1;")
    with pytest.raises(InputError) as caught:
        load_model(added, strict_xta=True)
    assert {d.code for d in caught.value.diagnostics} == {"E0112"}


def test_strict_xta_leaves_the_queries_of_xml_alone() -> None:
    text = """<nta><template><name>P</name><location id="id0"><name>A</name></location><init ref="id0"/></template>
<system>system P;</system><queries><query><formula>A[] P.A</formula><comment/></query></queries></nta>"""
    assert len(load_model(Source("m.xml", text), strict_xta=True).queries) == 1


def test_words_of_the_additions_stay_names(load: Any) -> None:
    text = (
        "int location, property, signal, to, guarded; process to_() { int invariant, expect; state init_; init init_; }"
    )
    names = [v.name for v in load(text + "\nsystem to_;").network.all_variables()]
    assert names == ["location", "property", "signal", "to", "guarded", "to_.invariant", "to_.expect"]


def test_progress_and_gantt_have_no_meaning(load: Any) -> None:
    assert load(f"int n; {PROCESS} progress {{ n; }}\nsystem P;\n").warnings == ()


def test_a_contextual_keyword_may_name_a_type_of_an_imported_file(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        main='import "middle.ta";\nsignal x = 3;\nlocation there = 1;\nspawn more(int a) { return 2; }\n'
        "process P() { location here; state s; init s; trans s -> s { assign here = there, x = more(1); }; }\n"
        "system P;\nproperty p : A[] x <= 3;",
        middle='import "types.ta";',
        types="typedef int[0,5] signal, location, spawn;",
    )
    network = load_model(path).network
    assert network.signals == ()
    assert [variable.name for variable in network.variables] == ["x", "there"]
    assert [location.name for location in network.processes[0].locations] == ["s"]


def test_findings_are_reported_in_the_order_of_the_lines() -> None:
    text = "Clock x;\nProcess P() {\n    init location a;\n}\nSystem P;\n"
    with pytest.raises(InputError) as caught:
        load_model(Source("m.ta", text))
    assert [str(found.span) for found in caught.value.diagnostics] == ["m.ta:1:1", "m.ta:2:1", "m.ta:5:1"]


def test_findings_of_xml_are_reported_in_the_order_of_the_file() -> None:
    text = """<nta><declaration>int a = b;</declaration>
<template><name>P</name><declaration>int c = d;</declaration>
<location id="id0"><name>A</name><label kind="invariant">e &lt; 3</label></location><init ref="id0"/>
<transition><source ref="id0"/><target ref="id0"/><label kind="guard">f &gt; 3</label></transition></template>
<system>Q = R();
system P, Q;</system></nta>"""
    with pytest.raises(InputError) as caught:
        load_model(Source("m.xml", text))
    places = [found.span.in_file.start for found in caught.value.diagnostics]
    assert len(places) >= 4
    assert places == sorted(places)
