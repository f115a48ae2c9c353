"""Mining of parameters, for scripts: `tachk.mine`."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from tachk.base.arguments import checked_arguments
from tachk.base.records import fields
from tachk.recordings.monitors import mining
from tachk.recordings.monitors.formulas import NamedFormula
from tachk.recordings.monitors.mined import Mined
from tachk.report.monitor.mined import MiningReport


@checked_arguments
def mine(
    formula: str | os.PathLike[str] | Sequence[NamedFormula],
    traces: str | os.PathLike[str] | Sequence[Any],
    over: str | Iterable[str] | Mapping[str, range | str | tuple[float | str | Fraction, float | str | Fraction]],
    *,
    step: float | str | Fraction | None = None,
    time: str | None = None,
    unit: str | None = None,
    end: str = "undetermined",
    constants: Mapping[str, str | float | Fraction] | None = None,
    select: Sequence[str] = (),
) -> MiningReport:
    """Finds the tightest value of a parameter with which traces satisfy a formula.

    Args:
        formula: as for `tachk.monitor`; one formula, in which the parameter is a name in bounds or conditions.
        traces: each as for `tachk.monitor`; a path alone is one trace.
        over: the name of the parameter with the least and the greatest value that it may have, such as
            ``{"T": (0, 200)}``, ``{"T": range(201)}`` or ``"T=0..200"``.
        step: try the multiples of this number only; without it bisection looks at all values that matter, and values
            that are tried one by one are whole numbers.
        time, unit, end, constants, select: as for `tachk.monitor`. What is open at the end counts as satisfied, unless
            ``end="strong"``.

    Raises:
        InputError: the formula or a trace is wrong.
        UsageError: something has no meaning.
    """
    paths = [traces] if isinstance(traces, str | os.PathLike) else traces
    found = mining.mine(
        formula, paths, over, step=step, time=time, unit=unit, end=end, constants=constants, select=select
    )
    return MiningReport(**{field.name: getattr(found, field.name) for field in fields(Mined)})
