"""What can meet a run-time error. That nothing is overlooked, `test_codegen` asserts on random expressions."""

from __future__ import annotations

import pytest

from tachk.analysis.failures import edge_can_fail
from tachk.analysis.fold import known_values
from tachk.base.span import Source
from tachk.formats.loading.load import load_model

DECLARATIONS = """
    int[0,3] n, m; int[0,9] wide; int[1,2] divisor; int[-1,1] around; int[0,3] cells[4]; const int K[2] = {2, 9};
    int[0,31] near; int[0,32] far; bool flag; clock x; chan c, d[4];
    typedef struct { int[0,3] a; int[0,9] b; } pair; pair p, q;
    int[0,3] next(int[0,3] of) { if (of < 3) { return of <? 2; } return 0; }
    int[0,3] sum() { int[0,9] total = 0; for (i : int[0,2]) total = n; return 0; }
    int[0,3] beyond(int[0,3] of) { return of + 1; }
    int[0,3] at(int[0,9] place) { return cells[place]; }
    int[0,3] widen() { wide = 9; return 0; }
    int[0,3] one_of(int[0,9] first) { if (K[0] == 3) { first = wide; } return first; }
"""

OTHER = """
    process Other() {
        init location A {
            to A { assign n = 0, m = 0, wide = 0, divisor = 1, around = 0, near = 0, far = 0; }
            to A { assign cells[0] = 0, flag = true, p.a = 0, q.a = 0; }
        }
    }
"""


@pytest.mark.parametrize(
    ("edge", "expected"),
    [
        ("assign n = m", False),
        ("assign wide = n", False),
        ("assign n = wide", True),
        ("assign n = flag ? m : 3", False),
        ("assign n = flag ? m : 4", True),
        ("assign n = (wide <? 3)", False),
        ("assign n = K[0]", False),
        ("assign n = K[1]", True),
        ("assign wide = n + m", False),
        ("assign n = n + 1", True),
        ("assign n++", True),
        ("guard n < 3; assign n++", False),
        ("guard n < 3; assign n = n + 1", False),
        ("guard 3 > n && flag; assign n += 1", False),
        ("guard n <= 3; assign n += 1", True),
        ("guard n < 3; assign n = 3, n++", True),
        ("guard n > 0 && x > 3; assign n--", False),
        ("guard n == 2; assign n++", False),
        ("guard n != 3; assign n++", True),
        ("guard n < 3; sync c!; assign n++", False),
        ("guard n < 3; sync c?; assign n++", True),  # the sender may have changed n
        ("sync d[n]!", False),
        ("sync d[wide]!", True),
        ("assign cells[n] = m", False),
        ("assign cells[wide] = m", True),
        ("guard wide < 4; assign cells[wide] = m", False),
        ("guard cells[wide] == 1 && wide < 4", True),
        ("guard wide < 4 && cells[wide] == 1", False),
        ("guard wide < 4 && x <= cells[wide]", False),
        ("guard wide < 4; sync d[wide]?", False),
        ("assign wide = n / divisor", False),
        ("assign wide = n / around", True),
        ("assign wide /= m", True),
        ("assign wide = 1 << divisor", False),
        ("assign wide = 1 << around", True),
        ("guard 1 << near == 2", False),
        ("guard 1 << far == 2", True),
        ("guard wide < 5; assign cells[wide] = m", True),
        ("assign x = n", False),
        ("assign x = around", True),
        ("assign p = q", False),
        ("assign n = next(m)", False),
        ("assign n = next(wide)", True),
        ("assign n = sum()", False),
        ("assign n = beyond(m)", True),
        ("assign n = at(m)", False),
        ("assign n = at(wide)", True),
        ("assign n = one_of(3)", False),  # what is never executed does not count
        ("guard wide < 4; assign n = at(wide)", False),
        ("guard wide < 4; assign n = (cells[wide] <? widen())", False),
        ("guard wide < 4; assign n = (widen() <? cells[wide])", True),
        ("guard n * 0.5 < 1.5", True),
        ("guard n < 1.5 && fmin(n, m) >= 0", False),
        ("assign wide = fint(-0.5 * m)", True),
        ("guard forall (i : int[0,3]) cells[i] == 1", False),
        ("guard forall (i : int[0,4]) cells[i] == 1", True),
        ("select i : int[0,3]; assign n = i", False),
        ("select i : int[0,4]; assign n = i", True),
    ],
)
def test_what_can_fail(edge: str, expected: bool) -> None:
    text = f"{DECLARATIONS} process P() {{ init location A {{ to A {{ {edge}; }} }} }} {OTHER} system P, Other;"
    network = load_model(Source("model.ta", text)).network
    assert edge_can_fail(network.processes[0].edges[0], known_values(network, [])) is expected
