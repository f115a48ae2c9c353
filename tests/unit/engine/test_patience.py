"""Limits and Ctrl-C are noticed in the midst of a state, however much there is to do for it."""

from __future__ import annotations

import _thread
import threading

import pytest

from tachk import _core
from tachk.base.job import limited
from tachk.base.span import Source
from tachk.engine.compiler.lower import lower, lower_obligation
from tachk.engine.core_search import core_limits, core_options, run_in_slices
from tachk.engine.options import Extrapolation, Limits, Options
from tachk.engine.program_image import encode
from tachk.engine.zone import explore
from tachk.formats.loading.load import load_model
from tachk.model.connectives import negation
from tachk.model.expressions import Expression
from tachk.model.network import Network

RECEIVERS = 40
MANY_SUCCESSORS = f"""
    broadcast chan all; chan priority default < all;
    typedef int[1, {RECEIVERS}] id_t;
    process S() {{ init location A {{ to A {{ sync all!; }} }} }}
    process R(const id_t me) {{
        clock x;
        init location A {{ to B {{ guard x >= 1; sync all?; }} to C {{ guard x >= 1; sync all?; }} }}
        location B; location C;
    }}
    system S, R;
    property q : E<> exists (i : id_t) R(i).B && R(i).C;
"""
"""The initial state has 2^40 successors."""

UNRANKED = MANY_SUCCESSORS.replace("chan priority default < all;", "")


def model(text: str) -> tuple[Network, Expression]:
    loaded = load_model(Source("model.ta", text))
    target = loaded.queries[0].target
    assert target is not None
    return loaded.network, target


def searches(text: str) -> list[_core.Explorer | _core.LivenessSearch | _core.CoverSearch]:
    """Searches of each kind that have not begun, in which processes keep their places."""
    network, target = model(text)
    program, goals = lower(network, [target])
    image, limits = encode(program, goals), core_limits(Limits())
    options = core_options(Options().off("pruning"))
    live, avoided, _ = lower_obligation(network, target, None)
    return [
        _core.Explorer(image, options, limits),
        _core.CoverSearch(image, options, limits, hulls=True, traps=[], clauses=[]),
        _core.LivenessSearch(encode(live, [avoided]), options, limits),
    ]


@pytest.mark.parametrize("text", [MANY_SUCCESSORS, UNRANKED])
def test_a_limit_on_time_ends_a_search_in_the_midst_of_a_state(text: str) -> None:
    for search in searches(text):
        assert search.run(1000, 0.01) is _core.Status.TIME_LIMIT
        assert search.run(1) is _core.Status.TIME_LIMIT, "it cannot go on"
        assert run_in_slices(search, 0.0) == (_core.Status.TIME_LIMIT, "time limit")


def test_a_limit_on_time_ends_a_search_over_local_times_in_the_midst_of_a_state() -> None:
    network, target = model(UNRANKED.replace("broadcast ", ""))
    program, goals = lower(network, [target])
    options = core_options(Options(extrapolation=Extrapolation.LU))
    search = _core.LocalExplorer(encode(program, goals), options, core_limits(Limits()))
    assert search.run(1000, 0.0) is _core.Status.TIME_LIMIT
    assert search.run(1) is _core.Status.TIME_LIMIT


def test_ctrl_c_ends_a_search_in_the_midst_of_a_state() -> None:
    for search in searches(MANY_SUCCESSORS):
        timer = threading.Timer(0.05, _thread.interrupt_main)
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            search.run(1000)
        timer.join()
        assert search.run(1) is _core.Status.TIME_LIMIT


def test_a_limit_on_memory_ends_a_search_in_the_midst_of_a_state() -> None:
    network, target = model(UNRANKED)
    program, goals = lower(network, [target])
    outcome = explore(program, goals, Options().off("pruning"), Limits(memory_bytes=2_000_000))
    assert outcome.reason == "memory limit"
    assert outcome.statistics.states_explored == 1


def test_the_time_of_first_looks_counts() -> None:
    network, target = model(MANY_SUCCESSORS)
    program, goals = lower(network, [negation(negation(target))])
    with limited(0.05):
        outcome = explore(program, goals, Options().off("pruning"))
    assert outcome.reason == "time limit"
    assert outcome.statistics.seconds >= 0.05
