"""Drawings for Graphviz."""

from __future__ import annotations

from tachk.base.span import Source
from tachk.formats.dot import to_dot
from tachk.formats.loading.load import load_model

MODEL = """\
chan c[2];
int n;
process P(const int[0, 1] me) {
    clock x;
    init location A {
        invariant x <= 5 && x' == n;
        to B { select i : int[0, 1]; guard x >= 2 && i != me; sync c[i]!; assign x = 0, n += i; }
    }
    urgent location B { to C; }
    committed location C { to A { sync c[me]?; } }
}
p = P(1);
system p;
"""


def test_a_process() -> None:
    assert (
        to_dot(load_model(Source("m.ta", MODEL)).network)
        == """\
digraph network {
    rankdir=TB;
    node [shape=box, style=rounded, fontname="Helvetica", fontsize=11];
    edge [fontname="Helvetica", fontsize=10];
    subgraph cluster_0 {
        label="p";
        p0_0 [label="A\\nx <= 5\\nx' == rate()"];
        p0_1 [style="rounded,dashed", label="B"];
        p0_2 [style="rounded,bold", label="C"];
        p0_init [shape=point];
        p0_init -> p0_0;
        p0_0 -> p0_1 [label="i : int[0, 1]\\nx >= 2 && i != 1\\nc[i]!\\nx = 0, n += i"];
        p0_1 -> p0_2 [label=""];
        p0_2 -> p0_0 [label="c[1]?"];
    }
}
"""
    )
