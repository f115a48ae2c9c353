"""Cells computed by an existing Dask cluster, in batches, since a task costs Dask some milliseconds.

The cluster's workers need tachk in the same version. What a worker had begun when it was lost, Dask gives to another.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext, suppress
from importlib import import_module
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.optional_packages import optional_packages
from tachk.model.grid import Values
from tachk.verify.campaign.job import ComputedCell, Verification, computed, killed

BATCH_SECONDS = 0.5
"""The intended duration of a batch."""

PATIENCE = "10s"
"""The longest wait for the scheduler."""

_FIRST = 4
_MOST = 1000
_AHEAD = 3


def compute_on_cluster(
    job: Verification, cells: Sequence[Values], seconds: float | None, cluster: Any
) -> Iterator[ComputedCell]:
    """Each cell as soon as its batch is computed, in any order, until so many seconds have passed.

    Ending the iteration early cancels what is left.

    Args:
        cluster: the address of its scheduler, such as ``tcp://10.0.0.1:8786``, or a `distributed.Client` or a cluster.

    Raises UsageError where Dask is not installed, or there is no cluster at the address.
    """
    with optional_packages():
        distributed: Any = import_module("distributed")
    with _client(distributed, cluster) as client:
        shared = client.submit(_given, job, pure=False)  # unlike scattered data Dask can make it again
        batches = _Batches(list(cells))
        running: dict[str, tuple[Values, ...]] = {}
        done = distributed.as_completed(loop=client.loop, timeout=seconds)

        def submit() -> None:
            batch = batches.next()
            if batch:
                future = client.submit(compute_batch, shared, batch, pure=False)
                running[future.key] = batch
                done.add(future)

        for _ in range(_AHEAD * max(1, sum(client.nthreads().values()))):
            submit()
        with suppress(TimeoutError):
            for future in done:
                batch = running.pop(future.key)
                try:
                    found = future.result()
                    batches.took(sum(each.seconds for each in found), len(batch))
                except distributed.KilledWorker:
                    found = [killed(job, values) for values in batch]
                submit()
                yield from found


def _given(job: Verification) -> Verification:
    return job


def _client(distributed: Any, cluster: Any) -> AbstractContextManager[Any]:
    """A client of the cluster: the one that is given, which stays open, or a new one."""
    if isinstance(cluster, distributed.Client):
        return nullcontext(cluster)
    try:
        client: AbstractContextManager[Any] = distributed.Client(cluster, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise UsageError(f"--dask {cluster}: {error}", "give the address of a scheduler: tcp://HOST:PORT") from None
    return client


class _Batches:
    """Cuts the cells into batches whose size follows what cells have taken so far."""

    def __init__(self, left: list[Values]) -> None:
        self._left = left[::-1]
        self._size = _FIRST

    def next(self) -> tuple[Values, ...]:
        return tuple(self._left.pop() for _ in range(min(self._size, len(self._left))))

    def took(self, seconds: float, cells: int) -> None:
        mean = max(seconds / cells, 1e-6)
        self._size = max(1, min(_MOST, round(BATCH_SECONDS / mean)))


def compute_batch(job: Verification, cells: Sequence[Values]) -> list[ComputedCell]:
    """The loop of a worker."""
    return [computed(job, values) for values in cells]
