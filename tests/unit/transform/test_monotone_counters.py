"""Which variables are monotone counters."""

from __future__ import annotations

import pytest

from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.transform.monotone_counters import MOST_CONDITIONS, monotone_counters

LINK = """
int[0, 2] used = 0; bool deaf = false; bool broken = false; bool more[12];
broadcast chan send[3];
bool may_lose() { return used < 2 && !broken; }
process Link() {
    clock x;
    init location Empty {
        to Full { select k : int[0, 2]; guard !deaf && !broken; sync send[k]?; }
        to Waiting { select j : int[0, 2]; guard deaf && !broken; sync send[j]?; }
        to Empty { select i : int[0, 2]; guard used < 2 && !broken; sync send[i]?; assign used = used + 1; }
    }
    location Full { to Empty { sync send[0]!; } }
    location Waiting;
}
process World() {
    init location W {
        to W { assign deaf = !deaf; }
        to W { assign broken = !broken; }
        to W { select n : int[0, 11]; assign more[n] = !more[n]; }
    }
}
system Link, World;
property P : E<> Link.Waiting;
"""


def found(text: str) -> list[str]:
    loaded = load_model(Source("model.ta", text))
    target = loaded.queries[0].target
    assert target is not None
    return [variable.name for variable in monotone_counters(loaded.network, [target])]


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("guard used < 2 && !broken;", "guard may_lose();"),
        ("guard used < 2 && !broken;", "guard !(used >= 2) && !broken;"),
        ("guard used < 2 && !broken;", "guard used <= 1 && !broken && x < 3;"),
        ("used = used + 1", "used += 1"),
        ("used = used + 1", "used++"),
        ("guard deaf && !broken;", "guard !broken;"),
        ("to Empty { sync send[0]!; }", "to Empty { guard used < 2; sync send[0]!; }"),
        ("to Empty { sync send[0]!; }", "to Empty { guard used < 2; }"),
        ("guard !deaf && !broken;", "guard !(deaf || broken);"),
        ("location Waiting;", "location Waiting { to Full { select n : int[0, 11]; guard used < 2 || more[n]; } }"),
        ("", ""),
    ],
)
def test_what_only_goes_up_and_forces_nothing_is_a_monotone_counter(before: str, after: str) -> None:
    assert before in LINK
    assert found(LINK.replace(before, after)) == ["used"]


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("guard deaf && !broken;", "guard deaf && broken;"),
        ("guard deaf && !broken;", "guard deaf && !broken && x < 3;"),
        ("guard deaf && !broken; sync send[j]?;", "guard deaf && !broken && j < 2; sync send[j]?;"),
        ("sync send[j]?;", "sync send[0]?;"),
        ("select j : int[0, 2]; guard deaf && !broken; sync send[j]?;", "guard deaf && !broken; sync send[1]?;"),
        ("guard deaf && !broken;", "guard deaf && used < 2;"),
        ("guard used < 2 && !broken;", "guard used < 2;"),
        ("guard used < 2 && !broken;", "guard used < 2 && " + " && ".join(f"more[{n}]" for n in range(12)) + ";"),
        ("broadcast chan", "urgent broadcast chan"),  # with the guard below
        ("used = used + 1", "used = 1"),
        ("used = used + 1", "used = used - 1"),
        ("used = used + 1", "used--"),
        ("used = used + 1", "used += -1"),
        ("used = used + 1", "used *= 2"),
        ("int[0, 2] used", "meta int[0, 2] used"),
        ("int[0, 2] used", "int[0, 2147483647] used"),
        ("property P : E<> Link.Waiting;", "property P : E<> Link.Waiting && used == 0;"),
        ("location Waiting;", "location Waiting { invariant used < 2; }"),
        ("location Waiting;", "location Waiting { to Full { guard used > 0; } }"),
        ("location Waiting;", "location Waiting { to Full { guard used < 2 imply deaf; } }"),
        ("location Waiting;", "location Waiting { to Full { select n : int[0, 12]; guard used < 2 || more[n]; } }"),
        ("location Waiting;", "location Waiting { to Full { guard x < used; } }"),
        ("location Waiting;", "location Waiting { to Full { assign more[used] = true; } }"),
        ("location Waiting;", "location Waiting { to Full { sync send[used]!; } }"),
    ],
)
def test_what_is_none(before: str, after: str) -> None:
    assert before in LINK
    text = LINK.replace(before, after)
    if after.startswith("urgent"):
        text = text.replace("sync send[0]!;", "guard used < 2; sync send[0]!;")
    assert found(text) == []


def test_a_channel_of_an_urgent_broadcast_may_be_received_thanks_to_a_counter() -> None:
    assert found(LINK.replace("broadcast chan", "urgent broadcast chan")) == ["used"]


def test_conditions_are_tried_up_to_a_number_of_them() -> None:
    def with_conditions(count: int) -> str:
        asked = " && ".join(f"more[{n}]" for n in range(count))
        return LINK.replace("guard used < 2 && !broken;", f"guard used < 2 && !broken && {asked};")

    assert found(with_conditions(MOST_CONDITIONS - 2)) == ["used"]
    assert found(with_conditions(MOST_CONDITIONS - 1)) == []


def test_an_edge_of_another_location_forces_nobody_here() -> None:
    safe = "to Waiting { select j : int[0, 2]; guard deaf && !broken; sync send[j]?; }"
    assert found(LINK.replace(safe, "").replace("location Waiting;", f"location Waiting {{ {safe} }}")) == []
