"""Sweeps on a real Dask cluster, one of whose workers is killed."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

import tachk
from tachk.verify.campaign.run import Progress

pytestmark = pytest.mark.drawn

FISCHER = Path(__file__).parents[4] / "models/classics/fischer.ta"


@pytest.mark.filterwarnings("ignore")  # what a cluster warns of when a worker is killed is not about tachk
def test_killed_worker_loses_nothing() -> None:
    distributed = pytest.importorskip("distributed")
    over = ["N=2..4", "WRITE=1..5", "WAIT=1..4"]
    model = tachk.load(FISCHER)
    killed = []
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        sent = client.submit(lambda model: model.constants, model).result()
        by_client = model.sweep(over="N=2..3,WAIT=9,11", property="mutual_exclusion", dask=client)

        def kill_one(_: Progress) -> None:
            if not killed:
                killed.append(next(iter(cluster.workers.values())).pid)
                os.kill(killed[0], signal.SIGKILL)

        found = model.sweep(over=over, property="mutual_exclusion", dask=cluster.scheduler_address, progress=kill_one)
    assert sent == model.constants
    assert [row["answer"] for row in by_client.rows] == ["fails", "holds"] * 2
    assert killed
    assert found.campaign.unfinished == 0
    here = model.sweep(over=over, property="mutual_exclusion", processes=1)
    assert [row["answer"] for row in found.rows] == [row["answer"] for row in here.rows]
