"""Natural requirements, each with what `verify` makes of it: an answer, or a refusal that names what to change."""

from __future__ import annotations

import pytest

import tachk

pytestmark = pytest.mark.drawn

MODEL = """
time_unit = 1 s;
bool p, q, r, a;
process P() { clock c;
    init location idle { invariant c <= 5; to busy { guard c >= 5; assign p = true, c = 0; } }
    location busy { invariant c <= 1; to done { guard c >= 1; assign q = true, a = true, c = 0; } }
    location done { invariant c <= 1; to idle { guard c >= 1; assign p = false, q = false, a = false, c = 0; } }
}
system P;
"""

ANSWERS = {
    "G (p -> F q)": True,
    "whenever p is true, eventually, q must be true.": True,
    "F r": False,
    "G F p": True,
    "r must occur.": False,
    "after p, q must occur.": True,
    "after p until a, r must occur.": False,
    "G (rise(p) -> F[6 s,8 s] rise(p))": True,
    "G (rise(p) -> F(0,7 s] rise(p))": True,
    "G (rise(p) -> F(0,6 s] rise(p))": False,
    "G (rise(p) -> F[7 s,7 s] rise(p)) && G (rise(p) -> F(0,8 s] rise(p))": True,
    "between p becomes true and q becomes true, r must not occur.": True,
    "between p and q becomes true, r must not occur.": True,
    "G (rise(p) -> F[0,1 s] (rise(q) && F[0,1 s] fall(q)))": True,
    "F[0,7 s] (p && F[0,1 s] q)": True,
    "G (rise(p) -> F[0,8 s] (q && rise(a)))": True,
    "between p and q, whenever r is true, within 2 s, a must be true.": True,
    "between p and q, r must occur at least every 3 s.": True,
    "G (p -> F[0,5 s] G q)": False,
    "F[0,10 s] G q": False,
    "(G r) -> (G a)": True,
    "G (q -> F[0,5 s] !rise(p))": True,
    "[](p -> <>[0,1] q)": True,
    # windows that end before now, and edges in the past
    "G (q -> O[1 s,2 s] p)": True,
    "G (rise(q) -> O[1 s,1 s] rise(p))": True,
    "G (rise(q) -> O[2 s,5 s] p)": False,
    "G (rise(q) -> O[0,1 s] rise(p))": True,
    "G (rise(q) -> O[0,1 s) rise(p))": False,
    "G (rise(q) -> O rise(p))": True,
    "G (rise(q) -> O fall(q))": False,
    "G (rise(p) -> O[0,5 s] fall(p))": False,  # the first time
    "G (rise(p) && O[1 s, inf) p -> q)": False,
    "G (rise(p) -> H[1 s,5 s] !p)": True,
    "G (rise(p) -> H[1 s,7 s] !p)": False,
    "G (O[1 s,1 s] rise(p) -> q)": True,
    "G (q -> !r && O[1 s,2 s] p)": True,
    "!F (q && H[1 s,2 s] !p)": True,
}

REFUSED = {
    "G (q -> (p S[1 s,2 s] a))": ("E0730", "window begin at 0"),
    "O[1 s,2 s] p": ("E0730", "window begin at 0"),
    "G (rise(H[0,3 s] p) -> q)": ("E0730", "split the requirement"),
    "G (q -> !p S[0,5 s] rise(r))": ("E0730", "split the requirement"),
    "G (rise(p) && O[1 s, 2 s] q -> O[0,5 s] fall(p))": ("E0730", "window begin at 0"),
    "G (P.c <= 5)": ("E0731", "A[]"),
}


@pytest.mark.parametrize(("text", "holds"), ANSWERS.items())
def test_answers(text: str, holds: bool) -> None:
    (verdict,) = tachk.loads(MODEL).verify(text)
    assert verdict.answer is (tachk.Answer.HOLDS if holds else tachk.Answer.FAILS)


@pytest.mark.parametrize(("text", "code", "help"), [(text, *said) for text, said in REFUSED.items()])
def test_rejections_name_the_smallest_change(text: str, code: str, help: str) -> None:
    (query,) = tachk.loads(MODEL).verify(text).record.not_checked
    (diagnostic,) = query.diagnostics
    assert diagnostic.code == code
    assert help in (diagnostic.help or "")
