"""Runs of a model, for scripts: `tachk.Model` has these methods."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING

from tachk.base.seeds import DEFAULT_SEED

if TYPE_CHECKING:
    from tachk.model.network import Network
    from tachk.simulation.stepping.library import HasRun, Replay, Simulation
    from tachk.simulation.stepping.walk import Walk


class Runnable:
    """A model whose runs are drawn, replayed and walked through."""

    @property
    def network(self) -> Network:
        """The processes and variables. Raises UnsupportedError where the model has refusals."""
        raise NotImplementedError

    def simulate(
        self,
        runs: int = 1,
        until: float | str = 100,
        seed: int = DEFAULT_SEED,
        policy: str = "stochastic",
        *,
        first: int = 0,
        threads: int = 1,
        max_steps: int | None = None,
        record: Iterable[str] = (),
        fault: str | Iterable[str] = (),
    ) -> Simulation:
        """Draws random runs: `tachk.simulate` with this model, which says what the arguments mean.

        Args:
            until: how long they are: a number of time units of the model, or a duration such as ``"3 min"``.
            seed: the same seed gives the same runs, with any number of threads.

        Raises:
            UsageError: an argument has no meaning.
            UnsupportedError: something in the model cannot be simulated.
        """
        from tachk.simulation.stepping.library import simulate

        return simulate(
            self,
            runs,
            until,
            seed,
            policy,
            first=first,
            threads=threads,
            max_steps=max_steps,
            record=record,
            fault=fault,
        )

    def step(self) -> Walk:
        """Begins to walk through the model step by step, in its initial state: `tachk.step` with this model.

        Raises:
            InputError: there is no initial state.
            UsageError: the updates of the model draw random numbers.
            UnsupportedError: the model has hybrid clocks.
        """
        from tachk.simulation.stepping.walk import step

        return step(self)

    def replay(self, run: HasRun | str | os.PathLike[str], property: str | None = None) -> Replay:
        """Executes a run on the model: `tachk.replay` with this model.

        Args:
            run: a report of `tachk verify --format json`, or a file that `tachk step` or `tachk simulate` has written,
                or the run of a report, ``report.run(NAME)``.
            property: of a report with several runs, the one about this property.

        Raises:
            InputError: a line of the file is not understood.
            UsageError: the file cannot be read, or holds no run.
        """
        from tachk.simulation.stepping.library import replay

        return replay(self, run, property)
