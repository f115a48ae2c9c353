"""Ctrl-C in a part of an answer that is not the answer itself: nothing further is begun, and the status says so."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

import tachk
from tachk.base.job import is_interrupted, note_interruption, remembering_interruption
from tachk.cli.main import app
from tachk.verify import verify as verifying
from tachk.verify.verdict import Answer
from tachk.verify.verify import verify

MODEL = """
clock x;
process P() {
    init location a { invariant x <= 1; to b { guard x >= 1; } }
    committed location b { to a { assign x = 0; } }
}
system P;
property first : G (P.b -> F[0, 5] P.a);
property second : G (P.b -> F[0, 6] P.a);
property third : A[] not deadlock;
property fourth : A[] x <= 1;
"""


@pytest.fixture(autouse=True)
def _model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("m.ta").write_text(MODEL, encoding="utf-8")


def interrupted(*_: Any, **__: Any) -> Any:
    raise KeyboardInterrupt


def never(*_: Any) -> Any:
    pytest.fail("a proof was begun")


def interrupt_notes(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Lets Ctrl-C come in the search for a note about a formula. Returns the number of queries of each `_verified`."""
    plainly, verified, analysed = verifying._decided_plainly, verifying._verified, verifying._analysed
    asked: list[int] = []

    def count(network: Any, queries: Any, *others: Any) -> Any:
        asked.append(len(queries))
        return verified(network, queries, *others)

    def in_note(*arguments: Any) -> Any:
        monkeypatch.setattr(verifying, "_analysed", interrupted)
        try:
            return plainly(*arguments)
        finally:
            monkeypatch.setattr(verifying, "_analysed", analysed)

    monkeypatch.setattr(verifying, "_decided_plainly", in_note)
    monkeypatch.setattr(verifying, "_verified", count)
    return asked


def test_the_answers_are_kept_and_the_job_remembers(monkeypatch: pytest.MonkeyPatch) -> None:
    interrupt_notes(monkeypatch)
    model = tachk.load("m.ta")
    network, queries = model.network, model.loaded.queries
    with remembering_interruption():
        found = verify(network, queries)
        assert {each.answer for each in found} == {Answer.HOLDS}
        assert is_interrupted()
        assert {each.reason for each in verify(network, queries)} == {"interrupted"}
    # Another job is not interrupted.
    assert not is_interrupted()
    monkeypatch.undo()
    assert {each.answer for each in verify(network, queries)} == {Answer.HOLDS}


def test_verifyta_begins_no_further_query(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = interrupt_notes(monkeypatch)
    result = CliRunner().invoke(app, ["verifyta", "m.ta"])
    assert result.exit_code == 130
    assert "Verifying formula 2" not in result.stdout
    assert len(asked) == 2  # the formula and its note


@pytest.mark.parametrize("command", [("verify", "m.ta", "m.ta"), ("report", "m.ta", "-o", "page.html")])
def test_the_status_of_answers_whose_notes_are_missing(
    command: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    interrupt_notes(monkeypatch)
    result = CliRunner().invoke(app, command)
    assert result.exit_code == 130
    if command[0] == "report":
        assert "fourth" in Path("page.html").read_text(encoding="utf-8")
    else:
        assert result.stdout.count("4 passed") == 1  # the second model is not looked at


def test_a_page_with_interrupted_properties(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(verifying, "_analysed", interrupted)
    result = CliRunner().invoke(app, ["report", "m.ta", "-o", "page.html"])
    assert result.exit_code == 130
    assert "interrupted" in Path("page.html").read_text(encoding="utf-8")


def test_no_proof_is_begun_after_an_interruption(monkeypatch: pytest.MonkeyPatch) -> None:
    interrupt_notes(monkeypatch)
    monkeypatch.setattr("tachk.verify.certificates._proof", never)
    result = CliRunner().invoke(app, ["verify", "m.ta", "--certificate", "proofs.tck"])
    assert (result.exit_code, Path("proofs.tck").exists()) == (130, False)
    assert "no proofs: interrupted" in result.stderr


def test_the_proof_that_is_made_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    begun: list[str] = []

    def proof(network: Any, model: str, query: Any, *others: Any) -> str:
        begun.append(query.name)
        note_interruption()  # as a search does that Ctrl-C ends
        return "interrupted"

    monkeypatch.setattr("tachk.verify.certificates._proof", proof)
    result = CliRunner().invoke(app, ["verify", "m.ta", "--certificate", "proofs.tck"])
    assert (result.exit_code, Path("proofs.tck").exists(), begun) == (130, False, ["first"])
    assert result.stderr == "error: proofs.tck: not written: interrupted\n"
