"""A limit on memory holds for what searches do not count: actions of a single state, and what Python does."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import tachk
from tachk import _core
from tachk.base import job
from tachk.base.job import OutOfMemoryError, OutOfTimeError, check_job, limited
from tachk.engine.compiler.lower import lower
from tachk.engine.core_search import core_limits, core_options
from tachk.engine.options import Limits, Options
from tachk.engine.program_image import encode
from tachk.verify.verdict import Answer

MEGABYTE = 1 << 20

RANKED = """
    broadcast chan all; chan priority all < default;
    typedef int[1, 24] id_t;
    int[0, 9] n;
    process S() { init location A { to A { sync all!; } } }
    process R(const id_t me) {
        init location A { to B { sync all?; } to A { sync all?; } }
        location B { to A { sync all?; } to B { sync all?; } }
    }
    system S, R;
    property q : E<> n == 5;
"""
"""The initial state has 2^24 actions, which are ranked before one is taken."""


@pytest.fixture
def sizes(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """What the process takes, look after look; the last number stays. Every call looks."""
    told = [100 * MEGABYTE]
    monkeypatch.setattr(job, "resident_bytes", lambda: told.pop(0) if len(told) > 1 else told[0])
    monkeypatch.setattr(job, "_SECONDS_BETWEEN_CHECKS", 0.0)
    return told


def test_the_limit_is_polled_with_the_time(sizes: list[int]) -> None:
    with limited(memory=1000 * MEGABYTE):
        check_job()
        sizes[:] = [1200 * MEGABYTE]
        check_job()  # a tenth more is allowed
        sizes[:] = [1201 * MEGABYTE]
        with pytest.raises(OutOfMemoryError) as caught:
            check_job()
    assert caught.value.reason == "memory limit"
    check_job()


def test_what_the_allocator_keeps_does_not_count(sizes: list[int]) -> None:
    with limited(memory=10 * MEGABYTE):
        sizes[:] = [300 * MEGABYTE, 101 * MEGABYTE]
        check_job()


def test_the_outer_limit_counts(sizes: list[int]) -> None:
    with limited(memory=100 * MEGABYTE):
        sizes[:] = [200 * MEGABYTE]
        with limited(memory=1000 * MEGABYTE):
            sizes[:] = [500 * MEGABYTE]
            with pytest.raises(OutOfMemoryError):
                check_job()
        sizes[:] = [200 * MEGABYTE]
        with limited(memory=None):
            check_job()


def test_both_limits_count(sizes: list[int]) -> None:
    with limited(memory=10 * MEGABYTE):
        with pytest.raises(OutOfTimeError) as caught, limited(0.0):
            pass
        assert caught.value.reason == "time limit"


def test_without_the_size_of_the_process_there_is_no_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(job, "resident_bytes", lambda: None)
    with limited(memory=1):
        check_job()


TWO = """
    clock x; int[0, 40] n;
    process P() {
        init location A {
            invariant x <= 2;
            to A { guard x >= 1 && n < 40; assign x = 0, n = n + 1; }
            to B { guard n == 40; }
        }
        location B;
    }
    system P;
    property reached : E<> P.B;
    property never : A[] n < 40 || x <= 2 || P.B;
    property always : A<> P.B;
    property observed : G (n == 3 -> F P.B);
    property largest : sup: n;
"""


def test_the_limit_leaves_no_wrong_answer_whenever_it_is_hit(sizes: list[int]) -> None:
    right = [verdict.answer for verdict in tachk.loads(TWO).verify().record.verdicts]
    seen = set()
    looks = (0, 1, 2, 3, 5, 8, 13, 21, 34, 55, 89, 144, 233, 377)
    for number in looks:
        sizes[:] = [100 * MEGABYTE]
        model = tachk.loads(TWO)
        sizes[:] = [100 * MEGABYTE] * (number + 1) + [900 * MEGABYTE]
        try:
            verdicts = model.verify(limits=Limits(memory_bytes=200 * MEGABYTE)).record.verdicts
        except OutOfMemoryError:  # before the queries were read
            continue
        for expected, verdict in zip(right, verdicts, strict=True):
            assert verdict.answer in (expected, Answer.UNKNOWN)
            if verdict.answer is Answer.UNKNOWN:
                assert verdict.reason == "memory limit"
            seen.add((verdict.query.name, verdict.answer))
    assert {answer for _, answer in seen} > {Answer.UNKNOWN}


def test_a_search_looks_in_the_midst_of_a_state() -> None:
    loaded = tachk.loads(RANKED)
    target = loaded.properties[0].target
    assert target is not None
    program, goals = lower(loaded.network, [target])
    search = _core.Explorer(encode(program, goals), core_options(Options()), core_limits(Limits()))

    def look() -> None:
        raise OutOfMemoryError

    with pytest.raises(OutOfMemoryError):
        search.run(1, None, look)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not tell how large the process is")
@pytest.mark.parametrize("limit", ["60M", None])
def test_too_many_actions_of_a_state_end_as_unknown(tmp_path: Path, limit: str | None) -> None:
    """With the limit, and where the machine gives no more."""
    (tmp_path / "m.ta").write_text(RANKED, encoding="utf-8")
    given = [] if limit is None else ["--max-memory", limit]
    done = with_few_addresses([sys.executable, "-m", "tachk", "verify", str(tmp_path / "m.ta"), *given])
    assert done.returncode == 20, done.stderr
    assert ("memory limit" if limit else "the machine is out of memory") in done.stdout


@pytest.mark.skipif(sys.platform != "linux", reason="other systems do not tell how large the process is")
def test_a_model_that_is_too_large_ends_without_a_defect(tmp_path: Path) -> None:
    numbers = range(4_000)
    edge = "{ init location A { to B { assign n = 1; } } location B; }"
    processes = "".join(f"process P{n}() {edge}\n" for n in numbers)
    system = "system " + ", ".join(f"P{n}" for n in numbers)
    (tmp_path / "m.ta").write_text(f"int n;\n{processes}{system};\nproperty q : E<> n == 5;\n", encoding="utf-8")
    done = with_few_addresses([sys.executable, "-m", "tachk", "verify", str(tmp_path / "m.ta"), "--max-memory", "1M"])
    assert done.returncode == 20, done.stderr
    assert "memory limit" in done.stderr + done.stdout


def with_few_addresses(command: list[str]) -> subprocess.CompletedProcess[str]:
    """The command with at most 500 MB of addresses."""
    shell = ["sh", "-c", 'ulimit -v 500000; exec "$@"', "sh", *command]
    return subprocess.run(shell, capture_output=True, text=True, check=False, timeout=120)
