"""Seven processes that count for themselves: 8**7 states and more, of which each run to the last one passes 50."""

from __future__ import annotations

COUNTERS = """
const int N = 7;
typedef int[1, N] id_t;
int[0, 7] count[N + 1];
process P(const id_t me) {
    init location going {
        to going { guard count[me] < 7; assign count[me] = count[me] + 1; }
        to done { guard count[me] == 7; }
    }
    location done { }
}
system P;
"""
REACHED = "E<> forall (i : id_t) count[i] == 7"
NEVER = "E<> forall (i : id_t) P(i).done && count[i] < 7"
