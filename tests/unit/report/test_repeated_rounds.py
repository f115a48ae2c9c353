from __future__ import annotations

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from tachk.meaning.run_view import ProcessMove, Snapshot, TransitionView, ViewStep
from tachk.report.run.trace_text import Round, Single, fold_rounds

EMPTY = Snapshot((), ())


def steps(word: str, delays: dict[str, int] | None = None) -> list[ViewStep]:
    """One step for each letter; the letter names the process that moves."""
    waits = delays or {}
    return [
        ViewStep(
            Fraction(waits.get(letter, 0)),
            TransitionView("", (ProcessMove(letter, "a", "a", None, (), "", "", ()),)),
            EMPTY,
        )
        for letter in word
    ]


def shown(items: tuple[Single | Round, ...], word: str) -> str:
    return "".join(
        word[item.number] if isinstance(item, Single) else f"{item.times}({shown(item.block, word)})" for item in items
    )


def folded(word: str, delays: dict[str, int] | None = None) -> str:
    return shown(fold_rounds(steps(word, delays)), word)


def test_rounds_are_put_together_where_that_saves_four_steps() -> None:
    assert folded("xabababaz") == "x3(ab)az"
    assert folded("abab") == "abab"
    assert folded("aaaa") == "aaaa"
    assert folded("aaaaa") == "5(a)"
    assert folded("abcdabcd") == "2(abcd)"


def test_rounds_of_rounds_are_found() -> None:
    word = "wxabababyabababyabababyz"
    assert folded(word) == "wx3(3(ab)y)z"


def test_a_round_begins_by_waiting_where_it_can() -> None:
    assert folded("sdrsdrsdrsdx", {"r": 200}) == "sd3(rsd)x"


def test_delays_distinguish_rounds() -> None:
    run = steps("ababab")
    run[2] = ViewStep(Fraction(1), run[2].event, EMPTY)
    assert all(isinstance(item, Single) for item in fold_rounds(run))


@given(st.text("abc", max_size=60))
def test_nothing_is_lost_or_reordered(word: str) -> None:
    def unfolded(items: tuple[Single | Round, ...]) -> str:
        return "".join(
            word[item.number] if isinstance(item, Single) else unfolded(item.block) * item.times for item in items
        )

    items = fold_rounds(steps(word))
    assert unfolded(items) == word
    assert sum(item.length for item in items) == len(word)
