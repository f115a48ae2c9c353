"""Which processes are interchangeable, and what tells others apart."""

from pathlib import Path
from random import Random

import pytest

import tachk
from tachk import Limits
from tachk.base.resources import data_root
from tachk.engine.symmetry import detection, transpositions
from tachk.engine.symmetry.detection import find_symmetry, search_symmetry
from tachk.engine.symmetry.index_types import AsymmetryReason
from tests.support.seeds import enough, seeds
from tests.support.symmetric.cases import random_symmetric_case

ORDER = "the updates of two of them that receive the same broadcast depend on their order"

TEXT = """
const int N = 3;
typedef int[1, N] id_t;
int[0, N] owner = 0;
int[0, N] queue[3];
int[0, 2] mark[N + 1];
int[0, 9] count = 0;
chan to[N + 1];
broadcast chan all;

void push(int[0, N] who) { queue[count] = who; count = count + 1; }

void leave() { for (i : id_t) if (mark[i] == 0) owner = i; }

process P(const id_t me) {
    clock x;
    int[0, N] friend = 0;
    init location L { to M { %s } }
    location M { to L { guard owner == me && x > 2; assign owner = 0, x = 0; } }
}
process Q() {
    init location L { to L { %s } }
}
system P, Q;
"""


def found(edge: str = "", other: str = "", *queries: str, text: str = TEXT) -> tuple[list[int], list[str]]:
    """The numbers of interchangeable processes in groups, and why others are not interchangeable."""
    model = tachk.loads(text % (edge, other) if "%s" in text else text)
    targets = [verdict.query.target for verdict in model.verify(*queries, trace=False)] if queries else []
    symmetry = find_symmetry(model.network, [target for target in targets if target is not None])
    return [len(group.members) for group in symmetry.groups], [each.reason.reason for each in symmetry.differences]


@pytest.mark.parametrize(
    "edge",
    [
        "guard owner == 0; assign owner = me;",
        "guard owner != me; assign friend = owner;",
        "select k : id_t; guard k != me; assign owner = k;",
        "guard mark[me] == 0; assign mark[me] = mark[me] + 1;",
        "guard friend != 0 and mark[friend] == 1; assign mark[friend] = 0;",
        "guard forall (i : id_t) mark[i] == 0;",
        "guard sum (i : id_t) mark[i] < 2;",
        "sync to[me]?;",
        "guard count < 3; assign push(me);",
        "guard queue[0] == me; assign count = 0;",
        "sync all?; assign x = 0;",
        "sync all?; assign mark[me] = 1;",
        "sync all?; assign owner = 0;",
    ],
)
def test_numbers_that_are_only_names_do_not_distinguish_processes(edge: str) -> None:
    assert found(edge, "sync all!; assign count = 0;") == ([3], [])
    assert found(edge, "select k : id_t; sync to[k]!;") == ([3], [])


@pytest.mark.parametrize(
    ("edge", "reason"),
    [
        ("guard owner < me;", "`<` compares it"),
        ("assign count = me + count;", "they compute with their numbers"),
        ("guard count == 3 and owner != 2;", "their texts differ in more than their own numbers and variables"),
        ("assign owner = 2;", "their texts differ in more than their own numbers and variables"),
        ("guard x <= me;", "`<=` compares it"),
        ("assign mark[1] = 1, mark[me] = 0;", "their texts differ in more than their own numbers and variables"),
        (
            "sync all?; assign owner = me;",
            ORDER,
        ),
        (
            "sync all?; assign count = 9 - count;",
            ORDER,
        ),
        ("assign leave();", "a loop goes through it in order"),
        ("assign owner = queue[me - 1];", "`<` compares it"),
    ],
)
def test_what_distinguishes_processes_is_named(edge: str, reason: str) -> None:
    groups, reasons = found(edge, "sync all!; assign queue[count] = 0, count = count < 2 ? count + 1 : 0;")
    assert groups == [] or groups == [2]
    assert reason in reasons or "counts with it" in " ".join(reasons)


def test_another_process_may_not_prefer_one() -> None:
    groups, reasons = found("sync to[me]?;", "sync to[2]!;")
    assert groups == [2]
    assert reasons == ["the process Q distinguishes them here"]


def test_invariants_may_name_neighbours() -> None:
    """Each process of the ring looks at the clock of its neighbour: colours do not tell them apart, exchanges do."""
    text = """
    clock a, b, c, d, e, f;
    process P(clock &own, clock &next) {
        init location L { invariant next <= 5; to L { guard own > 2; assign own = 0; } }
    }
    A = P(a, b); B = P(b, c); C = P(c, d); D = P(d, e); E = P(e, f); F = P(f, a);
    system A, B, C, D, E, F;
    """
    groups, _ = found(text=text)
    assert groups == []


def test_initial_values_may_prefer_one() -> None:
    text = TEXT.replace("owner = 0;", "owner = 1;", 1) % ("guard owner == 0; assign owner = me;", "")
    assert found(text=text) == ([3], [])
    text = TEXT.replace("mark[N + 1];", "mark[4] = {0, 0, 0, 1};") % ("guard mark[me] == 0; assign mark[me] = 2;", "")
    assert found(text=text) == ([3], [])


@pytest.mark.parametrize(
    ("declared", "edge"),
    [("int[0, 2]", "guard mark[friend] == 0; assign friend = me;"), ("meta int[0, 2]", "assign mark[me] = 2;")],
)
def test_values_that_every_transition_finds_may_not(declared: str, edge: str) -> None:
    text = TEXT.replace("int[0, 2] mark[N + 1];", f"{declared} mark[4] = {{0, 0, 0, 1}};") % (edge, "")
    assert found(text=text) == ([2], ["the values of `mark` distinguish them"])


def test_a_condition_may_not_hold_for_one_only() -> None:
    """It is a constant for each of them, 1 or 0, which are not names."""
    text = TEXT.replace("clock x;", "clock x; void first() { if (me == 1) count = 0; }") % ("assign first();", "")
    assert found(text=text) == ([2], ["their texts differ in more than their own numbers and variables"])


def test_ranges_may_not_hold_some_names_only() -> None:
    text = TEXT.replace("int[0, N] owner", "int[0, 2] owner") % ("guard owner == 0; assign owner = me;", "")
    assert found(text=text) == ([2], ["the range [0, 2] holds the number of one and not that of another"])


def test_run_time_errors_may_not_depend_on_the_order_of_processes() -> None:
    assert found("guard forall (i : id_t) 9 / mark[i] > 0; assign mark[me] = 1;") == (
        [],
        ["the body of a quantifier may meet a run-time error"],
    )
    text = TEXT.replace("location M {", "location M { invariant x <= 9 / mark[me];") % ("assign mark[me] = 1;", "")
    assert found(text=text) == ([], ["an invariant or a rate may be a run-time error"])


BETWEEN = """
int[0, 1] n = 1, m = 0;
process P(const int[0, 1] me) {
    init location I { to L { guard n == 1; assign n = 0; } }
    location L { invariant m == 1; }
}
process Q() {
    clock x;
    init location K { invariant 10 / n > 1; to M { guard n == 2; assign m = 1; } }
    location M;
}
First = P(0); Second = P(1); Other = Q();
"""


@pytest.mark.parametrize(
    ("order", "sizes", "answer"),
    [("First, Other, Second", [], "unknown"), ("First, Second, Other", [2], "fails")],
)
def test_a_run_time_error_of_another_one_may_not_depend_on_it_either(order: str, sizes: list[int], answer: str) -> None:
    """The invariant of the other one is looked at where that of the first one before it is not yet false."""
    text = f"{BETWEEN} system {order};"
    assert found(text=text)[0] == sizes
    for options in (tachk.Options(), tachk.Options().off("symmetry")):
        (verdict,) = tachk.loads(text).verify("E<> m == 1 && Other.x > 3 && n == 0", options=options)
        assert (verdict.answer.value, verdict.fault is not None) == (answer, answer == "unknown")


def test_priorities_of_channels_distinguish_processes() -> None:
    text = TEXT.replace("broadcast chan all;", "broadcast chan all; chan priority to[2] < default;")
    text %= ("sync to[me]?;", "select k : id_t; sync to[k]!;")
    assert found(text=text) == ([2], ["the priorities of the channels `to` distinguish them"])


def test_a_deep_check_reports_who_is_interchangeable_and_why_others_are_not() -> None:
    model = tachk.loads(TEXT % ("guard owner == 0; assign owner = me;", "assign queue[count] = 0;"))
    (part,) = (part for part in model.check().parts if part.question == "interchangeable processes")
    assert part.answer == "P(1), P(2), P(3)"
    model = tachk.loads(TEXT % ("guard owner < me; assign owner = me;", ""))
    (part,) = (part for part in model.check().parts if part.question == "interchangeable processes")
    assert part.answer.startswith("not all P: `<` compares it (")


def test_a_result_says_how_many_processes_were_exchanged() -> None:
    model = tachk.loads(TEXT % ("guard owner == 0; assign owner = me;", ""))
    many, one = model.verify("E<> owner == 5 - 5 && count == 1", "E<> P(1).M")
    assert (many.statistics.interchangeable, one.statistics.interchangeable) == (3, 2)
    assert (many.answer.value, one.answer.value) == ("fails", "holds")


def test_processes_of_a_foreign_file_are_exchanged_with_their_clocks(tmp_path: Path) -> None:
    lines = ["system:fischer", "event:tau", "int:1:0:5:0:id"]
    for i in range(1, 6):
        lines += [
            f"process:P{i}",
            f"clock:1:x{i}",
            f"location:P{i}:idle{{initial:}}",
            f"location:P{i}:request{{invariant:x{i}<=10}}",
            f"location:P{i}:waiting{{}}",
            f"location:P{i}:critical{{labels:critical}}",
            f"edge:P{i}:idle:request:tau{{provided:id==0 : do:x{i}=0}}",
            f"edge:P{i}:request:waiting:tau{{provided:x{i}<=10 : do:x{i}=0;id={i}}}",
            f"edge:P{i}:waiting:request:tau{{provided:id==0 : do:x{i}=0}}",
            f"edge:P{i}:waiting:critical:tau{{provided:x{i}>10&&id=={i}}}",
            f"edge:P{i}:critical:idle:tau{{do:id=0}}",
        ]
    path = tmp_path / "fischer.tck"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    (verdict,) = tachk.load(path).verify("E<> false")
    assert verdict.statistics.states_stored == 5 * 8


@pytest.mark.parametrize(
    ("query", "group"),
    [
        ("E<> exists (i : id_t) P(i).M and owner == i", [3]),
        ("A[] forall (i : id_t) forall (j : id_t) P(i).M and P(j).M imply i == j", [3]),
        ("E<> P(1).M", [2]),
        ("E<> owner == 3", [2]),
        ("E<> P(1).x > 2 and P(2).M", []),
        ("A[] not deadlock", [3]),
    ],
)
def test_a_query_that_names_processes_leaves_the_others(query: str, group: list[int]) -> None:
    assert found("guard owner == 0; assign owner = me;", "", query)[0] == group


def test_processes_that_all_differ_take_no_longer_than_they_are_many(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = 0

    def transposition_of(*given: object) -> AsymmetryReason:
        nonlocal tried
        tried += 1
        return AsymmetryReason("they differ")

    monkeypatch.setattr(transpositions, "transposition_of", transposition_of)
    text = "process P(const int me) { init location L { to M { guard me > 0; } } location M; }\n"
    text += "".join(f"P{n} = P({n + 1});\n" for n in range(40)) + f"system {', '.join(f'P{n}' for n in range(40))};"
    assert found(text=text)[0] == []
    assert detection.MOST_FAILED_TRANSPOSITIONS <= tried < detection.MOST_FAILED_TRANSPOSITIONS + 40


def test_processes_in_which_different_constants_stand_are_not_tried(tried: list[object]) -> None:
    processes = "".join(
        f"process P{n}() {{ init location L {{ to L {{ sync to{n}!; }} }} }}\n"
        f"process Q{n}() {{ init location L {{ to L {{ guard x > {n}; sync to{n}?; }} }} }}\n"
        for n in range(9)
    )
    text = f"clock x;\nchan {', '.join(f'to{n}' for n in range(9))};\n{processes}"
    text += f"system {', '.join(f'P{n}, Q{n}' for n in range(9))};"
    assert found(text=text)[0] == []
    assert len(tried) <= 3  # one in vain, then their colours are looked for; two to say why


def test_priorities_distinguish_processes() -> None:
    text = "process P() { init location L { to M { } } location M; }\nA = P();\nB = P();\nC = P();\nsystem A, B < C;"
    assert found(text=text) == ([2], ["they have different priorities"])


def test_processes_without_numbers_are_interchangeable_with_their_own_globals() -> None:
    text = """
    clock x, y; int[0, 3] m; int[0, 3] n;
    process P(clock &c, int[0, 3] &k) {
        init location L { to L { guard c > 2; assign c = 0, k = k == 3 ? 0 : k + 1; } }
    }
    A = P(x, m); B = P(y, n); system A, B;
    """
    assert found(text=text) == ([2], [])
    assert found(text=text.replace("int[0, 3] n;", "int[0, 3] n = 1;")) == ([2], [])


@pytest.mark.parametrize(
    ("model", "constants", "stored"),
    [
        ("train_gate", {"N": 8}, 53),
        ("csma_cd_any_order", {"N": 6}, 128),
        ("critical_region", {"N": 4, "CAREFUL": True, "IN_TURN": False}, 700),
    ],
)
def test_arrays_queues_and_pairs_of_processes_are_exchanged(model: str, constants: dict[str, int], stored: int) -> None:
    loaded = tachk.load(data_root() / "models" / "classics" / f"{model}.ta", **constants)
    verdict = next(iter(loaded.verify(trace=False, options=tachk.Options().off("merging", "pruning"))))
    assert (verdict.answer.value, verdict.statistics.states_stored) == ("holds", stored)


def test_a_query_that_names_a_process_is_searched_for_alone() -> None:
    model = tachk.load(data_root() / "models" / "classics" / "fischer.ta", N=5)
    alone = model.verify(property="mutual_exclusion", trace=False)["mutual_exclusion"]
    together = model.verify(trace=False)["mutual_exclusion"]
    assert together.statistics.states_stored == alone.statistics.states_stored


@pytest.mark.parametrize("size", [4, 6, 10])
def test_fischer_stores_a_quadratic_number_of_states(size: int) -> None:
    model = tachk.load(data_root() / "models" / "classics" / "fischer.ta", N=size)
    (verdict,) = model.verify(property="mutual_exclusion")
    assert verdict.answer.value == "holds"
    assert verdict.statistics.states_stored == size * (size + 3)


def test_what_equal_processes_can_do_is_followed_once() -> None:
    model = tachk.load(data_root() / "models" / "classics" / "fischer.ta", N=8)
    (verdict,) = model.verify(property="mutual_exclusion")
    statistics = verdict.statistics
    assert statistics.states_stored == 8 * 11
    assert statistics.transitions < 3 * statistics.states_stored


@pytest.mark.parametrize(
    ("edges", "query"),
    [
        # Two equal processes meet, and only one of them is named afterwards.
        ("to B { sync call!; assign owner = me; } to C { sync call?; }", "E<> exists (i : id_t) P(i).B and owner != i"),
        ("to B { sync call!; assign owner = me; } to C { sync call?; }", "E<> exists (i : id_t) P(i).C"),
        # One that is named is not equal to the others.
        ("to B { guard owner == 0; assign owner = me; } to C { guard owner == me; }", "E<> forall (i : id_t) P(i).B"),
        ("to A { guard owner == 0; assign owner = me; } to C { guard owner == me; }", "E<> exists (i : id_t) P(i).C"),
        (
            "to A { guard owner == 0; assign owner = me; } to C { guard owner != me and owner != 0; }",
            "E<> exists (i : id_t) P(i).C",
        ),
        # Nor is one whose clock runs for another time, or one that holds something else.
        (
            "to A { guard n < 1; assign x = 0, y = 0, n = 1; } to B { guard n == 1 and x > 3 and y < 1; }",
            "E<> exists (i : id_t) P(i).B",
        ),
        (
            "to A { guard n < 1 and y > 3; assign x = 0, n = 1; } to B { guard n == 1 and x < 1; }",
            "E<> exists (i : id_t) P(i).B",
        ),
        ("to A { guard n == 0; assign n = 1, k = 1; } to B { guard k == 1; }", "E<> exists (i : id_t) P(i).B"),
        (
            "to A { guard n == 0; assign n = 1, k = 1; } to B { guard n == 1 and k == 0; }",
            "E<> forall (i : id_t) P(i).B",
        ),
        # A deadlock is one of all.
        ("to B { guard x > 2 and x < 3; } to A { guard x <= 2 and y > 1; assign x = 0; }", "A[] not deadlock"),
    ],
)
def test_equal_processes_are_distinguished_from_others(edges: str, query: str) -> None:
    text = f"""
    typedef int[1, 3] id_t; int[0, 3] owner = 0; int[0, 1] n = 0; chan call; clock y;
    process P(const id_t me) {{
        clock x; int[0, 1] k = 0;
        init location A {{ {edges} }}
        location B;
        location C;
    }}
    system P;
    """
    model = tachk.loads(text)
    (one,) = model.verify(query, trace=False)
    (other,) = model.verify(query, options=tachk.Options().off("symmetry"), trace=False)
    assert (one.answer, one.statistics.interchangeable) == (other.answer, 3)


def test_a_deadlock_is_one_of_all_pairs_of_equal_processes() -> None:
    # Clocks that stop when they like: two of three are on the same side of 2, but not always the same two.
    text = """
    typedef int[1, 3] id_t; int[0, 1] busy = 0; chan a, b; clock y;
    process P(const id_t me) {
        clock x;
        init location W { invariant x' == 0; to R { guard busy == 0; assign busy = 1, y = 0; } }
        location R { invariant x' == 1 and y <= 4; to D { assign busy = 0; } }
        location D { invariant x' == 0;
            to D { guard x <= 2; sync a!; } to D { guard x <= 2; sync a?; }
            to D { guard x > 2; sync b!; } to D { guard x > 2; sync b?; } }
    }
    system P;
    """
    (verdict,) = tachk.loads(text).verify("A[] not deadlock", trace=False)
    assert (verdict.answer.value, verdict.statistics.interchangeable) == ("holds", 3)


TWO_KINDS = """
typedef int[1, 3] one_t;
typedef int[1, 3] other_t;
int[0, 3] owner = 0;
int[0, 3] holder = 0;
int[0, 3] next[5];
process P(const one_t me) { init location L { to M { guard owner == 0; assign owner = me; } } location M; }
process Q(const other_t me) { init location L { to M { guard holder == 0; assign holder = me; } } location M { to L; } }
process R() { init location L { to L { select k : one_t; guard k != owner; assign next[k + 1] = k; } } }
system P, Q, R;
"""


@pytest.mark.parametrize(
    ("query", "groups"),
    [
        ("E<> owner != 0 && holder != 0", [3, 3]),
        ("E<> exists (i : one_t) P(i).M && owner == i", [3, 3]),
        ("E<> forall (i : one_t) next[i + 1] == i", [3, 3]),
        ("E<> owner == holder", [3]),
        ("E<> owner < holder", []),
        ("E<> exists (i : one_t) owner == i && holder == i", [3]),
        ("E<> next[4] == 0 && owner != 0", [2, 3]),
        ("E<> P(2).M", [2, 3]),
        ("E<> (P(1).M || owner == 1) && (P(2).M || owner == 2) && (P(3).M || owner == 3)", [3, 3]),
        ("E<> (P(1).M || owner == 1) && (P(2).M || owner == 2) && (P(3).M xor owner == 3)", [2, 3]),
        ("E<> owner == 2", [2, 3]),
        ("E<> holder == 2", [3, 2]),
        ("E<> exists (i : int[1, 2]) owner == i", [2, 3]),
        ("E<> sum (i : one_t) i * P(i).M == 3", [3]),
    ],
)
def test_a_query_leaves_those_interchangeable_whom_it_does_not_distinguish(query: str, groups: list[int]) -> None:
    assert found("", "", query, text=TWO_KINDS)[0] == groups


def test_what_is_known_of_a_network_is_what_would_be_found_for_each_query() -> None:
    several = 0
    for seed in seeds(range(30)):
        case = random_symmetric_case(Random(seed))
        model = tachk.loads(case.text)
        for verdict in model.verify(*case.queries, limits=Limits(states=1), trace=False):
            assert verdict.query.target is not None
            known, anew = (look(model.network, [verdict.query.target]) for look in (find_symmetry, search_symmetry))
            assert known.groups == anew.groups, f"seed {seed}: {verdict.query.text}"
            several += bool(anew.groups)
    assert enough(several > 30)
