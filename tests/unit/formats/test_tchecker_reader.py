"""Reading TChecker's format."""

from __future__ import annotations

from itertools import product
from random import Random

import pytest

from tachk.api import model as api
from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.formats.tchecker.reader import parse_tchecker
from tachk.syntax.printing.printer import print_document
from tachk.syntax.source_files import is_tchecker

FILE = """\
# a sender and two listeners
system:demo

event:go
event:hear
event:tau
clock:1:x
int:2:0:5:1:a   # an array
int:1:-3:3:-1:end.of

process:S
location:S:init{initial: : invariant: x<=3 && a[0]==1}
location:S:b{committed: : labels: done,far}
edge:S:init:b:go{provided: x>=2 && (if end.of == -1 then 1 else 0) : do: x=0; a[1]=(if a[0]<2 then 4 else 5)}
edge:S:b:init:tau{do: if a[1]==4 then a[1]=1; end.of=-end.of else nop end}

process:L
location:L:x{initial: : colour: red}
location:L:y{urgent: : labels: far}
edge:L:x:y:hear{}

sync:S@go:L@hear?
"""


def test_a_file_as_text() -> None:
    assert is_tchecker(Source("m.tck", FILE))
    document, diagnostics = parse_tchecker(Source("m.tck", FILE))
    assert document is not None
    assert [(d.code, d.message) for d in diagnostics] == [("W0130", "attribute `colour` of this location is not read")]
    assert (
        print_document(document)
        == """\
clock x;
int[0, 5] a[2] = { 1, 1 };
int[-3, 3] end_of = -1;

broadcast chan go;

void update_1() {
    if (a[1] == 4) {
        a[1] = 1;
        end_of = -end_of;
    } else {
        ;
    }
}

process S() {
    init location init_1 {
        invariant x <= 3 && a[0] == 1;
        to b {
            guard x >= 2 && (end_of == -1 ? 1 : 0);
            sync go!;
            assign x = 0, a[1] = a[0] < 2 ? 4 : 5;
        }
    }

    committed location b {
        to init_1 { assign update_1(); }
    }
}

process L() {
    init location x_1 {
        to y { sync go?; }
    }

    urgent location y;
}

system S, L;
signal done = S.b;
signal far = S.b || L.y;
"""
    )


def test_queries_on_labels() -> None:
    model = api.Model(load_model(Source("m.tck", FILE)), "m.tck")
    report = model.verify("E<> done && L.y", "E<> L.y && !done", "E<> end_of == 1", trace=False)
    assert [verdict.answer.value for verdict in report] == ["holds", "holds", "holds"]


def system(*lines: str) -> str:
    head = ("system:s", "event:a", "event:b", "clock:1:x", "int:1:0:3:0:i")
    return "\n".join((*head, *(f"process:{p}\nlocation:{p}:l{{initial:}}" for p in "PQR"), *lines)) + "\n"


WRONG = {
    "edge:P:l:m:a": ("E0820", "has no location `m`"),
    "edge:P:l:l:c": ("E0820", "no event `c`"),
    "edge:T:l:l:a": ("E0820", "no process `T`"),
    "edge:P:l:l": ("E0820", "takes 4 arguments, not 3"),
    "edge:P:l:l:a{provided: x<<3}": ("E0820", "unexpected `<`"),
    "edge:P:l:l:a{provided: x<=3 || i==1}": ("E0820", "unexpected character '|'"),
    "edge:P:l:l:a{do: if i==1 then i=2}": ("E0820", "the text ends too early, `end` is missing"),
    "edge:P:l:l:a{do}": ("E0820", "a name, a colon and a value"),
    "clock:1:x": ("E0820", "declared twice"),
    "clock:0:z": ("E0820", "not between 1 and 65536"),
    "int:1:a:3:0:j": ("E0820", "`a` is not a number"),
    "process:P": ("E0820", "declared twice"),
    "system:t": ("E0820", "a second `system` line"),
    "hello": ("E0820", "this is not a declaration"),
    "sync:P@a": ("E0820", "at least two different processes"),
    "sync:P@a:Q@c": ("E0820", "does not name an event"),
    "sync:P@a:Q@a:R@a?": ("E0821", "no counterpart"),
    "sync:P@a?:Q@a?": ("E0821", "no counterpart"),
    "sync:P@a:R@a?:Q@a?": ("E0821", "order of the processes"),
}


@pytest.mark.parametrize("line", WRONG)
def test_what_is_wrong_is_said_with_its_place(line: str) -> None:
    text = system(line)
    document, diagnostics = parse_tchecker(Source("m.tck", text))
    assert document is None
    (found,) = diagnostics
    code, message = WRONG[line]
    assert (found.code, message in found.message) == (code, True), found.message
    assert text.splitlines()[found.span.source.line_column(found.span.start)[0] - 1] == line


def test_deep_nesting_is_an_error() -> None:
    text = system(f"edge:P:l:l:a{{provided: {'(' * 3000}1{')' * 3000}}}")
    with pytest.raises(InputError, match="nested too deep"):
        load_model(Source("m.tck", text))


def test_vectors_of_two_events_become_channels() -> None:
    text = system("edge:P:l:l:a{do: i=1}", "edge:Q:l:l:b{provided: i==0}", "sync:P@a:Q@b", "edge:R:l:l:a{}")
    network = load_model(Source("m.tck", text)).network
    synchronisations = [edge.synchronisation for process in network.processes for edge in process.edges]
    assert [None if s is None else s.direction.value for s in synchronisations] == ["!", "?", None]


def test_a_process_begins_in_each_of_its_initial_locations() -> None:
    text = system("location:P:m{initial: : invariant: x<=1 : labels: here}", "edge:P:m:l:a{provided: x>=1 : do: i=1}")
    model = api.Model(load_model(Source("m.tck", text)), "m.tck")
    report = model.verify("E<> here && x == 0", "E<> P.l && i == 0 && x == 0", "E<> i == 1 && x < 1", trace=False)
    assert [verdict.answer.value for verdict in report] == ["holds", "holds", "fails"]


def test_a_vector_of_three_events_needs_the_guards_of_all() -> None:
    text = system(
        "clock:1:y",
        *(f"location:{p}:m{{}}" for p in "PQR"),
        "location:Q:n{}",
        "edge:P:l:m:a{provided: x>=2}",
        "edge:Q:l:m:a{provided: y<=3 && i==0 : do: i=1}",
        "edge:Q:l:n:a{provided: y>3 : do: i=2}",
        "edge:R:l:m:a{do: y=0}",
        "edge:Q:n:l:b",
        "sync:P@a:Q@a:R@a",
    )
    model = api.Model(load_model(Source("m.tck", text)), "m.tck")
    report = model.verify(
        "E<> P.m && Q.m && R.m && i == 1 && x >= 2 && y == 0",
        "E<> P.m && Q.n && i == 2",
        "E<> P.m && !R.m",
        "E<> Q.m && x < 2",
        "E<> i == 2 && x <= 3",
        trace=False,
    )
    assert [verdict.answer.value for verdict in report] == ["holds", "holds", "fails", "fails", "fails"]


def test_an_event_of_a_vector_does_not_happen_alone() -> None:
    """R has no edge with the event, so that P and Q never take theirs."""
    text = system("edge:P:l:l:a{do: i=1}", "edge:Q:l:l:a{}", "sync:P@a:Q@a:R@a")
    model = api.Model(load_model(Source("m.tck", text)), "m.tck")
    assert [verdict.answer.value for verdict in model.verify("E<> i == 1", trace=False)] == ["fails"]


def test_a_vector_for_which_a_process_has_no_edge_stands_for_nothing_beside_others() -> None:
    text = system("edge:P:l:l:a{do: i=1}", "edge:Q:l:l:a{}", "sync:P@a:Q@a", "sync:P@a:R@a", "sync:R@b:Q@b")
    loaded = load_model(Source("m.tck", text))
    assert [len(process.edges) for process in loaded.network.processes] == [1, 1, 0]
    assert not loaded.warnings


def test_an_edge_all_of_whose_vectors_never_happen_is_reported() -> None:
    text = system("edge:P:l:l:a{do: i=1}", "edge:Q:l:l:b{}", "sync:P@a:R@a", "sync:R@b:Q@b")
    loaded = load_model(Source("m.tck", text))
    assert [(warning.code, warning.span.text) for warning in loaded.warnings] == [
        ("W0402", "edge:P:l:l:a{do: i=1}"),
        ("W0401", "edge:Q:l:l:b{}"),
    ]


Edges = dict[str, list[tuple[int, int, str, int, int]]]
"""Of each process: from where, to where, event, value that `i` must have, value that it gets; -1: any, none."""


def reached_by_hand(edges: Edges, vectors: list[tuple[tuple[str, str], ...]]) -> set[tuple[int, ...]]:
    """The locations of P, Q and R and the values of `i` that vectors and events of their own lead to."""
    order = "PQR"
    own = [((name, event),) for name in order for event in "abc"]
    joint = {part for vector in vectors for part in vector}
    moves = [*vectors, *(vector for vector in own if vector[0] not in joint)]
    reached, waiting = {(0, 0, 0, 0)}, [(0, 0, 0, 0)]
    while waiting:
        state = waiting.pop()
        for vector in moves:
            here = [
                [
                    e
                    for e in edges[name]
                    if e[2] == event and e[0] == state[order.index(name)] and e[3] in (-1, state[3])
                ]
                for name, event in vector
            ]
            for chosen in product(*here):
                after = list(state)
                for (name, _), (_, target, _, _, value) in zip(vector, chosen, strict=True):
                    after[order.index(name)] = target
                    after[3] = after[3] if value < 0 else value
                if tuple(after) not in reached:
                    reached.add(tuple(after))
                    waiting.append(tuple(after))
    return reached


@pytest.mark.parametrize("seed", [4, 7, 15, 18])
def test_random_vectors_of_three_events_lead_where_they_do_by_hand(seed: int) -> None:
    random = Random(seed)
    edges: Edges = {
        name: [
            (
                random.randrange(3),
                random.randrange(3),
                random.choice("aabc"),
                random.choice((-1, 0, 1)),
                random.choice((-1, 0, 1, 2)),
            )
            for _ in range(5)
        ]
        for name in "PQR"
    }
    vectors = [(("P", "a"), ("Q", "a"), ("R", "a")), (("Q", "b"), ("R", "c"), ("P", "a"))]
    lines = ["system:s", "int:1:0:2:0:i", *(f"event:{event}" for event in "abc")]
    for name in "PQR":
        lines += [f"process:{name}", f"location:{name}:l0{{initial:}}", f"location:{name}:l1", f"location:{name}:l2"]
    for name, its in edges.items():
        for source, target, event, wanted, value in its:
            guard = f"provided: i=={wanted}" if wanted >= 0 else "provided: 1==1"
            update = f" : do: i={value}" if value >= 0 else ""
            lines.append(f"edge:{name}:l{source}:l{target}:{event}{{{guard}{update}}}")
    lines += ["sync:" + ":".join(f"{name}@{event}" for name, event in vector) for vector in vectors]
    model = api.Model(load_model(Source("m.tck", "\n".join(lines) + "\n")), "m.tck")
    states = list(product(range(3), repeat=4))
    report = model.verify(*(f"E<> P.l{p} && Q.l{q} && R.l{r} && i == {i}" for p, q, r, i in states), trace=False)
    found = {state for state, verdict in zip(states, report, strict=True) if verdict.answer.value == "holds"}
    assert found == reached_by_hand(edges, vectors)


@pytest.mark.parametrize("low", [-(2**31) - 1, -(2**32)])
def test_numbers_fit_into_32_bits(low: int) -> None:
    text = f"system:s\nint:1:{low}:5:0:i\nprocess:P\nlocation:P:l{{initial:}}\n"
    with pytest.raises(InputError, match="does not fit 32 bits"):
        load_model(Source("m.tck", text))
