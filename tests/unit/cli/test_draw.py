"""`tachk draw` writes the pictures asked for, and follows imports and side files."""

from __future__ import annotations

from pathlib import Path

import pytest

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.commands.draw import run_draw
from tachk.cli.exit_status import ExitStatus
from tachk.formats.layout.placement.template import place_template
from tachk.formats.layout_json import layout_path, layout_to_json
from tachk.report.pictures import draw, draw_file
from tachk.syntax import ast
from tachk.syntax.parsing.parser import parse_document
from tachk.syntax.picture_layout import Layout
from tachk.syntax.source_files import read_source


@pytest.fixture
def model(tmp_path: Path) -> Path:
    (tmp_path / "lamp.ta").write_text("process Lamp() { init location Off { to On; } location On; }")
    whole = tmp_path / "whole.ta"
    whole.write_text('import "lamp.ta"; process User() { init location Idle; } system Lamp, User;')
    return whole


def test_each_template_has_a_file_imported_ones_too(model: Path, tmp_path: Path) -> None:
    assert run_draw(str(model), tmp_path / "out", None) is ExitStatus.AS_EXPECTED
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["Lamp.svg", "User.svg"]


def test_one_file_holds_all_templates_or_the_one_requested(model: Path, tmp_path: Path) -> None:
    run_draw(str(model), tmp_path / "all.svg", None)
    run_draw(str(model), tmp_path / "user.svg", "User")
    assert ">On<" in (tmp_path / "all.svg").read_text() and ">Idle<" in (tmp_path / "all.svg").read_text()
    assert ">On<" not in (tmp_path / "user.svg").read_text()


def test_an_unknown_template_is_named_with_those_there_are(model: Path, tmp_path: Path) -> None:
    with pytest.raises(UsageError) as error:
        run_draw(str(model), tmp_path, "Usr")
    assert error.value.help == "the templates are Lamp, User"


def test_the_side_file_says_where_things_stand(model: Path, tmp_path: Path) -> None:
    lamp = tmp_path / "lamp.ta"
    document, _ = parse_document(read_source(lamp))
    assert document is not None
    (template,) = (item for item in document.items if isinstance(item, ast.Template))
    text = layout_to_json(Layout({"Lamp": place_template(template)}))
    before = draw(lamp).svg
    layout_path(lamp).write_text(text.replace("[0, 0]", "[0, 333]"))
    assert 'cy="333"' not in before
    assert 'cy="333"' in draw(lamp).svg


def test_png_is_a_picture_with_its_letters(model: Path, tmp_path: Path) -> None:
    run_draw(str(model), tmp_path / "a.png", "Lamp")
    run_draw(str(model), tmp_path / "a.svg", "Lamp")
    content = (tmp_path / "a.png").read_bytes()
    assert content.startswith(b"\x89PNG\r\n\x1a\n")
    nameless = (tmp_path / "lamp.ta").read_text().replace("On", "O_").replace("Off", "O__")
    (tmp_path / "lamp.ta").write_text(nameless)
    run_draw(str(model), tmp_path / "b.png", "Lamp")
    assert (tmp_path / "b.png").read_bytes() != content, "names are drawn"


def test_other_endings_are_rejected(model: Path, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"as \.svg or \.png"):
        run_draw(str(model), tmp_path / "a.jpg", None)
    assert not (tmp_path / "a.jpg").exists()


def test_constants_are_shown_as_their_values(tmp_path: Path) -> None:
    path = tmp_path / "m.ta"
    path.write_text(
        "const int N = 2, K = 3; clock x; process P() { init location A { to B { guard x >= N * K; } } location B; }"
        "process Q(int[0, 1] N) { init location A { invariant x <= N; } }"
    )
    pictures = {picture.name: picture.svg for picture in draw_file(path, {"N": "1 + 1"})}
    assert "x &gt;= (1 + 1) * K" in pictures["P"]
    assert "x &lt;= N" in pictures["Q"], "its own N"
    with pytest.raises(UsageError, match="no constant `M`"):
        draw_file(path, {"M": "1"})
