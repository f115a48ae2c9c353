"""Every run of the tests on one commit tries the same random examples, a quarter on every commit: `support.seeds`.

Ctrl-C means what it means at a terminal, also where a shell runs the tests in the background and has them ignore it.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings

from tests.support.seeds import Draw, number, one_in, refresh

signal.signal(signal.SIGINT, signal.default_int_handler)
settings.register_profile("repeatable", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("repeatable")


@pytest.fixture(autouse=True)
def same_signals() -> Iterator[None]:
    """A program that ran in this process has ended for its test: what it does about signals ends with it."""
    before = {which: signal.getsignal(which) for which in (signal.SIGINT, signal.SIGTERM)}
    yield
    for which, handler in before.items():
        if handler is not None:  # which Python has not installed
            signal.signal(which, handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("random examples")
    group.addoption("--seed", type=int, metavar="NUMBER", help="draw fresh examples from NUMBER, not from the commit")
    group.addoption("--times", type=int, default=1, metavar="N", help="draw N times as many fresh examples")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line(
        "markers", "drawn(size=3): one in SIZE of the marked tests runs, drawn like random examples"
    )
    Draw.number, Draw.times = config.option.seed, config.option.times


def pytest_report_header() -> str:
    return f"random examples: --seed {number()}"


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if not any("::" in argument for argument in config.args):
        left_out = _left_out(items)
        config.hook.pytest_deselected(items=[item for item in items if item.nodeid in left_out])
        items[:] = [item for item in items if item.nodeid not in left_out]
    for item in items:
        test = getattr(item, "obj", None)
        if getattr(test, "is_hypothesis_test", False):
            refresh(test, item.name)


def _left_out(items: list[pytest.Item]) -> set[str]:
    """The tests with the marker that were not drawn."""
    marked: dict[int, list[str]] = {}
    for item in items:
        if marker := item.get_closest_marker("drawn"):
            marked.setdefault(*(marker.args or (3,)), []).append(item.nodeid)
    drawn = {test for size, tests in marked.items() for test in one_in(size, tests)}
    return {test for tests in marked.values() for test in tests} - drawn


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    if terminalreporter.verbosity < 0 or terminalreporter.stats.keys() & {"failed", "error"}:
        terminalreporter.write_line(pytest_report_header())
