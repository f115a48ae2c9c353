"""The order of a search: a model on which breadth first explores nearly everything in vain, and one that it fits."""

from __future__ import annotations

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.resources import data_root
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.engine.outcome import Statistics


def searched(model: str, name: str, order: SearchOrder, limits: Limits | None = None, **constants: int) -> Statistics:
    report = tachk.load(data_root() / "models" / "classics" / model, **constants).verify(
        property=name,
        options=Options(order=order).off("symmetry", "local-times"),
        limits=limits,
        trace=False,
    )
    (verdict,) = report.record.verdicts
    assert verdict.answer.value == "holds" or limits is not None
    return verdict.statistics


def test_by_progress_explores_what_it_stores_of_a_token_ring() -> None:
    breadth_first = searched("fddi.ta", "one_sender", SearchOrder.BFS, N=10)
    by_progress = searched("fddi.ta", "one_sender", SearchOrder.PROGRESS, N=10)
    assert (breadth_first.states_explored, breadth_first.states_stored) == (10_219, 525)
    assert (by_progress.states_explored, by_progress.states_stored) == (525, 525)


def test_the_order_changes_when_most_states_were_explored_in_vain() -> None:
    found = searched("fddi.ta", "one_sender", SearchOrder.AUTO, N=10)
    assert found.states_stored == 525
    assert 1000 < found.states_explored < 2000


def test_the_order_stays_breadth_first_where_that_is_good() -> None:
    breadth_first = searched("fischer.ta", "mutual_exclusion", SearchOrder.BFS, N=7)
    default = searched("fischer.ta", "mutual_exclusion", SearchOrder.AUTO, N=7)
    assert (default.states_explored, default.transitions) == (breadth_first.states_explored, breadth_first.transitions)


def test_a_limit_on_depth_keeps_the_search_breadth_first() -> None:
    depth = Limits(depth=60)
    breadth_first = searched("fddi.ta", "one_sender", SearchOrder.BFS, depth, N=10)
    default = searched("fddi.ta", "one_sender", SearchOrder.AUTO, depth, N=10)
    assert default.states_explored == breadth_first.states_explored > 1000


def test_shortest_runs_are_found_in_the_default_order() -> None:
    assert Options(shortest=True).order is SearchOrder.AUTO
    with pytest.raises(UsageError):
        Options(shortest=True, order=SearchOrder.PROGRESS)
