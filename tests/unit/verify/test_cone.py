"""Networks in which a process counts for a reason that is easily overlooked: without it the answer would be wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

import tachk
from tachk import Answer
from tachk.engine.options import Options

TAKER = "process Taker() { init location U { to V { assign used = used + 1; } } location V; }"

HOLDS = {
    "a budget enables an urgent sender, which stops time": f"""
        int[0, 1] used = 0; urgent broadcast chan now;
        process Main() {{
            clock x;
            init location A {{ to Dead {{ guard used < 1; sync now!; }} to B {{ guard x >= 1; }} }}
            location B; location Dead;
        }}
        {TAKER}
        system Main, Taker;
    """,
    "a budget enables a partner over an urgent channel, which stops time": f"""
        int[0, 1] used = 0; urgent chan now;
        process Main() {{
            clock x;
            init location A {{ to Dead {{ sync now!; }} to B {{ guard x >= 1; }} }}
            location B; location Dead;
        }}
        process Partner() {{ init location A {{ to A {{ guard used < 1; sync now?; }} }} }}
        {TAKER}
        system Main, Partner, Taker;
    """,
    "a budget occurs in an invariant": f"""
        int[0, 1] used = 0;
        process Main() {{
            clock x;
            init location A {{ invariant x <= 0 || used >= 1; to B {{ guard x >= 1; }} to Dead {{ guard used < 1; }} }}
            location B; location Dead;
        }}
        {TAKER}
        system Main, Taker;
    """,
    "a budget forces a receiver": f"""
        int[0, 1] used = 0; broadcast chan go;
        process Main() {{ init location A {{ to B {{ guard kept; sync done?; }} }} location B; }}
        process Sender() {{ init location A {{ to C {{ sync go!; }} }} location C {{ to C {{ sync done!; }} }} }}
        process Hearer() {{
            init location H {{ to Lost {{ guard used < 1; sync go?; assign kept = false; }} }}
            location Lost;
        }}
        {TAKER}
        system Main, Sender, Hearer, Taker;
    """.replace("int[0, 1] used = 0; broadcast", "int[0, 1] used = 0; bool kept = true; chan done; broadcast"),
    "a budget forces a receiver for one value of its select variable": f"""
        int[0, 1] used = 0; bool kept = true; broadcast chan go[2];
        process Main() {{
            init location A {{ to C {{ sync go[1]!; }} }}
            location C {{ to B {{ guard kept; }} }}
            location B;
        }}
        process Hearer() {{
            init location H {{
                to Lost {{ select i : int[0, 1]; guard used < 1; sync go[i]?; assign kept = false; }}
                to Lost {{ select i : int[0, 1]; guard i == 0; sync go[i]?; assign kept = false; }}
            }}
            location Lost;
        }}
        {TAKER}
        system Main, Hearer, Taker;
    """,
    "a budget forces a receiver that only another budget would force as well": f"""
        int[0, 1] used = 0; int[0, 1] gone = 0; bool kept = true; broadcast chan go;
        process Main() {{
            init location A {{ to C {{ sync go!; }} }}
            location C {{ to B {{ guard kept; }} }}
            location B;
        }}
        process Hearer() {{
            init location H {{
                to Lost {{ guard used < 1; sync go?; assign kept = false; }}
                to Lost {{ guard gone < 1; sync go?; assign kept = false; }}
            }}
            location Lost;
        }}
        process Other() {{ init location U {{ to V {{ assign gone = gone + 1; }} }} location V; }}
        {TAKER}
        system Main, Hearer, Taker, Other;
    """,
    "a budget is given back": """
        int[0, 1] used = 1;
        process Main() { init location A { to B { guard used < 1; } } location B; }
        process Giver() {
            init location U { to U { guard used < 1; assign used = used + 1; } to V { assign used = 0; } } location V;
        }
        system Main, Giver;
    """,
    "a budget is lowered by one": """
        int[0, 1] used = 1;
        process Main() { init location A { to B { guard used < 1; } } location B; }
        process Giver() {
            init location U { to U { guard used < 1; assign used += 1; } to V { assign used += -1; } } location V;
        }
        system Main, Giver;
    """,
    "somebody waits until a budget is used up": f"""
        int[0, 1] used = 0;
        process Main() {{ init location A {{ to B {{ guard used >= 1; }} }} location B; }}
        {TAKER}
        system Main, Taker;
    """,
    "somebody waits until a budget is not left": f"""
        int[0, 1] used = 0;
        process Main() {{ init location A {{ to B {{ guard !(used < 1 && used <= 5); }} }} location B; }}
        {TAKER}
        system Main, Taker;
    """,
    "a function tells whether a budget is used up": f"""
        int[0, 1] used = 0;
        bool empty() {{ return used == 1; }}
        process Main() {{ init location A {{ to B {{ guard empty(); }} to A {{ guard used < 1; }} }} location B; }}
        {TAKER}
        system Main, Taker;
    """,
    "a budget is copied": f"""
        int[0, 1] used = 0; int n = 0;
        process Main() {{
            init location A {{ to A {{ assign n = used; }} to B {{ guard n == 1; }} to A {{ guard used < 1; }} }}
            location B;
        }}
        {TAKER}
        system Main, Taker;
    """,
    "a variable that is declared meta lasts": """
        meta int m = 0;
        process Main() { init location A { to B { guard m == 1; } } location B; }
        process Writer() { clock y; init location U { invariant y <= 3; to V { assign m = 1; } } location V; }
        system Main, Writer;
    """,
    "a receiver tells a later receiver something": """
        meta int m = 0; int n = 0; broadcast chan c;
        process Teller() { clock y; init location U { invariant y <= 3; to V { sync c?; assign m = 1; } } location V; }
        process Main() { init location A { to A { sync c?; assign n = m; } to B { guard n == 1; } } location B; }
        process Sender() { init location A { to A { sync c!; assign m = 0; } } }
        system Sender, Teller, Main;
    """,
    "an index depends on the state": """
        int a[2]; int[0, 1] i = 1;
        process Main() { init location A { to B { guard a[0] == 1; } } location B; }
        process Writer() { init location U { to U { assign i = 0; } to V { assign a[i] = 1; } } location V; }
        system Main, Writer;
    """,
    "what is read depends on the state": """
        int a[2]; int[0, 1] i = 1;
        process Main() { init location A { to A { assign i = 0; } to B { guard a[i] == 1; } } location B; }
        process Writer() { init location U { to V { assign a[0] = 1; } } location V; }
        system Main, Writer;
    """,
    "an element is passed by reference": """
        int a[2];
        void set(int &cell) { cell = 1; }
        process Main() { init location A { to B { guard a[0] == 1; } } location B; }
        process Writer() { init location U { to V { assign set(a[0]); } } location V; }
        system Main, Writer;
    """,
    "an array is passed by reference": """
        int a[2];
        void set(int &cells[2]) { cells[0] = 1; }
        process Main() { init location A { to B { guard a[0] == 1; } } location B; }
        process Writer() { init location U { to V { assign set(a); } } location V; }
        system Main, Writer;
    """,
    "a channel depends on the state": """
        chan c[2]; int[0, 1] i = 1;
        process Main() { init location A { to B { sync c[0]?; } } location B; }
        process Helper() { init location U { to U { assign i = 0; } to V { sync c[i]!; } } location V; }
        system Main, Helper;
    """,
    "a channel is chosen": """
        chan c[2];
        process Main() { init location A { to B { sync c[0]?; } } location B; }
        process Helper() { init location U { to V { select i : int[0, 1]; sync c[i]!; } } location V; }
        system Main, Helper;
    """,
    "channels are parameters": """
        chan c[2];
        process Main() { init location A { to B { sync c[0]?; } } location B; }
        process Helper(chan &out[2], const int i) { init location U { to V { sync out[i]!; } } location V; }
        helper = Helper(c, 0);
        other = Helper(c, 1);
        system Main, helper, other;
    """,
    "a channel is an element that is a parameter": """
        chan c[2];
        process Main() { init location A { to B { sync c[0]?; } } location B; }
        process Helper(chan &out) { init location U { to V { sync out!; } } location V; }
        helper = Helper(c[0]);
        other = Helper(c[1]);
        system Main, helper, other;
    """,
    "what makes an edge possible is itself made possible": """
        int n = 0, m = 0;
        process Main() { init location A { to B { guard n == 1; } } location B; }
        process Writer() { init location U { to V { guard m == 1; assign n = 1; } } location V; }
        process First() { init location U { to V { assign m = 1; } } location V; }
        system Main, Writer, First;
    """,
}


def answer(text: str, folder: Path, query: str = "E<> Main.B", options: Options = Options()) -> tachk.Verdict:
    file = folder / "model.ta"
    file.write_text(text)
    (verdict,) = tachk.load(file).verify(query, options=options)
    return verdict


@pytest.mark.parametrize("name", HOLDS)
@pytest.mark.parametrize("without", [frozenset(), frozenset({"unblocked"})])
def test_what_can_happen_is_found(name: str, without: frozenset[str], tmp_path: Path) -> None:
    assert answer(HOLDS[name], tmp_path, options=Options(without=without)).answer is Answer.HOLDS


def test_a_target_that_speaks_of_a_budget_sees_its_value(tmp_path: Path) -> None:
    text = f"""
    int[0, 1] used = 0;
    process Main() {{ init location A {{ to B {{ guard used < 1; }} }} location B; }}
    {TAKER}
    system Main, Taker;
    """
    assert answer(text, tmp_path, "E<> Main.B && used == 1").answer is Answer.HOLDS


def test_that_a_member_could_overdraw_a_budget_is_not_hidden(tmp_path: Path) -> None:
    text = """
    int[0, 1] used = 0; broadcast chan go;
    process Main() { init location A { to C { sync go!; } } location C; location B; }
    process Loses() {
        init location H { to I { guard used < 1; sync go?; assign used = used + 1; } to I { sync go?; } } location I;
    }
    process Taker() { init location U { to V { guard used < 1; assign used = used + 1; } } location V; }
    system Main, Loses, Taker;
    """
    verdict = answer(text, tmp_path, "A[] not (Main.B && Loses.I)")
    assert verdict.answer is Answer.HOLDS
    assert verdict.unexamined == ("used",)
